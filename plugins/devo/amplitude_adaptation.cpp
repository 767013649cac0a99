// Adapts the tension of springs by changing the amplitude of muscles (paper, section VII): the most stressed muscles
// become stronger, as if trained, or weaker, as if tired.
#include "evodevo/helpers/adaptation.hpp"
#include "evodevo/plugin.hpp"

namespace {

/// Springs with an amplitude of zero are not muscles; the operator skips them.
class AmplitudeAdaptation final : public evodevo::Adaptation {
 public:
  AmplitudeAdaptation() : Adaptation(1.05, 0.02, 0.3) {}

  void parameters(evodevo::Parameters& p) override {
    declare(p, {0, evodevo::largest_amplitude, "1"},
            "Amplitude, relative to the rest length, below which no muscle is weakened.",
            "Amplitude, relative to the rest length, above which no muscle is strengthened.");
  }

 private:
  double value(const evodevo::Body& body, std::uint32_t spring) const override {
    return body.materials[body.springs[spring].material].amplitude;
  }

  std::optional<evodevo::ChangedSpring> changed(const evodevo::Body& body, std::uint32_t spring,
                                                double value) const override {
    evodevo::Material material = body.materials[body.springs[spring].material];
    material.amplitude = value;
    return evodevo::ChangedSpring{.material = material};
  }
};

}  // namespace

EVODEVO_PLUGIN(
    EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
    evodevo::operator_entry<AmplitudeAdaptation>("amplitude-adaptation",
                                                 "Makes the most stressed muscles stronger or weaker (paper, "
                                                 "section VII)."))
