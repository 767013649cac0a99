// What TOML may hold: the parser calls itself once for each level of what it reads, and so does all that walks over it.
#pragma once

#include <string>
#include <string_view>

namespace evodevo {

/// Levels of brackets within brackets, and of dots in one key.
inline constexpr int most_toml_levels = 20;
/// Bytes of a text, 4 MiB. What a run records, with every default, may be longer than the file that it began with.
inline constexpr std::size_t most_toml_bytes = std::size_t{4} << 20;
/// Bytes of a file, 1 MiB.
inline constexpr std::size_t most_toml_file_bytes = std::size_t{1} << 20;

/// Throws ConfigError, with the place, where `text` holds more than that. It need not be TOML.
void expect_within_toml_limits(std::string_view text, const std::string& origin);

}  // namespace evodevo
