// Runs code that may crash in a child process.
#pragma once

#include <functional>
#include <string>

namespace evodevo {

/// How a child process ended.
struct ChildEnd {
  std::string text;  ///< result of the work; empty if it did not return
  /// What ended the work, such as "Segmentation fault", and the last line that it wrote to standard error before, such
  /// as that of an assertion; empty if it returned.
  std::string crash;
  bool timed_out = false;  ///< whether the work took too long
};

/// Runs `work` in a child process that is a copy of this one, so that `work` can neither change nor crash this process.
/// What the child prints to standard output is discarded. The child is killed after `seconds` s, or when this process
/// ends. Once the child has finished its work or has been killed, the processes that it started are killed too. Throws
/// std::system_error if no child process can be created.
ChildEnd in_child(const std::function<std::string()>& work, unsigned seconds);

}  // namespace evodevo
