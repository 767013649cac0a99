// Files that a user names for a command to read.
#pragma once

#include <string>

namespace evodevo {

/// Bytes of a path in a message.
inline constexpr std::size_t longest_shown_path = 1000;

/// All that a file, or a pipe of the shell, holds. Throws ConfigError where it cannot be read, is a folder or a named
/// pipe, or holds more than `most` bytes.
std::string read_input_file(const std::string& file, std::size_t most);

}  // namespace evodevo
