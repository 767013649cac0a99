#include "base/output_file.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <iostream>
#include <stdexcept>
#include <utility>

#include "base/text.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

/// Whether a file must be written in place because a rename cannot replace it: a pipe, a device, a link without a
/// target, or a path under /dev or /proc such as a file descriptor of this process.
bool stays_in_place(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (fs::exists(status) ? !fs::is_regular_file(status) : fs::is_symlink(fs::symlink_status(file, error))) return true;
  const std::string path = fs::absolute(file).lexically_normal().string();
  return path.starts_with("/dev/") || path.starts_with("/proc/");
}

}  // namespace

/// A temporary file that signal handlers see.
struct Unfinished {
  std::atomic<int> state{0};  ///< 0: free, 1: being noted, 2: there
  pid_t owner = 0;            ///< a child process that ends leaves it alone
  std::array<char, 4096> beside, target;
};

namespace {

std::array<Unfinished, 16> unfinished;
static_assert(std::atomic<int>::is_always_lock_free, "signal handlers use it");

void end_by(int signal) {
  leave_no_unfinished_files();
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

/// Notes a temporary file, and returns where, or nowhere if there is no room.
Unfinished* noted_unfinished(const std::string& beside, const std::string& target) {
  for (const int signal : {SIGINT, SIGTERM}) {
    struct sigaction now {};
    if (sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_DFL) std::signal(signal, end_by);
  }
  for (Unfinished& one : unfinished) {
    if (std::max(beside.size(), target.size()) + 1 > one.beside.size()) break;
    int free = 0;
    if (!one.state.compare_exchange_strong(free, 1)) continue;
    one.owner = getpid();
    std::memcpy(one.beside.data(), beside.c_str(), beside.size() + 1);
    std::memcpy(one.target.data(), target.c_str(), target.size() + 1);
    one.state = 2;
    return &one;
  }
  return nullptr;
}

[[noreturn]] void cannot_be_written(const std::string& title, int error) {
  throw std::runtime_error(title + ": cannot be written: " + std::strerror(error));
}

}  // namespace

OutputFile::OutputFile(const fs::path& file, std::string title) : title_(std::move(title)), target_(file) {
  if (!stays_in_place(file)) open_beside(file);
  if (stream_ == nullptr) stream_ = std::fopen(file.c_str(), "we");
  if (stream_ == nullptr) fail(errno);
}

OutputFile::~OutputFile() {
  if (stream_ == nullptr) return;
  std::fclose(stream_);
  if (!beside_.empty()) remove_beside();
}

void OutputFile::remove_beside() {
  unlink(beside_.c_str());
  if (noted_ != nullptr) std::exchange(noted_, nullptr)->state = 0;
}

void OutputFile::open_beside(const fs::path& file) {
  std::error_code error;
  const bool is_there = fs::exists(file, error);
  if (is_there && access(file.c_str(), W_OK) != 0) fail(errno);
  if (is_there) target_ = fs::canonical(file);
  beside_ = target_.string() + ".unfinished-" + std::to_string(getpid());
  noted_ =
      noted_unfinished(beside_.string(), printable(target_.string(), 4000));  // first, so that none escapes a signal
  stream_ = std::fopen(beside_.c_str(), "we");
  if (stream_ == nullptr) {
    remove_beside();
    return beside_.clear();
  }
  if (is_there)
    fs::permissions(beside_, fs::status(target_).permissions(), error);  // permissions of the old file, if allowed
}

void OutputFile::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stream_) != text.size()) fail(errno);
}

void OutputFile::finish() {
  if (std::fflush(stream_) != 0) fail(errno);
  const int closed = std::fclose(std::exchange(stream_, nullptr)) == 0 ? 0 : errno;
  if (beside_.empty()) {
    if (closed != 0) fail(closed);
    return;
  }
  const bool is_renamed = closed == 0 && std::rename(beside_.c_str(), target_.c_str()) == 0;
  const int cause = closed != 0 ? closed : errno;
  remove_beside();  // which is gone if it was renamed
  if (!is_renamed) fail(cause);
}

void OutputFile::fail(int error) const { cannot_be_written(title_, error); }

void leave_no_unfinished_files() {
  const auto say = [](const char* text) {
    [[maybe_unused]] const auto written = write(STDERR_FILENO, text, std::strlen(text));
  };
  for (Unfinished& one : unfinished) {
    if (one.state != 2 || one.owner != getpid() || unlink(one.beside.data()) != 0) continue;
    say("\nevodevo: ");
    say(one.target.data());
    say(" is not written\n");
  }
}

void write_file(const fs::path& file, std::string_view text) {
  OutputFile output(file, file.string());
  output.write(text);
  output.finish();
}

void finish_standard_output() {
  errno = 0;
  const bool flushed = std::fflush(stdout) == 0 && std::cout.flush();
  if (flushed && std::ferror(stdout) == 0) return;
  if (errno == 0) {  // an earlier write failed; writing one more byte shows why
    std::clearerr(stdout);
    std::fputc('\n', stdout);
    std::fflush(stdout);
  }
  cannot_be_written("standard output", errno != 0 ? errno : EIO);
}

}  // namespace evodevo
