// The table [plugins], which names the folders of an experiment's operators.
#pragma once

#include <filesystem>
#include <vector>

#include "experiment/experiment.hpp"
#include "experiment/tables/tables.hpp"

namespace evodevo {

/// A path that [plugins] names.
struct NamedPath {
  std::filesystem::path path;
  std::string fault;  ///< reason why the path is not searched; empty if it is searched
};

class PluginsTable {
 public:
  PluginsTable(const toml::table& root, const ExperimentSource& source);

  /// The paths to search for operators, in this order: those in the table, those given on the command line, those in
  /// the environment variable EVODEVO_PLUGIN_PATH, and the program's own folder.
  const std::vector<std::filesystem::path>& search_path() const { return search_path_; }
  /// The part of the search path that a record stores, so that the run can be resumed without the options and the
  /// environment that it was started with: everything except the program's own folder.
  std::vector<std::filesystem::path> recorded_path(const TomlReader& top) const;
  /// Reports paths of the table that are faulty; if the experiment is the record of a run, adds warnings instead.
  void check(TomlReader& top, Warnings& warnings) const;

 private:
  const ExperimentSource& source_;
  std::vector<NamedPath> named_;
  std::vector<std::filesystem::path> search_path_;
};

}  // namespace evodevo
