// The folders from which the record of a run may load code. A record that comes from elsewhere must not make the
// program run the code that lies beside it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace evodevo {

/// The file in which the folders are remembered, one a line: plugin-folders in $XDG_STATE_HOME/evodevo or else in
/// ~/.local/state/evodevo. Empty where neither variable names a place.
std::filesystem::path plugin_memory();

/// The folders and libraries with which this user has run experiments.
std::vector<std::filesystem::path> remembered_plugin_folders();

/// Adds to them what is there. Returns what kept it from that; empty where nothing did.
std::string remember_plugin_folders(const std::vector<std::filesystem::path>& folders);

/// Whether the user has named this folder or library: as one of `given`, in EVODEVO_PLUGIN_PATH, or in an experiment
/// that was run.
bool is_named_by_user(const std::filesystem::path& folder, const std::vector<std::filesystem::path>& given);

}  // namespace evodevo
