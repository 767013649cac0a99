// Reports calls of operators that last too long.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace evodevo {

/// While this object exists, a thread warns on stderr of each operator that has a call lasting longer than the value of
/// the environment variable EVODEVO_PATIENCE (s; 10 by default). It warns of the same operator again each time that one
/// of its calls has lasted twice as long as at the previous warning.
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

/// From now on, a CallWatch ends the process with exit code 130 if `stop` is true and a call lasts too long. Without
/// this, the process could stop only after the call has returned.
void end_long_calls_after(const std::atomic<bool>& stop);

}  // namespace evodevo
