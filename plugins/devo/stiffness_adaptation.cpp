// Adapts the tension of springs by changing their stiffness (paper, section VII). In Kriegman, Cheney, Corucci &
// Bongard 2018, "Interoceptive robustness through environment-mediated morphological development", evolved robots
// became robust because their stiffness followed stress during life.
#include "evodevo/helpers/adaptation.hpp"
#include "evodevo/plugin.hpp"

namespace {

/// A body that becomes too stiff for the time step ends as invalid. Choose `high` low enough for the time step.
class StiffnessAdaptation final : public evodevo::Adaptation {
 public:
  StiffnessAdaptation() : Adaptation(1.05, 1000, 20'000) {}

  void parameters(evodevo::Parameters& p) override {
    declare(p, {1e-3, 1e9, "N/m"}, "Stiffness below which no spring is softened.",
            "Stiffness above which no spring is stiffened.");
  }

 private:
  double value(const evodevo::Body& body, std::uint32_t spring) const override {
    return body.stiffness(body.springs[spring]);
  }

  std::optional<evodevo::ChangedSpring> changed(const evodevo::Body& body, std::uint32_t spring,
                                                double value) const override {
    return evodevo::with_stiffness(body, spring, value);
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<StiffnessAdaptation>("stiffness-adaptation",
                                                            "Makes the most stressed springs stiffer or softer (paper, "
                                                            "section VII)."))
