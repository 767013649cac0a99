#include "commands/shell/output/notices.hpp"

#include <unistd.h>

#include <atomic>
#include <iostream>
#include <optional>
#include <string_view>

#include "base/text.hpp"
#include "core/slow_step.hpp"

namespace evodevo {
namespace {

Verbosity& current() {
  static Verbosity verbosity = Verbosity::normal;
  return verbosity;
}

/// Prints a line on standard error. On a terminal, the line replaces a progress line.
void say(const std::string& text) {
  std::cerr << (isatty(STDERR_FILENO) == 1 ? "\r\x1b[K" : "") + ("evodevo: " + text + '\n');
}

void say_step(std::string_view what, std::optional<double> seconds) {
  say(std::string(what) + (seconds ? " took " + short_number(*seconds) + " s" : " ..."));
}

/// Reports only the first slow step. Slow steps are compilations of GPU kernels at their first use on a machine;
/// several are compiled at the same time, and a single line suffices to explain the wait.
void say_first_step(std::string_view what, std::optional<double> seconds) {
  static std::atomic<bool> said{false};
  if (seconds || said.exchange(true)) return;
  say(std::string(what) + "; the first time this takes some seconds");
}

}  // namespace

void set_verbosity(Verbosity verbosity) {
  current() = verbosity;
  if (verbosity == Verbosity::verbose)
    set_slow_step_listener(say_step);
  else if (verbosity == Verbosity::normal && isatty(STDERR_FILENO) == 1)
    set_slow_step_listener(say_first_step);
  else
    set_slow_step_listener(nullptr);
}

Verbosity verbosity() { return current(); }

std::ostream& remarks() {
  static std::ostream nowhere(nullptr);
  return verbosity() == Verbosity::quiet ? nowhere : std::cout;
}

TimedStep::TimedStep(std::string what) : what_(std::move(what)), start_(std::chrono::steady_clock::now()) {
  if (verbosity() == Verbosity::verbose) say_step(what_, std::nullopt);
}

TimedStep::~TimedStep() {
  if (verbosity() == Verbosity::verbose)
    say_step(what_, std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count());
}

}  // namespace evodevo
