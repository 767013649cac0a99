// Runs code that may crash in a process of its own.
#pragma once

#include <functional>
#include <string>

namespace evodevo {

/// How a child process ended.
struct ChildEnd {
  std::string text;        ///< what the work returned
  std::string crash;       ///< how the process ended instead, such as "Segmentation fault"; empty where work returned
  bool timed_out = false;  ///< whether it had to be ended
};

/// Runs `work` in a copy of this process, which it can neither change nor bring down. What it prints is dropped. It is
/// ended after `seconds`, and with it what it has started; so it is where this process ends. Throws std::system_error
/// where no process can be made.
ChildEnd in_child(const std::function<std::string()>& work, unsigned seconds);

}  // namespace evodevo
