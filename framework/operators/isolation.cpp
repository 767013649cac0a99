#include "operators/isolation.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <system_error>
#include <utility>

#include "base/text.hpp"
#include "operators/crash.hpp"

namespace evodevo {
namespace {

using Clock = std::chrono::steady_clock;

/// What a child writes before its text: the number of bytes of the text, and whether the text is about an exception
/// instead of a result. The parent reads that many bytes and does not wait for the end of the pipe, which a process
/// started by the child may keep open.
struct Header {
  std::size_t size = 0;
  bool thrown = false;
};

/// The two ends of a pipe, which are closed when it is destroyed.
struct Pipe {
  int reading = -1, writing = -1;

  explicit Pipe(int flags) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC | flags) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
    reading = ends[0];
    writing = ends[1];
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    close(reading);
    stop_writing();
  }
  void stop_writing() {
    if (writing >= 0) close(std::exchange(writing, -1));
  }
};

/// Drops all output but what `errors` holds of standard error, and restores the default handling of signals: handlers
/// of this program or of a sanitizer would report a crash that is expected here, and would turn it into an exit.
void become_silent(int errors) {
  leave_crashes_unnamed();
  for (const int signal : {SIGALRM, SIGTERM, SIGINT, SIGUSR1}) std::signal(signal, SIG_DFL);
  const rlimit none{0, 0};
  setrlimit(RLIMIT_CORE, &none);
  const int nowhere = open("/dev/null", O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO}) dup2(nowhere, stream);
  dup2(errors, STDERR_FILENO);
}

/// Makes the system kill this child when its parent ends, and makes the child the leader of a process group, so that
/// the parent can kill it together with the processes that it starts.
void join_fate(pid_t parent) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
}

void write_all(int pipe, const void* data, std::size_t size) {
  for (std::size_t done = 0; done < size;) {
    const ssize_t count = write(pipe, static_cast<const char*>(data) + done, size - done);
    if (count < 0 && errno != EINTR) _exit(1);
    if (count > 0) done += static_cast<std::size_t>(count);
  }
}

/// Runs `work`, writes the result to `pipe` and ends the process. It never returns, because the copies of the parent's
/// stack, buffers and objects must not be unwound, flushed or destroyed here.
[[noreturn]] void live_as_child(const std::function<std::string()>& work, int pipe, int errors, pid_t parent) {
  join_fate(parent);
  become_silent(errors);
  on_exit([](int status, void*) { _exit(status); }, nullptr);
  std::string text;
  bool thrown = true;
  try {
    text = work();
    thrown = false;
  } catch (const std::exception& error) {
    text = std::string("\"") + error.what() + '"';
  } catch (...) {
    text = "something that is not a std::exception";
  }
  const Header header{text.size(), thrown};
  write_all(pipe, &header, sizeof header);
  write_all(pipe, text.data(), text.size());
  _exit(0);
}

enum class Read { whole, ended, late };

/// Reads until `size` bytes have arrived (whole), the pipe has ended (ended), or `deadline` has passed (late).
Read read_all(int pipe, void* data, std::size_t size, Clock::time_point deadline) {
  for (std::size_t done = 0; done < size;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) return Read::late;
    pollfd ready{pipe, POLLIN, 0};
    if (poll(&ready, 1, static_cast<int>(left)) <= 0) continue;
    const ssize_t count = read(pipe, static_cast<char*>(data) + done, size - done);
    if (count == 0 || (count < 0 && errno != EINTR)) return Read::ended;
    if (count > 0) done += static_cast<std::size_t>(count);
  }
  return Read::whole;
}

int wait_for(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

/// Returns the last line that a pipe holds, such as that of an assertion, without waiting for more.
std::string last_line(int pipe) {
  std::string text(std::size_t{1} << 16, '\0');
  const ssize_t count = read(pipe, text.data(), text.size());
  text.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  while (text.ends_with('\n')) text.pop_back();
  return printable(text.substr(text.rfind('\n') + 1));
}

std::string crash_text(int status, const std::string& said) {
  const std::string end = WIFEXITED(status)
                              ? "it ended the process with exit code " + std::to_string(WEXITSTATUS(status))
                              : strsignal(WTERMSIG(status));
  return said.empty() ? end : end + ", after it said: " + said;
}

}  // namespace

ChildEnd in_child(const std::function<std::string()>& work, unsigned seconds) {
  Pipe answer(0), errors(O_NONBLOCK);  // a child that writes a lot of errors is not held up; the rest of them is lost
  const pid_t parent = getpid(), child = fork();
  if (child < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (child == 0) live_as_child(work, answer.writing, errors.writing, parent);
  setpgid(child, child);  // child and parent both do this, because either may run first
  answer.stop_writing();
  const auto deadline = Clock::now() + std::chrono::seconds(seconds);
  Header header;
  std::string text;
  Read got = read_all(answer.reading, &header, sizeof header, deadline);
  if (got == Read::whole) {
    text.resize(header.size);
    got = read_all(answer.reading, text.data(), text.size(), deadline);
  }
  kill(-child, SIGKILL);  // the status of a child that has already ended stays the same
  const int status = wait_for(child);
  if (got == Read::late) return {"", "it did not finish within " + std::to_string(seconds) + " s", true};
  if (got == Read::ended) return {"", crash_text(status, last_line(errors.reading))};
  if (header.thrown) return {"", "it threw " + text};
  return {std::move(text), ""};
}

}  // namespace evodevo
