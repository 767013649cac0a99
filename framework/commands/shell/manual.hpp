// The manual page.
#pragma once

#include <span>
#include <string>

#include "commands/shell/command.hpp"

namespace evodevo {

/// Returns the manual page evodevo(1) in roff with the macros of man(7).
std::string manual_page(std::span<const Command> commands);

}  // namespace evodevo
