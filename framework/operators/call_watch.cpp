#include "operators/call_watch.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <map>
#include <system_error>

#include "base/line.hpp"
#include "operators/operator_call.hpp"

namespace evodevo {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr int interrupted = 130;

std::atomic<const std::atomic<bool>*> stop_flag = nullptr;

Seconds patience() {
  constexpr Seconds usual(10);
  const char* variable = std::getenv("EVODEVO_PATIENCE");
  const double given = variable != nullptr ? std::strtod(variable, nullptr) : 0;
  return given > 0 ? Seconds(std::min(given, 1e6)) : usual;
}

/// Looks at the calls of all threads, and remembers when it first saw each call.
class Looks {
 public:
  void look() {
    const std::atomic<bool>* stop = stop_flag;
    for_each_call([&](const void* thread, std::uint64_t number, const OperatorCall& call) {
      Seen& seen = seen_[thread];
      if (seen.number != number) seen = {number, Clock::now()};
      const Seconds lasted = Clock::now() - seen.since;
      if (lasted < patience_) return;
      if (stop != nullptr && *stop) end(call, lasted);
      Seconds& next = next_warning_.try_emplace(call.title, patience_).first->second;
      if (lasted < next) return;
      warn(call, lasted, stop != nullptr);
      next = 2 * lasted;
    });
  }

  Seconds pause() const { return std::min(patience_ / 4, Seconds(0.25)); }

 private:
  struct Seen {
    std::uint64_t number = 0;
    Clock::time_point since;
  };

  static Line described(const OperatorCall& call, Seconds lasted) {
    Line line;
    line << call << ": has not returned for " << static_cast<std::int64_t>(lasted.count()) << " s";
    return line;
  }

  static void warn(const OperatorCall& call, Seconds lasted, bool is_run) {
    Line line;
    line << "\nwarning: " << described(call, lasted).text() << "; Ctrl-C ends the process"
         << (is_run ? ", and the complete generations are kept\n" : "\n");
    line.write_to(STDERR_FILENO);
  }

  [[noreturn]] static void end(const OperatorCall& call, Seconds lasted) {
    Line line;
    line << "\nevodevo: interrupted: " << described(call, lasted).text() << "; the complete generations are kept\n";
    line.write_to(STDERR_FILENO);
    _exit(interrupted);
  }

  const Seconds patience_ = patience();
  std::map<const void*, Seen> seen_;  ///< last call seen in each thread
  std::map<const OperatorTitle*, Seconds> next_warning_;
};

}  // namespace

CallWatch::CallWatch() {
  const auto watch = [this](const std::stop_token& stop) {
    Looks looks;
    std::unique_lock lock(mutex_);
    while (!ends_.wait_for(lock, stop, looks.pause(), [&] { return stop.stop_requested(); })) looks.look();
  };
  try {
    thread_ = std::jthread(watch);
  } catch (const std::system_error&) {
    // if no thread can be created, long calls are not reported
  }
}

void end_long_calls_after(const std::atomic<bool>& stop) { stop_flag = &stop; }

}  // namespace evodevo
