// Lives of a run, lived again wherever that may be: the changes that the run has recorded are made again.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "archive.hpp"
#include "evaluation.hpp"

namespace evodevo {

/// The experiment of a run, to be simulated where its GPU may be missing.
Experiment experiment_to_live_again(const Archive& archive, std::vector<std::filesystem::path> plugin_path);

/// Warns on stderr where an individual may develop otherwise on `device` than in the run: it was born elsewhere or by
/// other builds, and there is no record to follow.
void warn_where_unsure(const Archive& archive, const Experiment& experiment, const Newborn& newborn,
                       const std::string& device);

/// An individual that lives again up to its maturity.
struct LifeAgain {
  Body born;
  Life life;  ///< refers to the individual's genome
};

/// Follows the record of the life where the run has one.
LifeAgain live_again(const Archive& archive, const Experiment& experiment, Simulator& simulator,
                     const ArchivedIndividual& individual);

}  // namespace evodevo
