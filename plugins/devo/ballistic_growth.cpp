// Ballistic development: genes set where growth starts and ends, and it goes there linearly, whatever happens on the
// way (Kriegman, Cheney, Corucci & Bongard 2017, "A minimal developmental model can increase evolvability in soft
// robots"; paper, section II).
#include "evodevo/plugin.hpp"

namespace {

/// The way from a spring's rest length at birth to Spring::growth times it is gone in equal parts, one at each
/// application. Encodings set `growth`, by their `size_range`; springs that come later have none.
class BallisticGrowth final : public evodevo::Devo {
 public:
  evodevo::SpringRequest observes() const override { return {}; }
  bool uses_growth() const override { return true; }

  void develop(const evodevo::DevoContext& context, evodevo::Edits& edits, evodevo::Rng&) const override {
    const auto& springs = context.body.springs;
    if (std::all_of(springs.begin(), springs.end(), [](const auto& spring) { return spring.growth == 1; })) return;
    edits.growth = {context.application - 1.0, static_cast<double>(context.application),
                    static_cast<double>(context.applications)};
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<BallisticGrowth>("ballistic-growth",
                                                        "Springs go linearly from the length at birth to the one that "
                                                        "genes set (Kriegman et al. 2017)."))
