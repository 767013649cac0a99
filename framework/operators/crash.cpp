#include "operators/crash.hpp"

#include <dlfcn.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include "base/line.hpp"
#include "operators/operator_call.hpp"

namespace evodevo {
namespace {

constexpr int fatal_signals[] = {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT};

std::atomic<bool> names_exits = false;

void say(const OperatorCall& call, std::string_view what) {
  static std::atomic_flag said;
  if (said.test_and_set())
    while (true) pause();  // the thread that came first ends the process
  Line line;
  line << "\nevodevo: " << call << ": " << what << "; `evodevo conform " << call.title->file
       << " --experiment FILE.toml` tests the operator with its parameters. The complete generations of a run are "
          "kept.\n";
  line.write_to(STDERR_FILENO);
}

/// Whether an address is less than 64 KiB before the end of this thread's stack or less than 1 MiB beyond it.
bool is_beyond_stack(const void* address) {
  constexpr std::ptrdiff_t beyond = 1 << 20, before = 1 << 16;
  const char* lowest = lowest_of_stack();
  return lowest != nullptr && address > lowest - beyond && address < lowest + before;
}

void blame_and_die(int signal, siginfo_t* info, void*) {
  if (const OperatorCall call = current_call(); call.title != nullptr) {
    Line what;
    if (signal == SIGSEGV && is_beyond_stack(info->si_addr))
      what << "its stack overflowed; it calls itself without end, or keeps large arrays as local variables";
    else
      what << "crashed: " << sigdescr_np(signal);
    say(call, what.text());
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

/// Called by exit(status). If an operator's code has caused the exit, reports it and ends the
/// process with exit code 1.
void refuse_to_exit(int status) {
  const OperatorCall call = current_call();
  if (!names_exits || call.title == nullptr) return;
  Line what;
  what << "it ended the process with exit code " << status << ", which operators must not do";
  say(call, what.text());
  syscall(SYS_exit_group, 1);
}

}  // namespace

void name_crashing_operators() {
  struct sigaction action {};
  action.sa_sigaction = blame_and_die;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  for (const int signal : fatal_signals) sigaddset(&action.sa_mask, signal);
  for (const int signal : fatal_signals) sigaction(signal, &action, nullptr);
  names_exits = true;
}

void leave_crashes_unnamed() {
  for (const int signal : fatal_signals) std::signal(signal, SIG_DFL);
  names_exits = false;
}

}  // namespace evodevo

// This replaces the C library's function also for the libraries of operators, because the dynamic linker searches the
// program for a symbol before it searches libraries. An operator must not get as far as the handlers that exit() calls:
// they destroy what other threads are still using.
extern "C" __attribute__((visibility("default"))) void exit(int status) noexcept {
  evodevo::refuse_to_exit(status);
  reinterpret_cast<void (*)(int)>(dlsym(RTLD_NEXT, "exit"))(status);
  __builtin_unreachable();
}
