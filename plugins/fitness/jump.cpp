// How high a body jumps.
#include <algorithm>

#include "evodevo/helpers/window.hpp"
#include "evodevo/plugin.hpp"

namespace {

/// The height of a body is that of its lowest mass, so that a body which only stretches or stands up does not jump.
/// A way uphill counts as height.
class Jump final : public evodevo::Fitness {
 public:
  void parameters(evodevo::Parameters& p) override { window_.declare_sampled(p); }

  evodevo::Request observes() const override { return window_.request({.box = true}); }

  std::vector<evodevo::Objective> objectives() const override { return {{"jump", "m", true}}; }

  std::vector<double> score(const evodevo::Observation& observation) const override {
    const evodevo::Samples& samples = observation.samples;
    const double ground = samples.box(0).low.z;
    double highest = ground;
    for (std::size_t i = 1; i < samples.size(); ++i) highest = std::max(highest, samples.box(i).low.z);
    return {highest - ground};  // NaN if the first height is, because std::max keeps it
  }

 private:
  evodevo::MeasuringWindow window_{.rate = 100};
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Jump>("jump",
                                             "The largest height of the lowest mass above its height when the "
                                             "window opens; a way uphill counts."))
