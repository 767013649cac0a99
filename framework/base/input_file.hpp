// Reads files that a user names.
#pragma once

#include <string>

namespace evodevo {

/// Largest number of bytes of a path that a message shows; longer paths are cut.
inline constexpr std::size_t longest_shown_path = 1000;

/// Returns the whole content of a file, or of an unnamed pipe, such as one that a shell makes. Throws ConfigError if
/// `file` cannot be read, is a folder or a named pipe, or holds more than `most` bytes.
std::string read_input_file(const std::string& file, std::size_t most);

}  // namespace evodevo
