// The folders of operators that the user trusts. The record of a run names folders to load operators from. If somebody
// else made the record, it must not make the program run code that came with it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace evodevo {

/// The file in which the program remembers these folders, one per line: plugin-folders in $XDG_STATE_HOME/evodevo, or
/// else in $HOME/.local/state/evodevo. Empty if neither variable holds an absolute path.
std::filesystem::path plugin_memory();

/// The folders and libraries with which this user has run experiments.
std::vector<std::filesystem::path> remembered_plugin_folders();

/// Adds those of `folders` that exist to the remembered folders. Returns the reason if that failed, or an empty text if
/// it succeeded.
std::string remember_plugin_folders(const std::vector<std::filesystem::path>& folders);

/// Whether the user has named this folder or library: it is one of `given`, it is in EVODEVO_PLUGIN_PATH, or the user
/// has run an experiment with it.
bool is_named_by_user(const std::filesystem::path& folder, const std::vector<std::filesystem::path>& given);

}  // namespace evodevo
