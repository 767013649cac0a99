#include "cuda/runtime/cache.hpp"

#define XXH_INLINE_ALL  // from the header alone, so that no library is needed at run time
#include <fmt/format.h>
#include <unistd.h>
#include <xxhash.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace evodevo::cuda {
namespace {

namespace fs = std::filesystem;

/// The folder that an environment variable names. A relative path is ignored, as the XDG Base Directory Specification
/// requires, because it would mean a different folder in each working directory.
std::optional<fs::path> folder_of(const char* variable) {
  const char* value = std::getenv(variable);
  if (value == nullptr || !fs::path(value).is_absolute()) return std::nullopt;
  return value;
}

/// The folder of the cache; nothing if the environment names no folder.
std::optional<fs::path> folder() {
  if (const auto cache = folder_of("XDG_CACHE_HOME")) return *cache / "evodevo" / "kernels";
  if (const auto home = folder_of("HOME")) return *home / ".cache" / "evodevo" / "kernels";
  return std::nullopt;
}

}  // namespace

std::string digest(std::string_view text) {
  const XXH128_hash_t hash = XXH3_128bits(text.data(), text.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::optional<std::vector<char>> load(const std::string& key) {
  const auto from = folder();
  if (!from) return std::nullopt;
  std::ifstream file(*from / key, std::ios::binary);
  const std::string content{std::istreambuf_iterator<char>(file), {}};
  // a file contains the digest of the code and the code
  const std::size_t length = digest({}).size();
  if (content.size() <= length) return std::nullopt;
  const std::string_view code = std::string_view(content).substr(length);
  if (content.compare(0, length, digest(code)) != 0) return std::nullopt;
  return std::vector<char>(code.begin(), code.end());
}

void store(const std::string& key, const std::vector<char>& code) {
  const auto to = folder();
  if (!to) return;
  std::error_code ignored;
  fs::create_directories(*to, ignored);
  // written to another file and renamed, so that other processes never read an incomplete file
  const fs::path aside = *to / (key + "." + std::to_string(getpid()));
  std::ofstream file(aside, std::ios::binary);
  file << digest({code.data(), code.size()}) << std::string_view(code.data(), code.size());
  file.close();
  if (file) fs::rename(aside, *to / key, ignored);
  fs::remove(aside, ignored);
}

}  // namespace evodevo::cuda
