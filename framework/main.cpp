// The command `evodevo`.
#include <malloc.h>

#include <csignal>
#include <iostream>
#include <memory>

#include "base/output_file.hpp"
#include "base/standard_streams.hpp"
#include "commands/commands.hpp"
#include "commands/shell/help.hpp"
#include "commands/shell/output/complaint.hpp"
#include "operators/call_watch.hpp"
#include "operators/crash.hpp"

namespace evodevo {
namespace {

int dispatch(const Arguments& arguments) {
  if (arguments.empty()) {
    print_overview(std::cerr, commands());
    return 2;
  }
  if (arguments.front() == "--help") {
    print_overview(std::cout, commands());
    return 0;
  }
  if (arguments.front() == "--version") {
    print_version(std::cout);
    return 0;
  }
  const Command& command = command_named(arguments.front());
  const auto watch = command.watches_operators ? std::make_unique<CallWatch>() : nullptr;
  return call(command, {arguments.begin() + 1, arguments.end()});
}

/// Keeps freed memory for later robots. By default, the C library returns much of it to the system, which then has to
/// clear the same pages again for every robot.
void keep_freed_memory() {
  mallopt(M_MMAP_THRESHOLD, 32 << 20);  // bytes; the largest value that the library allows
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
}

}  // namespace

}  // namespace evodevo

int main(int argc, char** argv) {
  evodevo::open_standard_streams();
  evodevo::keep_freed_memory();
  evodevo::name_crashing_operators();
  std::signal(SIGPIPE, SIG_DFL);  // if the reader of its output has ended, such as `head`, this program ends silently
  return evodevo::or_complain([&] {
    const int code = evodevo::dispatch({argv + 1, argv + argc});
    evodevo::finish_standard_output();
    return code;
  });
}
