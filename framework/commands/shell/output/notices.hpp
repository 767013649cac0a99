// What commands print in addition to their results.
#pragma once

#include <chrono>
#include <ostream>
#include <string>

namespace evodevo {

enum class Verbosity { quiet, normal, verbose };

/// Sets how much commands print. From then on, the program also reports slow steps of the simulator
/// (core/slow_step.hpp) on standard error: all of them if verbose, none if quiet, and otherwise only the first one, and
/// only on a terminal.
void set_verbosity(Verbosity verbosity);
Verbosity verbosity();

/// Returns the stream for output that is not a result, such as hints and speeds: standard output or, if quiet, a stream
/// that discards everything.
std::ostream& remarks();

/// Reports the beginning and the duration of a step on standard error, but only if verbose. The step lasts as long as
/// this object exists.
class TimedStep {
 public:
  explicit TimedStep(std::string what);
  TimedStep(const TimedStep&) = delete;
  TimedStep& operator=(const TimedStep&) = delete;
  ~TimedStep();

 private:
  std::string what_;
  std::chrono::steady_clock::time_point start_;
};

/// Runs `work` as a TimedStep with the description `what`, and returns its result.
template <class Work>
auto timed(std::string what, const Work& work) {
  const TimedStep step(std::move(what));
  return work();
}

}  // namespace evodevo
