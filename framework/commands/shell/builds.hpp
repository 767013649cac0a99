// Checks whether a run is resumed with the device and the builds with which it began.
#pragma once

#include "evolution/archive/archive.hpp"

namespace evodevo {

/// Warns if this program or the library of an operator is not the build with which the run began.
void warn_of_other_builds(const Experiment& experiment, const Simulator& simulator, const Archive& archive);

/// Warns if the run began on another device, because results may differ between devices.
void warn_of_another_device(const Simulator& simulator, const Archive& archive);

/// Throws ArchiveError if the version of an operator is not the one with which the run began. A different version means
/// that results have changed; a different build of the same version may give the same results.
void refuse_other_versions(const Experiment& experiment, const Archive& archive);

}  // namespace evodevo
