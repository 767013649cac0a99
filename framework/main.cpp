// The command `evodevo`.
#include <csignal>
#include <iostream>
#include <memory>
#include <sstream>
#include <string_view>

#include "base/input_error.hpp"
#include "base/output_file.hpp"
#include "base/standard_streams.hpp"
#include "base/text.hpp"
#include "commands/commands.hpp"
#include "experiment/device.hpp"
#include "operators/call_watch.hpp"
#include "operators/crash.hpp"

namespace evodevo {
namespace {

struct Command {
  std::string_view name;
  int (*function)(const Arguments&);
};

constexpr Command commands[] = {
    {"run", run_command},
    {"resume", resume_command},
    {"show", show_command},
    {"verify", verify_command},
    {"body", body_command},
    {"life", life_command},
    {"simulate", simulate_command},
    {"environments", environments_command},
    {"report", report_command},
    {"film", film_command},
    {"gallery", gallery_command},
    {"check", check_command},
    {"operators", operators_command},
    {"describe", describe_command},
    {"new", new_command},
    {"conform", conform_command},
};

/// A file of its own, which tools/evodevo shows where nothing is built yet.
constexpr std::string_view help =
#include "help.inc"
    ;

/// Whether it has one line for each command, in this order.
constexpr bool help_is_complete() {
  constexpr std::string_view program = "@PROGRAM@ ";
  std::size_t at = 0;
  for (const Command& command : commands) {
    at = help.find(program, at);
    if (at == help.npos) return false;
    at += program.size();
    if (help.substr(at, help.find(' ', at) - at) != command.name) return false;
  }
  return help.find(program, at) == help.npos;
}
static_assert(help_is_complete());

void print_help(std::ostream& stream) {
  std::string text(help);
  replace_all(text, "@VERSION@", EVODEVO_VERSION);
  replace_all(text, "@PROGRAM@", program_name());
  stream << text;
}

int dispatch(const Arguments& arguments) {
  if (arguments.empty()) {
    print_help(std::cerr);
    return 2;
  }
  if (arguments.front() == "--help" || arguments.front() == "help") {
    print_help(std::cout);
    return 0;
  }
  if (arguments.front() == "--version") {
    std::cout << "evodevo " EVODEVO_VERSION "\n";
    return 0;
  }
  std::vector<std::string> names;
  for (const Command& command : commands) {
    if (arguments.front() == command.name) {
      // conform gives its cases a time limit each, in processes of their own
      const auto watch = command.function != conform_command ? std::make_unique<CallWatch>() : nullptr;
      return command.function({arguments.begin() + 1, arguments.end()});
    }
    names.emplace_back(command.name);
  }
  throw UsageError("there is no command \"" + printable(arguments.front()) + "\"" +
                   suggestion(arguments.front(), names));
}

/// Some failures have several lines.
int complain(const std::exception& error, int exit_code) {
  std::istringstream lines(error.what() + remedy_for(error));
  std::string line;
  const auto say = [&](const char* before) {
    std::cerr << before << printable(line, InputError::longest_message) << '\n';
  };
  std::getline(lines, line);
  say("evodevo: ");
  while (std::getline(lines, line)) say("");
  return exit_code;
}

}  // namespace

}  // namespace evodevo

int main(int argc, char** argv) {
  evodevo::open_standard_streams();
  evodevo::name_crashing_operators();
  std::signal(SIGPIPE, SIG_DFL);  // a reader that has gone, such as `head`, ends this program without a word
  try {
    const int code = evodevo::dispatch({argv + 1, argv + argc});
    evodevo::finish_standard_output();
    return code;
  } catch (const evodevo::InputError& error) {
    return evodevo::complain(error, 2);
  } catch (const std::exception& error) {
    return evodevo::complain(error, 1);
  }
}
