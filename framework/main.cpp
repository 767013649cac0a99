// The command `evodevo`.
#include <malloc.h>
#include <unistd.h>

#include <csignal>
#include <iostream>
#include <memory>
#include <sstream>

#include "base/output_file.hpp"
#include "base/standard_streams.hpp"
#include "base/text.hpp"
#include "commands/commands.hpp"
#include "commands/shell/excerpt.hpp"
#include "commands/shell/help.hpp"
#include "commands/shell/terminal.hpp"
#include "experiment/config_errors.hpp"
#include "experiment/device.hpp"
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

/// Prints an error message, which may have several lines, and returns `exit_code`. On a terminal, it also shows the
/// line of the file at which the message points; other programs get the message alone.
int complain(const std::exception& error, int exit_code) {
  std::istringstream lines(error.what() + remedy_for(error));
  std::string line;
  const auto say = [&](const char* before) {
    std::cerr << before << printable(line, InputError::longest_message) << '\n';
  };
  std::getline(lines, line);
  say(shows_colours(STDERR_FILENO) ? "\x1b[1;31mevodevo:\x1b[0m " : "evodevo: ");
  while (std::getline(lines, line)) say("");
  if (isatty(STDERR_FILENO) == 1) std::cerr << excerpt_for(error.what());
  return exit_code;
}

/// Prints the errors of an experiment, each as complain() does, and their number if there are several.
int complain_of_all(const ConfigErrors& errors) {
  for (const ConfigError& error : errors.all) complain(error, 2);
  const std::size_t count = errors.all.size();
  if (count > 1) std::cerr << "evodevo: " << count << (errors.is_complete ? " errors\n" : " errors or more\n");
  return 2;
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
  try {
    const int code = evodevo::dispatch({argv + 1, argv + argc});
    evodevo::finish_standard_output();
    return code;
  } catch (const evodevo::ConfigErrors& errors) {
    return evodevo::complain_of_all(errors);
  } catch (const evodevo::InputError& error) {
    return evodevo::complain(error, 2);
  } catch (const std::exception& error) {
    return evodevo::complain(error, 1);
  }
}
