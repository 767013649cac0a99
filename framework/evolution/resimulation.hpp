// Lives of a run, simulated again on this machine: the changes that the run has recorded are applied again.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "evolution/archive/archive.hpp"
#include "life/evaluation.hpp"

namespace evodevo {

/// The experiment of a run, to be simulated where its GPU may be missing.
Experiment experiment_for_resimulation(const Archive& archive, std::vector<std::filesystem::path> plugin_path);

/// An individual of a run, to be simulated again on `device`. It follows the record of its life where the run has one.
/// Warns on stderr where it may develop otherwise than in the run: there is no record, and it was born elsewhere or by
/// other builds. Refers to the individual's genome.
Newborn for_resimulation(const Archive& archive, const Experiment& experiment, const Individual& individual,
                         const std::string& device);

}  // namespace evodevo
