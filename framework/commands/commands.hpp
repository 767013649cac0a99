// The commands of `evodevo`.
#pragma once

#include <ostream>
#include <string_view>
#include <vector>

#include "commands/shell/command.hpp"

namespace evodevo {

Command run_command();
Command run_many_command();
Command resume_command();
Command check_command();
Command show_command();
Command verify_command();
Command signal_command();
Command body_command();
Command genes_command();
Command life_command();
Command simulate_command();
Command environments_command();
Command report_command();
Command film_command();
Command gallery_command();
Command operators_command();
Command describe_command();
Command new_command();
Command conform_command();
Command help_command();
Command completion_command();
Command man_command();

/// Prints the version, the build, the features and the devices that can be used.
void print_version(std::ostream& stream);

/// Returns all commands, in the order in which help lists them.
const std::vector<Command>& commands();

/// Returns the command with this name. Throws UsageError if there is none.
const Command& command_named(std::string_view name);

}  // namespace evodevo
