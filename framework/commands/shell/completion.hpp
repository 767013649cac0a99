// Scripts that let a shell complete the program's commands, options and arguments.
#pragma once

#include <span>
#include <string>

#include "commands/shell/command.hpp"

namespace evodevo {

/// What completion_script() writes for, as a placeholder: "bash|zsh|fish".
inline constexpr const char* shells = "bash|zsh|fish";

/// The script for `shell`, one of `shells`. Throws UsageError for any other.
std::string completion_script(const std::string& shell, std::span<const Command> commands);

}  // namespace evodevo
