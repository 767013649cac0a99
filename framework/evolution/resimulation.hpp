// Lives of a run, lived again wherever that may be: the changes that the run has recorded are made again.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "evolution/archive.hpp"
#include "life/evaluation.hpp"

namespace evodevo {

/// The experiment of a run, to be simulated where its GPU may be missing.
Experiment experiment_to_live_again(const Archive& archive, std::vector<std::filesystem::path> plugin_path);

/// An individual of a run, to live again on `device`: it is to follow the record of its life where the run has one.
/// Warns on stderr where it may develop otherwise than in the run: there is no record, and it was born elsewhere or by
/// other builds. Refers to the individual's genome.
Newborn born_again(const Archive& archive, const Experiment& experiment, const Individual& individual,
                   const std::string& device);

}  // namespace evodevo
