// What made a generation of a run: a device, a build of this program and builds of operators.
#pragma once

#include <string>
#include <vector>

#include "experiment/experiment.hpp"

namespace evodevo {

struct Provenance {
  std::string device;
  std::string version;  ///< of evodevo
  std::string program;  ///< hash of its file
  std::vector<OperatorUse> operators;
};

/// This program with the operators that it has loaded for the experiment.
Provenance this_provenance(const Experiment& experiment, const std::string& device);

/// Whether the program and all operators are the same builds, wherever their files lie.
bool are_same_builds(const Provenance& a, const Provenance& b);

/// Whether what both make is the same to the last bit: on the same device by the same builds.
bool are_same(const Provenance& a, const Provenance& b);

}  // namespace evodevo
