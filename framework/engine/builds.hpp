// Checks whether a run is resumed with the device and the builds with which it began.
#pragma once

#include <string>
#include <vector>

#include "archive/archive.hpp"

namespace evodevo {

/// Returns warnings if this program or the library of an operator is not a build that has taken part in the run.
std::vector<std::string> other_builds(const Experiment& experiment, const Simulator& simulator, const Archive& archive);

/// Returns a warning if the run has not been on this device yet, because results may differ between devices.
std::vector<std::string> another_device(const Simulator& simulator, const Archive& archive);

/// Throws ArchiveError if the version of an operator is not the one with which the run began. A different version means
/// that results have changed; a different build of the same version may give the same results.
void refuse_other_versions(const Experiment& experiment, const Archive& archive);

}  // namespace evodevo
