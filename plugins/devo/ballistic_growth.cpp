// Ballistic development: genes set the sizes at birth and at the end of development, and the body grows linearly from
// one to the other, regardless of what it experiences (Kriegman, Cheney, Corucci & Bongard 2017, "A minimal
// developmental model can increase evolvability in soft robots"; paper, section II).
#include "evodevo/plugin.hpp"

namespace {

/// At each application, the rest length of every spring changes by the same amount, so that it goes from L at birth to
/// (1 + growth) L at the last application. Encodings with a parameter `size_range` give springs their growth. A spring
/// that is added during development grows like the one whose nature it takes over; others do not grow.
class BallisticGrowth final : public evodevo::Devo {
 public:
  evodevo::RecordRequest observes() const override { return {}; }
  evodevo::Traits traits() const override { return {.needs_at_birth = spring_memory()}; }
  std::vector<std::string> spring_memory() const override { return {"growth"}; }

  void develop(const evodevo::DevoContext& context, evodevo::Edits& edits, evodevo::Rng&) const override {
    bool grows = false;
    for (std::size_t s = 0; s < context.spring_memory.size(); ++s) grows = grows || context.spring_memory[s][0] != 0;
    if (grows)
      edits.scale_lengths({.from = context.application - 1.0,
                           .to = static_cast<double>(context.application),
                           .whole = static_cast<double>(context.applications)});
  }
};

}  // namespace

EVODEVO_PLUGIN(
    EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
    evodevo::operator_entry<BallisticGrowth>("ballistic-growth",
                                             "Changes rest lengths linearly from those at birth to those that "
                                             "the genes set (Kriegman et al. 2017)."))
