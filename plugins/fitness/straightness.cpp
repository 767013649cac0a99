// How straight a body moves.
#include "evodevo/helpers/window.hpp"
#include "evodevo/plugin.hpp"

namespace {

/// The distance along the ground from the start to the end, relative to the length of the path between them. The centre
/// of mass of a walker swings to and fro with every stroke of its muscles; a low rate leaves that out.
class Straightness final : public evodevo::Fitness {
 public:
  void parameters(evodevo::Parameters& p) override { window_.declare_sampled(p); }

  evodevo::Request observes() const override { return window_.request({.centre = true}); }

  std::vector<evodevo::Objective> objectives() const override { return {{"straightness", "1", true}}; }

  std::vector<double> score(const evodevo::Observation& observation) const override {
    const evodevo::Samples& samples = observation.samples;
    double length = 0;
    for (std::size_t i = 1; i < samples.size(); ++i) length += along_ground(samples.centre(i) - samples.centre(i - 1));
    if (length == 0) return {0};  // it does not move
    return {along_ground(samples.centre(samples.size() - 1) - samples.centre(0)) / length};
  }

 private:
  static double along_ground(evodevo::Vec3 way) { return norm(evodevo::Vec3{way.x, way.y, 0}); }

  evodevo::MeasuringWindow window_{.rate = 1};
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Straightness>(
                   "straightness", "The distance from start to end, relative to the length of the path: 0 to 1."))
