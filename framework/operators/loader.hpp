// Finds operator libraries, checks that they fit this host, and creates operators from them.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "evodevo/plugin.hpp"
#include "operators/operator_call.hpp"

namespace evodevo {

inline constexpr std::array operator_kinds = {Encoding::kind, Mutation::kind, Crossover::kind,
                                              Devo::kind,     Fitness::kind,  Selection::kind};

/// An operator that some library brings.
struct AvailableOperator {
  const OperatorEntry* entry;
  const PluginManifest* manifest;
  std::filesystem::path file;
  const OperatorTitle* title;
};

/// A library that cannot be used, and why, with the remedy.
struct FailedLibrary {
  std::filesystem::path file;
  std::string reason;
};

/// All operators of the libraries in some folders.
class Registry {
 public:
  /// Loads every *.evodevo.so in the folders: the folders in the given order, the files of each folder in the order of
  /// their names. A path may also be that of one library. If two libraries provide an operator of the same name, the
  /// first one is used. A library that does not fit, or that crashes while it is loaded, is kept in failed() and
  /// disturbs no other. Libraries stay loaded until the process ends: an object must not outlive its code.
  explicit Registry(const std::vector<std::filesystem::path>& path);

  /// Sorted by kind and name.
  const std::vector<AvailableOperator>& operators() const { return operators_; }
  const std::vector<FailedLibrary>& failed() const { return failed_; }

  /// The operator, or nullptr.
  const AvailableOperator* find(std::string_view kind, std::string_view name) const;
  /// The names of all operators of a kind, sorted.
  std::vector<std::string> names(std::string_view kind) const;

 private:
  void load_all(const std::vector<std::filesystem::path>& files);
  void load(const std::filesystem::path& file);
  std::vector<std::filesystem::path> libraries_at(const std::filesystem::path& path);

  std::vector<AvailableOperator> operators_;
  std::vector<FailedLibrary> failed_;
};

/// A new operator with default parameters. T must be the class of the operator's kind, or Operator.
template <class T>
std::unique_ptr<T> create(const AvailableOperator& available) {
  return in_operator({available.title}, [&] { return std::unique_ptr<T>(static_cast<T*>(available.entry->create())); });
}

/// Where the operators that come with this program are.
std::filesystem::path builtin_plugin_folder();
/// The folders that the environment variable EVODEVO_PLUGIN_PATH names, separated by colons.
std::vector<std::filesystem::path> environment_plugin_folders();
/// Where operators are looked for: `own`, then EVODEVO_PLUGIN_PATH, then the program's own folder.
std::vector<std::filesystem::path> plugin_search_path(const std::vector<std::filesystem::path>& own);

/// A folder, or a library by itself.
bool is_plugin_path(const std::filesystem::path& path);

/// The hash of a file (XXH3, 64 bits) in hexadecimal. It tells one build of a library or program from another.
std::string file_hash(const std::filesystem::path& file);

}  // namespace evodevo
