// A library to preload (LD_PRELOAD). It records how a program uses the files in a folder, the clock and MPI, and lets
// one of these calls fail, or the program die at it. It reads these variables of the environment:
//
// EVODEVO_FAULTS_FOLDER  absolute path; calls that use no file in this folder are neither counted nor recorded
// EVODEVO_FAULTS_RECORD  a file outside the folder, to which each call is appended, as entry() says; a rank of MPI
//                        appends to a file of its own, whose name ends with a dot and the rank
// EVODEVO_FAULTS_KIND    the fault, one of those below
// EVODEVO_FAULTS_AT      the number of the call that it strikes, from 1; files, clock and messages count apart
// EVODEVO_FAULTS_RANK    the rank of MPI that it strikes; all if it is missing
//
//   EIO, EINTR, ENOMEM   the call fails with this error
//   full                 it and all later calls that need space on the disk fail with ENOSPC
//   short                it writes half of the bytes, and says so
//   torn                 it writes half of the bytes, and the program is killed
//   kill, message-kill   the program is killed before the call, or before that message is sent or received
//   stop                 the program is stopped before the call, until it gets SIGCONT
//   forward, back        from this reading of the clock on, it is an hour later or, except for clocks that never go
//                        back, earlier
//
// Calls that wait for the disk return at once: what a loss of power would do is found out from the record.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <mutex>
#include <string>
#include <string_view>

namespace {

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr ? value : "";
}

struct Settings {
  std::string folder = variable("EVODEVO_FAULTS_FOLDER");
  std::string record = variable("EVODEVO_FAULTS_RECORD");
  std::string kind = variable("EVODEVO_FAULTS_KIND");
  long at = std::atol(variable("EVODEVO_FAULTS_AT").c_str());

  Settings() {
    const std::string rank = variable("OMPI_COMM_WORLD_RANK"), struck = variable("EVODEVO_FAULTS_RANK");
    if (!struck.empty() && struck != rank) kind.clear();
    if (!rank.empty()) record += "." + rank;
  }
  bool is(std::string_view name) const { return kind == name; }
};

const Settings& settings() {
  static const Settings settings;
  return settings;
}

/// Returns the function that the program would call without this library.
template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

/// Appends an entry to the record. It is a line with what was called, its result, the file as a path in the folder,
/// what else is known about the call, and the number of bytes that were written, separated by tabs; then these bytes.
void entry(std::string_view name, long result, std::string_view file, std::string_view detail,
           std::string_view bytes = {}) {
  static const long record =
      syscall(SYS_openat, AT_FDCWD, settings().record.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  const int error = errno;
  std::string text(name);
  text.append("\t").append(std::to_string(result)).append("\t").append(file).append("\t").append(detail);
  text.append("\t").append(std::to_string(bytes.size())).append("\n").append(bytes);
  syscall(SYS_write, record, text.data(), text.size());
  errno = error;
}

[[noreturn]] void die() {
  for (;;) kill(getpid(), SIGKILL);
}

bool is_counted(std::string_view path) {
  const std::string& folder = settings().folder;
  return !folder.empty() && path.starts_with(folder) && (path.size() == folder.size() || path[folder.size()] == '/');
}

std::string path_of(int descriptor) {
  char path[PATH_MAX];
  const ssize_t size = readlink(("/proc/self/fd/" + std::to_string(descriptor)).c_str(), path, sizeof path);
  return {path, static_cast<std::size_t>(size > 0 ? size : 0)};
}

/// One call that uses a file in the folder. While it lasts, other threads wait with theirs, so that the order of the
/// record is that of the calls.
class Call {
 public:
  Call(const char* name, const std::string& path, bool needs_space = false)
      : lock_(mutex), name_(name), file_(path.substr(settings().folder.size())) {
    static long count = 0;
    ++count;
    if (settings().is("full") && needs_space && settings().at > 0 && count >= settings().at) error_ = ENOSPC;
    if (count == settings().at) strike();
  }
  /// The error with which the call is to fail; 0 if it is not.
  int error() const { return error_; }
  /// How many bytes are to be written of `size`.
  std::size_t to_write(std::size_t size) const { return is_struck_ && cuts() && size > 1 ? size / 2 : size; }

  /// Records a call that was made, and returns its result.
  template <class Result>
  Result made(Result result, std::string_view detail = {}, std::string_view bytes = {}) const {
    entry(name_, static_cast<long>(result), file_, detail, bytes);
    if (is_struck_ && settings().is("torn")) die();
    return result;
  }
  /// Records a call that fails with error(), and returns what it returns.
  template <class Result>
  Result failed(Result result) const {
    entry(name_, -1, file_, {});
    errno = error_;
    return result;
  }

 private:
  void strike() {
    const Settings& given = settings();
    if (given.kind.empty() || given.is("forward") || given.is("back") || given.is("message-kill")) return;
    entry("fault", 0, file_, name_);
    is_struck_ = true;
    if (given.is("kill")) die();
    if (given.is("stop")) kill(getpid(), SIGSTOP);
    if (given.is("EIO")) error_ = EIO;
    if (given.is("EINTR")) error_ = EINTR;
    if (given.is("ENOMEM")) error_ = ENOMEM;
  }
  static bool cuts() { return settings().is("short") || settings().is("torn"); }

  static std::mutex mutex;
  std::lock_guard<std::mutex> lock_;
  const char* name_;
  std::string file_;
  int error_ = 0;
  bool is_struck_ = false;
};

std::mutex Call::mutex;

/// Calls `perform` if the call counts and is not to fail, or if it does not count.
template <class Result, class Perform>
Result simple(const char* name, const std::string& path, Result failure, const Perform& perform,
              const std::string& detail = {}, bool needs_space = false) {
  if (!is_counted(path)) return perform();
  const Call call(name, path, needs_space);
  return call.error() != 0 ? call.failed(failure) : call.made(perform(), detail);
}

template <class Perform>
ssize_t writing(const char* name, int descriptor, const void* data, std::size_t size, off_t offset,
                const Perform& perform) {
  const std::string path = path_of(descriptor);
  if (!is_counted(path)) return perform(size);
  const Call call(name, path, true);
  if (call.error() != 0) return call.failed(ssize_t{-1});
  if (offset < 0) offset = lseek(descriptor, 0, (fcntl(descriptor, F_GETFL) & O_APPEND) != 0 ? SEEK_END : SEEK_CUR);
  const ssize_t written = perform(call.to_write(size));
  const std::size_t bytes = written > 0 ? static_cast<std::size_t>(written) : 0;
  return call.made(written, std::to_string(offset), {static_cast<const char*>(data), bytes});
}

/// `creates`, `empties`: what becomes of the file if it is missing, and if it is there.
template <class Result, class Perform>
Result opening(const char* path, bool creates, bool empties, Result failure, const Perform& perform) {
  const bool is_new = creates && access(path, F_OK) != 0;
  return simple("open", path, failure, perform, is_new ? "new" : empties ? "emptied" : "", is_new);
}

int opening(const char* name, const char* path, int flags, mode_t mode) {
  const auto real = next<decltype(open)>(name);
  return opening(path, (flags & O_CREAT) != 0, (flags & O_TRUNC) != 0, -1, [&] { return real(path, flags, mode); });
}

FILE* opening(const char* name, const char* path, const char* mode) {
  const auto real = next<decltype(fopen)>(name);
  if (!is_counted(path)) return real(path, mode);
  const bool empties = mode[0] == 'w';
  const bool is_new = mode[0] != 'r' && access(path, F_OK) != 0;
  const Call call("open", path, is_new);
  if (call.error() != 0) return call.failed(static_cast<FILE*>(nullptr));
  FILE* const file = real(path, mode);
  call.made(file != nullptr ? 0 : -1, is_new ? "new" : empties ? "emptied" : "");
  return file;
}

int synchronising(const char* name, int descriptor) {
  const std::string path = path_of(descriptor);
  if (!is_counted(path)) return next<int(int)>(name)(descriptor);
  return simple(name, path, -1, [] { return 0; });
}

int truncating(const char* name, int descriptor, off_t size) {
  return simple(
      "ftruncate", path_of(descriptor), -1, [&] { return next<decltype(ftruncate)>(name)(descriptor, size); },
      std::to_string(size), true);
}

void* mapping(const char* name, void* address, std::size_t size, int protection, int flags, int descriptor,
              off_t offset) {
  const auto real = next<decltype(mmap)>(name);
  const std::string path = (flags & MAP_ANONYMOUS) != 0 ? "" : path_of(descriptor);
  if (!is_counted(path)) return real(address, size, protection, flags, descriptor, offset);
  const Call call("mmap", path);
  if (call.error() != 0) return call.failed(MAP_FAILED);
  void* const memory = real(address, size, protection, flags, descriptor, offset);
  call.made(memory != MAP_FAILED ? 0 : -1);
  return memory;
}

int controlling(const char* name, int descriptor, int command, void* argument) {
  const auto real = next<int(int, int, ...)>(name);
  const auto perform = [&] { return real(descriptor, command, argument); };
  return command == F_SETLK ? simple("lock", path_of(descriptor), -1, perform) : perform();
}

/// Counts a reading of the clock, and returns by how much it has jumped, s.
long jump(clockid_t clock) {
  constexpr long hour = 3600;
  static std::atomic<long> count = 0;
  const long number = ++count;
  const Settings& given = settings();
  if (!given.folder.empty()) entry("clock", 0, "", "");
  if (given.at <= 0 || number < given.at) return 0;
  if (given.is("forward")) return hour;
  return given.is("back") && clock == CLOCK_REALTIME ? -hour : 0;
}

/// Counts a message of MPI.
void count_message(const char* name) {
  static std::atomic<long> count = 0;
  const bool is_struck = ++count == settings().at && settings().is("message-kill");
  entry(is_struck ? "fault" : name, 0, "", is_struck ? name : "");
  if (is_struck) die();
}

/// Returns a function of MPI, which is not among the libraries that the program was linked with.
template <class Function>
Function* next_of_mpi(const char* name) {
  return reinterpret_cast<Function*>(dlsym(dlopen("libmpi.so.40", RTLD_LAZY | RTLD_NOLOAD), name));
}

}  // namespace

#define EVODEVO_FAULTS_EXPORT __attribute__((visibility("default")))

extern "C" {

EVODEVO_FAULTS_EXPORT int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const auto mode = va_arg(rest, mode_t);
  va_end(rest);
  return opening("open", path, flags, mode);
}
EVODEVO_FAULTS_EXPORT int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const auto mode = va_arg(rest, mode_t);
  va_end(rest);
  return opening("open64", path, flags, mode);
}
EVODEVO_FAULTS_EXPORT FILE* fopen(const char* path, const char* mode) { return opening("fopen", path, mode); }
EVODEVO_FAULTS_EXPORT FILE* fopen64(const char* path, const char* mode) { return opening("fopen64", path, mode); }

EVODEVO_FAULTS_EXPORT ssize_t read(int descriptor, void* data, size_t size) {
  return simple("read", path_of(descriptor), ssize_t{-1},
                [&] { return next<decltype(read)>("read")(descriptor, data, size); });
}
EVODEVO_FAULTS_EXPORT ssize_t pread(int descriptor, void* data, size_t size, off_t offset) {
  return simple("read", path_of(descriptor), ssize_t{-1},
                [&] { return next<decltype(pread)>("pread")(descriptor, data, size, offset); });
}
EVODEVO_FAULTS_EXPORT ssize_t pread64(int descriptor, void* data, size_t size, off64_t offset) {
  return pread(descriptor, data, size, offset);
}

EVODEVO_FAULTS_EXPORT ssize_t write(int descriptor, const void* data, size_t size) {
  return writing("write", descriptor, data, size, -1,
                 [&](std::size_t part) { return next<decltype(write)>("write")(descriptor, data, part); });
}
EVODEVO_FAULTS_EXPORT ssize_t writev(int descriptor, const iovec* parts, int count) {
  if (!is_counted(path_of(descriptor))) return next<decltype(writev)>("writev")(descriptor, parts, count);
  std::string whole;
  for (int i = 0; i < count; ++i) whole.append(static_cast<const char*>(parts[i].iov_base), parts[i].iov_len);
  return write(descriptor, whole.data(), whole.size());
}
EVODEVO_FAULTS_EXPORT ssize_t pwrite(int descriptor, const void* data, size_t size, off_t offset) {
  return writing("write", descriptor, data, size, offset,
                 [&](std::size_t part) { return next<decltype(pwrite)>("pwrite")(descriptor, data, part, offset); });
}
EVODEVO_FAULTS_EXPORT ssize_t pwrite64(int descriptor, const void* data, size_t size, off64_t offset) {
  return pwrite(descriptor, data, size, offset);
}
EVODEVO_FAULTS_EXPORT int ftruncate(int descriptor, off_t size) noexcept {
  return truncating("ftruncate", descriptor, size);
}
EVODEVO_FAULTS_EXPORT int ftruncate64(int descriptor, off64_t size) noexcept {
  return truncating("ftruncate64", descriptor, size);
}
EVODEVO_FAULTS_EXPORT int fsync(int descriptor) { return synchronising("fsync", descriptor); }
EVODEVO_FAULTS_EXPORT int fdatasync(int descriptor) { return synchronising("fdatasync", descriptor); }

EVODEVO_FAULTS_EXPORT int unlink(const char* path) noexcept {
  return simple("unlink", path, -1, [&] { return next<int(const char*)>("unlink")(path); });
}
EVODEVO_FAULTS_EXPORT int rename(const char* from, const char* to) noexcept {
  return simple(
      "rename", from, -1, [&] { return next<int(const char*, const char*)>("rename")(from, to); },
      is_counted(to) ? to + settings().folder.size() : "", true);
}
EVODEVO_FAULTS_EXPORT int mkdir(const char* path, mode_t mode) noexcept {
  return simple(
      "mkdir", path, -1, [&] { return next<int(const char*, mode_t)>("mkdir")(path, mode); }, "", true);
}

EVODEVO_FAULTS_EXPORT void* mmap(void* address, size_t size, int protection, int flags, int descriptor,
                                 off_t offset) noexcept {
  return mapping("mmap", address, size, protection, flags, descriptor, offset);
}
EVODEVO_FAULTS_EXPORT void* mmap64(void* address, size_t size, int protection, int flags, int descriptor,
                                   off64_t offset) noexcept {
  return mapping("mmap64", address, size, protection, flags, descriptor, offset);
}

EVODEVO_FAULTS_EXPORT int fcntl(int descriptor, int command, ...) {
  va_list rest;
  va_start(rest, command);
  void* const argument = va_arg(rest, void*);
  va_end(rest);
  return controlling("fcntl", descriptor, command, argument);
}
EVODEVO_FAULTS_EXPORT int fcntl64(int descriptor, int command, ...) {
  va_list rest;
  va_start(rest, command);
  void* const argument = va_arg(rest, void*);
  va_end(rest);
  return controlling("fcntl64", descriptor, command, argument);
}

EVODEVO_FAULTS_EXPORT int clock_gettime(clockid_t clock, timespec* time) noexcept {
  const int result = next<int(clockid_t, timespec*)>("clock_gettime")(clock, time);
  if (result == 0) time->tv_sec += jump(clock);
  return result;
}
EVODEVO_FAULTS_EXPORT int gettimeofday(timeval* __restrict time, void* __restrict zone) noexcept {
  const int result = next<int(timeval*, void*)>("gettimeofday")(time, zone);
  if (result == 0) time->tv_sec += jump(CLOCK_REALTIME);
  return result;
}

// as Open MPI 4 declares them: handles are pointers
EVODEVO_FAULTS_EXPORT int MPI_Isend(const void* data, int count, void* type, int to, int tag, void* all,
                                    void* request) {
  count_message("send");
  return next_of_mpi<decltype(MPI_Isend)>("PMPI_Isend")(data, count, type, to, tag, all, request);
}
EVODEVO_FAULTS_EXPORT int MPI_Imrecv(void* data, int count, void* type, void* message, void* request) {
  count_message("receive");
  return next_of_mpi<decltype(MPI_Imrecv)>("PMPI_Imrecv")(data, count, type, message, request);
}
}
