// How high the centre of mass rises.
#include <algorithm>

#include "evodevo/plugin.hpp"

namespace {

class Leap final : public evodevo::Fitness {
 public:
  evodevo::Request observes() const override {
    return {.settle = 0.5, .window = 1, .rate = 50, .channels = {.centre = true}};
  }

  std::vector<evodevo::Objective> objectives() const override { return {{"leap", "m"}}; }

  std::vector<double> score(const evodevo::Observation& seen) const override {
    double highest = seen.centre_before.z;
    for (std::size_t i = 0; i < seen.samples.size(); ++i) highest = std::max(highest, seen.samples.centre(i).z);
    return {highest - seen.centre_before.z};
  }
};

}  // namespace

EVODEVO_PLUGIN("1.0.0", "MIT", evodevo::operator_entry<Leap>("outside.leap", "The height that the centre gains."))
