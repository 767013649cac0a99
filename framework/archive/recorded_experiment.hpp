// The experiment in the record of a run.
#pragma once

#include <filesystem>
#include <vector>

#include "archive/archive.hpp"

namespace evodevo {

/// Returns the settings of a run from its record, without loading any operator.
Settings recorded_settings(const Archive& archive);

/// Returns the experiment of a run from its record, and loads its operators, for which it also searches the folders in
/// `plugin_path`.
Experiment recorded_experiment(const Archive& archive, std::vector<std::filesystem::path> plugin_path = {},
                               std::vector<Override> overrides = {});

}  // namespace evodevo
