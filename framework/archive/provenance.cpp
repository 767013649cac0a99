#include "archive/provenance.hpp"

#include <algorithm>

#include "operators/loader.hpp"

namespace evodevo {

Provenance this_provenance(const Experiment& experiment, const std::string& device) {
  // the file of the running program, even if a later build has replaced it on disk
  static const std::string program = file_hash("/proc/self/exe");
  return {device, EVODEVO_VERSION, program, experiment.uses};
}

bool are_same_builds(const Provenance& a, const Provenance& b) {
  const auto same_build = [](const OperatorUse& x, const OperatorUse& y) {
    return x.kind == y.kind && x.name == y.name && x.hash == y.hash;
  };
  return a.program == b.program &&
         std::equal(a.operators.begin(), a.operators.end(), b.operators.begin(), b.operators.end(), same_build);
}

bool are_same(const Provenance& a, const Provenance& b) { return a.device == b.device && are_same_builds(a, b); }

std::optional<std::uint32_t> RecordedProvenances::own(std::uint32_t recorded) const {
  const auto found = std::ranges::find(recorded_, recorded);
  if (found == recorded_.end()) return std::nullopt;
  return static_cast<std::uint32_t>(found - recorded_.begin());
}

}  // namespace evodevo
