// "The distance a robot can travel in a given direction [...] in terms of the number of body-lengths covered" (paper,
// section IV-E).

#include "evodevo/helpers/window.hpp"
#include "evodevo/plugin.hpp"

namespace {

/// The body length is the longest side of the bounding box when the window opens, or the same number for all bodies,
/// so that bodies do not gain from being short. In the paper, bodies settle for 3 s; the default here is 10 s because
/// some bodies topple for longer than 3 s. Bodies that swim need not settle.
class Distance final : public evodevo::Fitness {
 public:
  void parameters(evodevo::Parameters& p) override {
    direction_.declare(p);
    p.optional_real(length_, "length", {1e-6, 1e6, "m"},
                    "Body length in which distances are measured; without it, the longest side of each body when the "
                    "window opens.");
    p.flag(developing_, "developing",
           "Whether bodies settle from birth on and are measured while they develop, instead of after they have "
           "matured; development must last until the window closes.");
    window_.declare(p);
  }

  evodevo::Request observes() const override {
    evodevo::Request request = direction_.with_direction(window_.request());
    if (developing_) request.cycle = 0;
    return request;
  }

  std::vector<evodevo::Objective> objectives() const override { return {{"distance", "body lengths", true}}; }

  std::vector<double> score(const evodevo::Observation& observation) const override {
    const evodevo::Box& box = observation.box;
    // a body whose masses all lie at one point has no length, and neither does a body with a NaN position
    if (!(norm(box.high - box.low) > 0)) return {std::numeric_limits<double>::quiet_NaN()};
    return {direction_.distance(observation) / length_.value_or(box.longest_side())};
  }

 private:
  evodevo::MeasuredDirection direction_;
  std::optional<double> length_;
  bool developing_ = false;
  evodevo::MeasuringWindow window_;
};

}  // namespace

EVODEVO_PLUGIN(
    EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
    evodevo::operator_entry<Distance>("distance",
                                      "The distance that the centre of mass moves in a direction, in body lengths "
                                      "(paper, section IV-E)."))
