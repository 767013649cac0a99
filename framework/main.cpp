// The command `evodevo`.
#include <csignal>
#include <iostream>
#include <sstream>

#include "commands/commands.hpp"
#include "crash.hpp"
#include "input_error.hpp"
#include "output_file.hpp"
#include "standard_streams.hpp"
#include "text.hpp"

namespace evodevo {
namespace {

struct Command {
  const char* name;
  int (*function)(const Arguments&);
  const char* usage;
};

constexpr Command commands[] = {
    {"run", run_command, "run EXPERIMENT.toml              evolve robots"},
    {"resume", resume_command, "resume DIR                       go on with a run that was interrupted"},
    {"show", show_command, "show DIR                         what a run has come to"},
    {"verify", verify_command, "verify DIR                       whether its best robots keep their fitness"},
    {"body", body_command, "body DIR                         a robot of a run, as JSON"},
    {"life", life_command, "life DIR                         how a robot's body developed"},
    {"simulate", simulate_command, "simulate BODY.json EXPERIMENT.toml   one body in a scene"},
    {"environments", environments_command,
     "environments EXPERIMENT.toml...  the bodies that one genome grows in several scenes"},
    {"report", report_command, "report DIR...                    a page that shows runs and their robots"},
    {"film", film_command, "film DIR                         a film or a picture of a robot"},
    {"gallery", gallery_command, "gallery EXPERIMENT.toml          a page of random robots"},
    {"check", check_command, "check EXPERIMENT.toml            whether an experiment can be run"},
    {"operators", operators_command, "operators                        the operators that are there"},
    {"describe", describe_command, "describe OPERATOR                its parameters"},
    {"new", new_command, "new KIND NAME                    the project of a plugin"},
    {"conform", conform_command, "conform LIBRARY...               whether plugins keep to the rules"},
};

void print_usage(std::ostream& stream) {
  stream << "evodevo " EVODEVO_VERSION " evolves soft robots whose bodies develop during their lives\n\n";
  for (const Command& command : commands) stream << "  " << program_name() << ' ' << command.usage << '\n';
  stream << "\nEach command explains its options with --help.\n";
}

int dispatch(const Arguments& arguments) {
  if (arguments.empty()) {
    print_usage(std::cerr);
    return 2;
  }
  if (arguments.front() == "--help" || arguments.front() == "help") {
    print_usage(std::cout);
    return 0;
  }
  if (arguments.front() == "--version") {
    std::cout << "evodevo " EVODEVO_VERSION "\n";
    return 0;
  }
  std::vector<std::string> names;
  for (const Command& command : commands) {
    if (arguments.front() == command.name) return command.function({arguments.begin() + 1, arguments.end()});
    names.emplace_back(command.name);
  }
  throw UsageError("there is no command \"" + printable(arguments.front()) + "\"" +
                   suggestion(arguments.front(), names));
}

/// Some failures have several lines.
int complain(const std::exception& error, int exit_code) {
  std::istringstream lines(error.what());
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
