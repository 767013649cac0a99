// Child processes for tests: their output line by line, their exit code, and signals.
#pragma once

#include <sys/types.h>

#include <csignal>
#include <optional>
#include <string>
#include <vector>

namespace evodevo::testing {

/// A running command whose standard output and error come through one pipe.
class Process {
 public:
  /// Starts `arguments[0]`, looked up in PATH. Throws std::system_error.
  explicit Process(const std::vector<std::string>& arguments);
  ~Process();  ///< kills the process if it is still running
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// Waits for the next line and returns it without its newline. Returns nothing if the output has ended.
  std::optional<std::string> read_line();
  void send(int signal);
  pid_t id() const { return child_; }
  /// Reads the output to its end and waits for the process. Returns the exit code, or 128 + the number of the signal
  /// that ended the process.
  int wait();
  /// All output so far.
  const std::string& output() const { return output_; }

 private:
  pid_t child_ = -1;
  int pipe_ = -1;
  std::string output_;
  std::size_t read_ = 0;  ///< number of characters of output_ that read_line() has returned
};

struct Finished {
  int exit_code;
  std::string output;
};

/// Runs a command to its end.
Finished run(const std::vector<std::string>& arguments);

}  // namespace evodevo::testing
