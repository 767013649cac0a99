// Whether a run goes on with the device and the builds that it began with.
#pragma once

#include "evolution/archive/archive.hpp"

namespace evodevo {

/// Warns where this program or a library of an operator is not the build that the run began with.
void warn_of_other_builds(const Experiment& experiment, const Simulator& simulator, const Archive& archive);

/// Warns where the run began on another device, which may change results.
void warn_of_another_device(const Simulator& simulator, const Archive& archive);

/// Throws ArchiveError where an operator has another version than when the run began: another build of the same version
/// may do the same, another version says that it does not.
void refuse_other_versions(const Experiment& experiment, const Archive& archive);

}  // namespace evodevo
