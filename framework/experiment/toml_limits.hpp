// Limits of TOML texts. Nesting is limited because the parser, and all code that traverses its result, recurse once for
// each level.
#pragma once

#include <string>
#include <string_view>

namespace evodevo {

/// Largest depth of nested brackets, and largest number of dots in one key.
inline constexpr int most_toml_levels = 20;
/// Largest size of a text [bytes]: 4 MiB. A run records its experiment with every default, which may take more bytes
/// than the file itself.
inline constexpr std::size_t most_toml_bytes = std::size_t{4} << 20;
/// Largest size of a file [bytes]: 1 MiB.
inline constexpr std::size_t most_toml_file_bytes = std::size_t{1} << 20;

/// Throws ConfigError with the place if `text` exceeds most_toml_bytes or most_toml_levels. `text` need not be valid
/// TOML.
void expect_within_toml_limits(std::string_view text, const std::string& origin);

}  // namespace evodevo
