// Ballistic development: genes set where growth starts and ends, and it goes there linearly, whatever happens on the
// way (Kriegman, Cheney, Corucci & Bongard 2017, "A minimal developmental model can increase evolvability in soft
// robots"; paper, section II).
#include "evodevo/plugin.hpp"

namespace {

/// The way from a spring's rest length at birth to Spring::growth times it is gone in equal parts, one at each turn. By
/// factors, so that what other operators do to a rest length stays. Encodings set `growth`, by their `size_range`;
/// springs that come later have none.
class BallisticGrowth final : public evodevo::Devo {
 public:
  evodevo::SpringRequest observes() const override { return {}; }

  void develop(const evodevo::Moment& now, evodevo::Edits& edits, evodevo::Rng&) const override {
    const auto relative_length = [&](const evodevo::Spring& spring, int turn) {
      return 1 + (static_cast<double>(spring.growth) - 1) * turn / now.turns;
    };
    for (std::uint32_t s = 0; s < now.body.springs.size(); ++s) {
      const evodevo::Spring& spring = now.body.springs[s];
      if (spring.growth == 1) continue;
      const double step = relative_length(spring, now.turn) / relative_length(spring, now.turn - 1);
      edits.changed_springs.push_back({.spring = s, .rest_length = step * spring.rest_length});
    }
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<BallisticGrowth>("ballistic-growth",
                                                        "Springs go linearly from the length at birth to the one that "
                                                        "genes set (Kriegman et al. 2017)."))
