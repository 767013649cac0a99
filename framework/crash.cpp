#include "crash.hpp"

#include <unistd.h>

#include <csignal>
#include <cstring>

#include "experiment.hpp"

namespace evodevo {
namespace {

thread_local const OperatorUse* in_call = nullptr;

/// In a handler of signals, where hardly anything else is allowed.
void say(const char* text) { [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text, std::strlen(text)); }

void blame_and_die(int signal) {
  if (const OperatorUse* use = in_call) {
    for (const char* text : {"\nevodevo: ", use->kind.c_str(), " operator \"", use->name.c_str(), "\" of ",
                             use->file.c_str(), " crashed; `evodevo conform ", use->file.c_str(),
                             "` tests it. The generations of a run that are complete are kept.\n"})
      say(text);
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

}  // namespace

InOperator::InOperator(const OperatorUse* use) : before_(in_call) { in_call = use; }

InOperator::~InOperator() { in_call = before_; }

void name_crashing_operators() {
  for (const int signal : {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT}) std::signal(signal, blame_and_die);
}

}  // namespace evodevo
