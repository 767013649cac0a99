#include "commands/commands.hpp"

#include "base/text.hpp"

namespace evodevo {

const std::vector<Command>& commands() {
  static const std::vector<Command> all = {
      run_command(),        resume_command(),   run_many_command(), check_command(),   show_command(),
      verify_command(),     signal_command(),   body_command(),     genes_command(),   life_command(),
      simulate_command(),   report_command(),   film_command(),     gallery_command(), environments_command(),
      operators_command(),  describe_command(), new_command(),      conform_command(), help_command(),
      completion_command(), man_command()};
  return all;
}

const Command& command_named(std::string_view name) {
  std::vector<std::string> names;
  for (const Command& command : commands()) {
    if (command.name == name) return command;
    names.push_back(command.name);
  }
  throw UsageError("there is no command \"" + printable(name) + "\"" + suggestion(name, names));
}

}  // namespace evodevo
