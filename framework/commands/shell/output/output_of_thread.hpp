// Where a thread's output goes, if a process makes several runs.
#pragma once

#include <streambuf>

namespace evodevo {

/// While this object exists, what its thread prints through std::cout and std::cerr goes to `target` instead of
/// standard output and standard error or, if that is null, to these. Threads that the thread starts are not concerned:
/// they need such an object of their own.
class OutputOfThread {
 public:
  explicit OutputOfThread(std::streambuf* target);
  OutputOfThread(const OutputOfThread&) = delete;
  OutputOfThread& operator=(const OutputOfThread&) = delete;
  ~OutputOfThread();

 private:
  std::streambuf* before_;  ///< the thread's target before
};

/// Whether what this thread prints through std::cout is seen on a terminal.
bool prints_on_terminal();

}  // namespace evodevo
