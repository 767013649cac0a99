// Notifications of steps that can take seconds, such as compiling a kernel, so that users can be told about them.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace evodevo {

/// A function that is called at the beginning of each slow step, without a duration, and at its end, with its duration
/// (s). `what` describes the step, such as "compiling the kernel resident.cu". Several threads may call it at the same
/// time.
using SlowStepListener = std::function<void(std::string_view what, std::optional<double> seconds)>;

/// Sets the listener of this process; initially there is none. Must be called while no slow step is in progress.
void set_slow_step_listener(SlowStepListener listener);

/// Represents a slow step, which lasts as long as this object.
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
