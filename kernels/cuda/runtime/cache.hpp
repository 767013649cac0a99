// Compiled kernels on disk: $XDG_CACHE_HOME/evodevo/kernels, or ~/.cache/evodevo/kernels.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace evodevo::cuda {

/// A hash of `text` as 32 hexadecimal digits (XXH3, 128 bits). Different texts have different hashes, in practice.
std::string digest(std::string_view text);

/// Reads the code that this or an earlier process stored under `key`; nothing if it is missing or damaged.
std::optional<std::vector<char>> load(const std::string& key);

/// Stores `code` under `key`. Does nothing if the cache cannot be written.
void store(const std::string& key, const std::vector<char>& code);

}  // namespace evodevo::cuda
