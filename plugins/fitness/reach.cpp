// How near a body comes to a target.
#include <algorithm>

#include "evodevo/helpers/window.hpp"
#include "evodevo/plugin.hpp"

namespace {

class Reach final : public evodevo::Fitness {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.vector(target_, "target", {-1000, 1000, "m"},
             "Place of the target, relative to the centre of mass when the window opens.");
    window_.declare_sampled(p);
  }

  evodevo::Request observes() const override { return window_.request({.centre = true}); }

  std::vector<evodevo::Objective> objectives() const override { return {{"reach", "m", false}}; }

  std::vector<double> score(const evodevo::Observation& observation) const override {
    const evodevo::Samples& samples = observation.samples;
    const evodevo::Vec3 target = samples.centre(0) + target_;
    double nearest = norm(samples.centre(0) - target);
    for (std::size_t i = 1; i < samples.size(); ++i) nearest = std::min(nearest, norm(samples.centre(i) - target));
    return {nearest};  // NaN if the first distance is, because std::min keeps it
  }

 private:
  evodevo::Vec3 target_ = {1, 0, 0};
  evodevo::MeasuringWindow window_{.rate = 20};
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Reach>("reach",
                                              "The smallest distance of the centre of mass from a target, to "
                                              "be minimised."))
