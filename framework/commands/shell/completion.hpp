// Scripts that let a shell complete the program's commands, options and arguments.
#pragma once

#include <span>
#include <string>

#include "commands/shell/command.hpp"

namespace evodevo {

/// The shells that completion_script() supports, in the form of the placeholder of an argument.
inline constexpr const char* shells = "bash|zsh|fish";

/// Returns the completion script for a shell. Throws UsageError if `shell` is not one of `shells`.
std::string completion_script(const std::string& shell, std::span<const Command> commands);

}  // namespace evodevo
