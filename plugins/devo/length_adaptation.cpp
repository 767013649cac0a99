// Tension by rest length (paper, section VII).
#include "adaptation.hpp"
#include "evodevo/plugin.hpp"

namespace {

/// The bounds are relative to the distance of the spring's masses in the undeformed body, so that they hold for a whole
/// life; springs whose masses rest in one place stay as they are.
class LengthAdaptation final : public Adaptation {
 public:
  LengthAdaptation() : Adaptation(0.98, 0.7, 1.3) {}

  void parameters(evodevo::Parameters& p) override {
    declare(p, {0.01, 100, "1"}, "Shortest rest length, relative to the distance of the masses' rest places.",
            "Longest rest length, relative to the distance of the masses' rest places.");
  }

 private:
  static double rest_distance(const evodevo::Body& body, const evodevo::Spring& spring) {
    return norm(body.masses[spring.b].rest - body.masses[spring.a].rest);
  }

  double value(const evodevo::Body& body, std::uint32_t index) const override {
    const evodevo::Spring& spring = body.springs[index];
    const double distance = rest_distance(body, spring);
    return distance > 0 ? spring.rest_length / distance : 0;
  }

  void change(const evodevo::Body& body, std::uint32_t index, double value, evodevo::Edits& edits) const override {
    edits.changed_springs.push_back({.spring = index, .rest_length = value * rest_distance(body, body.springs[index])});
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<LengthAdaptation>("length-adaptation",
                                                         "The most stressed springs get shorter or longer (paper, "
                                                         "section VII)."))
