// What commands say beside their results.
#pragma once

#include <chrono>
#include <ostream>
#include <string>

namespace evodevo {

enum class Verbosity { quiet, normal, verbose };

/// How much commands say from now on. From now on users also hear of slow steps of the simulator (slow_step.hpp): of
/// the first one on a terminal, of all of them under --verbose, of none under --quiet.
void set_verbosity(Verbosity verbosity);
Verbosity verbosity();

/// The standard output, for what is not a result, such as hints and speeds; goes nowhere under --quiet.
std::ostream& remarks();

/// Says on standard error what takes how long; only under --verbose.
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

/// Runs `work` and returns its result; a TimedStep reports how long `what` takes.
template <class Work>
auto timed(std::string what, const Work& work) {
  const TimedStep step(std::move(what));
  return work();
}

}  // namespace evodevo
