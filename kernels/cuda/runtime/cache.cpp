#include "cuda/runtime/cache.hpp"

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace evodevo::cuda {
namespace {

namespace fs = std::filesystem;

/// The FNV-1a hash.
std::uint64_t fnv(std::string_view text, std::uint64_t start) {
  std::uint64_t hash = start;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
  return hash;
}

/// The folder that a variable of the environment names. A relative one would be another wherever a command is typed,
/// and counts as none, as the XDG Base Directory Specification says.
std::optional<fs::path> folder_of(const char* variable) {
  const char* value = std::getenv(variable);
  if (value == nullptr || !fs::path(value).is_absolute()) return std::nullopt;
  return value;
}

/// The cache's folder, where the environment names one.
std::optional<fs::path> folder() {
  if (const auto cache = folder_of("XDG_CACHE_HOME")) return *cache / "evodevo" / "kernels";
  if (const auto home = folder_of("HOME")) return *home / ".cache" / "evodevo" / "kernels";
  return std::nullopt;
}

}  // namespace

std::string digest(std::string_view text) {
  char name[33];
  std::snprintf(name, sizeof name, "%016llx%016llx", static_cast<unsigned long long>(fnv(text, 0xcbf29ce484222325ull)),
                static_cast<unsigned long long>(fnv(text, 0x9e3779b97f4a7c15ull)));
  return name;
}

std::optional<std::vector<char>> load(const std::string& key) {
  const auto from = folder();
  if (!from) return std::nullopt;
  std::ifstream file(*from / key, std::ios::binary);
  const std::string content{std::istreambuf_iterator<char>(file), {}};
  // a file holds the digest of the code and the code
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
  // written aside and renamed, so that another process never reads half a file
  const fs::path aside = *to / (key + "." + std::to_string(getpid()));
  std::ofstream file(aside, std::ios::binary);
  file << digest({code.data(), code.size()}) << std::string_view(code.data(), code.size());
  file.close();
  if (file) fs::rename(aside, *to / key, ignored);
  fs::remove(aside, ignored);
}

}  // namespace evodevo::cuda
