// Calls of operators that last too long.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace evodevo {

/// While it lives, a call of an operator that lasts longer than the environment's EVODEVO_PATIENCE (s; 10 by default)
/// is named on stderr, and again each time that it, or another of the same operator, lasts twice as long.
class CallWatch {
 public:
  CallWatch();
  CallWatch(const CallWatch&) = delete;
  CallWatch& operator=(const CallWatch&) = delete;

 private:
  std::mutex mutex_;
  std::condition_variable_any ends_;
  std::jthread thread_;
};

/// From now on a call that lasts too long after `stop` has been set ends the process, with exit code 130.
void end_long_calls_after(const std::atomic<bool>& stop);

}  // namespace evodevo
