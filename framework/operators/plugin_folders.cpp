#include "operators/plugin_folders.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <optional>

#include "operators/loader.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

/// The path in an environment variable; none if the variable is not set or the path is relative.
std::optional<fs::path> place_in(const char* variable) {
  const char* text = std::getenv(variable);
  if (text == nullptr || !fs::path(text).is_absolute()) return std::nullopt;
  return fs::path(text);
}

/// The canonical path of a folder, with all symbolic links resolved; empty if the folder does not exist.
fs::path real_place(const fs::path& folder) {
  std::error_code error;
  fs::path path = fs::canonical(folder, error);
  return error ? fs::path() : path;
}

bool contains(const std::vector<fs::path>& folders, const fs::path& folder) {
  return std::find(folders.begin(), folders.end(), folder) != folders.end();
}

}  // namespace

fs::path plugin_memory() {
  if (const auto state = place_in("XDG_STATE_HOME")) return *state / "evodevo" / "plugin-folders";
  if (const auto home = place_in("HOME")) return *home / ".local" / "state" / "evodevo" / "plugin-folders";
  return {};
}

std::vector<fs::path> remembered_plugin_folders() {
  std::vector<fs::path> folders;
  std::ifstream stream(plugin_memory());
  for (std::string line; std::getline(stream, line);)
    if (const fs::path folder(line); folder.is_absolute()) folders.push_back(folder);
  return folders;
}

std::string remember_plugin_folders(const std::vector<fs::path>& folders) {
  const std::vector<fs::path> known = remembered_plugin_folders();
  std::string lines;
  for (const fs::path& folder : folders) {
    const fs::path path = real_place(folder);
    const bool is_a_line = !path.empty() && path.string().find('\n') == std::string::npos;
    if (is_a_line && !contains(known, path)) lines += path.string() + "\n";
  }
  if (lines.empty()) return "";
  const fs::path memory = plugin_memory();
  if (memory.empty()) return "neither HOME nor XDG_STATE_HOME names a place";
  std::error_code error;
  fs::create_directories(memory.parent_path(), error);
  std::ofstream stream(memory, std::ios::app);
  stream << lines << std::flush;  // in one write, so that runs that begin at the same time do not mix their lines
  return stream ? "" : memory.string() + " cannot be written";
}

bool is_named_by_user(const fs::path& folder, const std::vector<fs::path>& given) {
  const fs::path path = real_place(folder);
  if (path.empty()) return false;
  std::vector<fs::path> named = remembered_plugin_folders();
  for (const std::vector<fs::path>& list : {given, environment_plugin_folders()})
    for (const fs::path& item : list) named.push_back(real_place(item));
  return contains(named, path);
}

}  // namespace evodevo
