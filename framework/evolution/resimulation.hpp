// Re-simulation: lives of a run are simulated again on this machine, with the edits that the run has recorded.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "archive/archive.hpp"
#include "life/evaluation.hpp"

namespace evodevo {

/// Returns the experiment of a run, changed so that it can be simulated on a machine without a GPU.
Experiment experiment_for_resimulation(const Archive& archive, std::vector<std::filesystem::path> plugin_path);

/// Returns individuals of a run as newborns to be simulated again on `device`, each with the records of its lives if
/// the run has them. If bodies develop, there is no record, and the individual was made by another device or by other
/// builds, its development may differ from that in the run; the function then warns on stderr, once for all individuals
/// that were made in the same other way. The newborns refer to the individuals' genomes.
std::vector<Newborn> for_resimulation(const Archive& archive, const Experiment& experiment,
                                      const std::vector<const Individual*>& individuals, const std::string& device);
/// Does the same for one individual.
Newborn for_resimulation(const Archive& archive, const Experiment& experiment, const Individual& individual,
                         const std::string& device);

}  // namespace evodevo
