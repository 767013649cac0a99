// Help texts on the terminal.
#pragma once

#include <ostream>
#include <span>

#include "commands/shell/command.hpp"
#include "commands/shell/topics.hpp"

namespace evodevo {

/// Prints the overview of the help: what the program is, all commands and all topics.
void print_overview(std::ostream& stream, std::span<const Command> commands);

/// Prints usage, text, examples and options of a command.
void print_help(std::ostream& stream, const Command& command);

void print_topic(std::ostream& stream, const Topic& topic);

}  // namespace evodevo
