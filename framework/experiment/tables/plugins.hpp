// [plugins]: where an experiment looks for its operators.
#pragma once

#include <filesystem>
#include <vector>

#include "experiment/experiment.hpp"
#include "experiment/tables/tables.hpp"

namespace evodevo {

/// A path that [plugins] names, and why it is not looked at; empty where it is.
struct NamedPath {
  std::filesystem::path path;
  std::string fault;
};

class PluginsTable {
 public:
  PluginsTable(const toml::table& root, const ExperimentSource& source);

  /// Where operators are looked for: in the paths of the table, then in those of the command line and of the
  /// environment, then in the program's own folder.
  const std::vector<std::filesystem::path>& search_path() const { return search_path_; }
  /// The part of the search path that a record stores, so that the run can be resumed without the options and the
  /// environment that it was started with: everything except the program's own folder.
  std::vector<std::filesystem::path> recorded_path(const TomlReader& top) const;
  /// Refuses paths that are not looked at; of those of a record, warns.
  void check(TomlReader& top, Warnings& warnings) const;

 private:
  const ExperimentSource& source_;
  std::vector<NamedPath> named_;
  std::vector<std::filesystem::path> search_path_;
};

}  // namespace evodevo
