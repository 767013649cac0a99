// Ballistic development: genes set the sizes at birth and at the end of development, and the body grows linearly from
// one to the other, regardless of what it experiences (Kriegman, Cheney, Corucci & Bongard 2017, "A minimal
// developmental model can increase evolvability in soft robots"; paper, section II).
#include "evodevo/plugin.hpp"

namespace {

/// At each application, the rest length of every spring changes by the same amount, so that it goes from L at birth to
/// Spring::growth * L at the last application. Encodings with a parameter `size_range` set Spring::growth; springs that
/// are added during development do not grow.
class BallisticGrowth final : public evodevo::Devo {
 public:
  evodevo::RecordRequest observes() const override { return {}; }
  bool uses_growth() const override { return true; }

  void develop(const evodevo::DevoContext& context, evodevo::Edits& edits, evodevo::Rng&) const override {
    const auto& springs = context.body.springs;
    if (std::all_of(springs.begin(), springs.end(), [](const auto& spring) { return spring.growth == 1; })) return;
    edits.growth = {context.application - 1.0, static_cast<double>(context.application),
                    static_cast<double>(context.applications)};
  }
};

}  // namespace

EVODEVO_PLUGIN(
    EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
    evodevo::operator_entry<BallisticGrowth>("ballistic-growth",
                                             "Changes rest lengths linearly from those at birth to those that "
                                             "the genes set (Kriegman et al. 2017)."))
