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

/// An operator that a loaded library provides.
struct AvailableOperator {
  const OperatorEntry* entry;
  const PluginManifest* manifest;
  std::filesystem::path file;
  const OperatorTitle* title;
};

/// A library that cannot be used. `reason` says why, and what to do about it.
struct FailedLibrary {
  std::filesystem::path file;
  std::string reason;
};

/// The operators of all libraries in a list of folders.
class Registry {
 public:
  /// Loads every *.evodevo.so in the folders. Folders are loaded in the given order, and the files in a folder in the
  /// order of their names. An item of `path` may also be a single library. A library that does not fit this host, that
  /// crashes while it is loaded, or that provides an operator of the same kind and name as an earlier library, is
  /// listed in failed() and does not affect the others. Libraries stay loaded until the process ends, because an object
  /// must not outlive its code.
  explicit Registry(const std::vector<std::filesystem::path>& path);

  /// The operators, sorted by kind and name.
  const std::vector<AvailableOperator>& operators() const { return operators_; }
  const std::vector<FailedLibrary>& failed() const { return failed_; }

  /// The operator of this kind and name, or nullptr if there is none.
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

/// Creates an operator with default parameters. T must be the class of the operator's kind, or Operator.
template <class T>
std::unique_ptr<T> create(const AvailableOperator& available) {
  return in_operator({available.title}, [&] { return std::unique_ptr<T>(static_cast<T*>(available.entry->create())); });
}

/// The folder of the operators that come with this program.
std::filesystem::path builtin_plugin_folder();
/// Sets this folder, for code that runs in another program, such as Python. To be called before operators are loaded.
void set_builtin_plugin_folder(std::filesystem::path folder);
/// The folders that the environment variable EVODEVO_PLUGIN_PATH names, separated by colons.
std::vector<std::filesystem::path> environment_plugin_folders();
/// The paths to search for operators, in this order: `own`, EVODEVO_PLUGIN_PATH, and the program's own folder.
std::vector<std::filesystem::path> plugin_search_path(const std::vector<std::filesystem::path>& own);

/// Whether `path` is a folder or a single library of operators.
bool is_plugin_path(const std::filesystem::path& path);

/// The hash of a file (XXH3, 64 bits) in hexadecimal. It distinguishes the builds of a library or program.
std::string file_hash(const std::filesystem::path& file);

}  // namespace evodevo
