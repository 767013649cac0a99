// Provenance: the device, the build of this program and the builds of the operators that made a generation of a run.
#pragma once

#include <string>
#include <vector>

#include "experiment/experiment.hpp"

namespace evodevo {

struct Provenance {
  std::string device;
  std::string version;  ///< version of evodevo
  std::string program;  ///< hash of the program's executable file
  std::vector<OperatorUse> operators;
};

/// Returns the provenance of this process: this program, `device` and the operators loaded for the experiment.
Provenance this_provenance(const Experiment& experiment, const std::string& device);

/// Returns whether both have the same builds of the program and of all operators, regardless of where their files are.
bool are_same_builds(const Provenance& a, const Provenance& b);

/// Returns whether both have the same device and the same builds, so that their results are equal to the last bit.
bool are_same(const Provenance& a, const Provenance& b);

}  // namespace evodevo
