#include "commands/run/early_end.hpp"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <ctime>

#include "base/output_file.hpp"

namespace evodevo {
namespace {

using Milliseconds = std::int64_t;

std::atomic<bool> requested{false}, never_ends{false};
std::atomic<Milliseconds> last_user_signal{-1};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<Milliseconds>::is_always_lock_free,
              "signal handlers use them");

Milliseconds now() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return Milliseconds{time.tv_sec} * 1000 + time.tv_nsec / 1'000'000;
}

/// Whether a SIGUSR1 that comes now is another copy of the one before.
bool is_copy() {
  constexpr Milliseconds between_copies = 1000;
  const Milliseconds current = now(), last = last_user_signal.exchange(current);
  return last >= 0 && current - last < between_copies;
}

void end(int) {
  leave_no_unfinished_files();
  _exit(ended_early);
}

void stop_or_end(int signal) {
  if (signal == SIGUSR1 && is_copy()) return;
  if (requested.exchange(true)) end(signal);
}

void handle_signals(void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;  // so that no system call of a library fails because of a signal
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) sigaction(signal, &action, nullptr);
}

}  // namespace

std::atomic<bool>& stop_requested() { return requested; }
void stop_on_signals() { handle_signals(stop_or_end); }
void end_on_signals() {
  if (!never_ends) handle_signals(end);
}
void never_end_on_signals() { never_ends = true; }

void end_at(std::chrono::steady_clock::time_point time) {
  std::signal(SIGALRM, end);
  const auto left = std::chrono::ceil<std::chrono::seconds>(time - std::chrono::steady_clock::now());
  alarm(static_cast<unsigned>(std::max<std::int64_t>(1, left.count())));
}

}  // namespace evodevo
