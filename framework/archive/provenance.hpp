// Provenance: the device, the build of the program and the builds of the operators that evaluated an individual.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
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

/// The provenances of an evaluator, as the archive numbers them.
class RecordedProvenances {
 public:
  /// `recorded` has an index into Archive::provenances() for each of Evaluator::provenances().
  explicit RecordedProvenances(std::vector<std::uint32_t> recorded) : recorded_(std::move(recorded)) {}

  /// Returns the index in the archive of a provenance of the evaluator.
  std::uint32_t recorded(std::uint32_t own) const { return recorded_.at(own); }
  /// Returns the index in the evaluator of a provenance of the archive; nullopt if the evaluator does not have it now.
  /// It may then find another life than the one that was scored.
  std::optional<std::uint32_t> own(std::uint32_t recorded) const;

 private:
  std::vector<std::uint32_t> recorded_;
};

}  // namespace evodevo
