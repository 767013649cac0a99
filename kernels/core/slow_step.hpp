// Steps that can take seconds, such as compiling a kernel, for callers that tell their users what is going on.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace evodevo {

/// Hears what a slow step does, such as "compiling the kernel resident.cu": without a duration when the step begins,
/// with it (s) when the step has ended. Threads that do slow steps call it at the same time.
using SlowStepListener = std::function<void(std::string_view what, std::optional<double> seconds)>;

/// Sets the listener of this process, which hears nothing before. To be called while no slow step is under way.
void set_slow_step_listener(SlowStepListener listener);

/// A slow step, which lasts as long as this object.
class SlowStep {
 public:
  explicit SlowStep(std::string what);
  SlowStep(const SlowStep&) = delete;
  SlowStep& operator=(const SlowStep&) = delete;
  ~SlowStep();

 private:
  std::string what_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace evodevo
