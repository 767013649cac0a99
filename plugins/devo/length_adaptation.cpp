// Adapts the tension of springs by changing their rest lengths (paper, section VII).
#include "evodevo/helpers/adaptation.hpp"
#include "evodevo/plugin.hpp"

namespace {

/// The bounds are relative to the rest length with which the spring was created, so that they hold for a whole life,
/// however the spring's masses move. Springs that were created with a rest length of zero stay as they are.
class LengthAdaptation final : public evodevo::Adaptation {
 public:
  LengthAdaptation() : Adaptation(0.98, 0.7, 1.3) {}

  void parameters(evodevo::Parameters& p) override {
    declare(p, {0.01, 100, "1"}, "Shortest rest length, relative to the first rest length of the spring.",
            "Longest rest length, relative to the first rest length of the spring.");
  }

 private:
  double value(const evodevo::Body& body, std::uint32_t index) const override {
    const evodevo::Spring& spring = body.springs[index];
    return spring.first_length > 0 ? spring.rest_length / spring.first_length : 0;
  }

  std::optional<evodevo::ChangedSpring> changed(const evodevo::Body& body, std::uint32_t index,
                                                double value) const override {
    return evodevo::ChangedSpring{.rest_length = value * body.springs[index].first_length};
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<LengthAdaptation>("length-adaptation",
                                                         "Makes the most stressed springs shorter or longer (paper, "
                                                         "section VII)."))
