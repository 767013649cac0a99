// Compiled kernels on disk.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace evodevo::cuda {

/// A short name for `text`; equal texts have equal names, and others practically never.
std::string digest(std::string_view text);

/// What store() kept under `key`, from this or an earlier process; nothing where it is missing or damaged.
std::optional<std::vector<char>> load(const std::string& key);

/// Keeps `code` under `key` for later. Where the cache cannot be written, nothing happens.
void store(const std::string& key, const std::vector<char>& code);

}  // namespace evodevo::cuda
