// Ballistic development of control: genes set the phases of muscles at birth and at the end of development, and phases
// go linearly from one to the other, regardless of what the body experiences (Kriegman, Cheney & Bongard 2018, "How
// morphological development can guide evolution").
#include "evodevo/plugin.hpp"

namespace {

constexpr double full_turn = 2 * 3.14159265358979323846;

/// From its first application to its last, the phase of each muscle changes by its turn. Because it changes
/// linearly with time, the muscle simply has another frequency meanwhile: the phase passes through all values between
/// the first and the last one without a jump, and each muscle is changed twice, however many cycles there are. A
/// schedule with one application changes phases at once. Encodings with a parameter `phase_range` give springs their
/// turns; springs that take over the nature of another one during development go on like it.
class BallisticPhase final : public evodevo::Devo {
 public:
  evodevo::RecordRequest observes() const override { return {}; }
  evodevo::Traits traits() const override { return {.needs_at_birth = spring_memory()}; }
  std::vector<std::string> spring_memory() const override { return {"turn"}; }

  void develop(const evodevo::DevoContext& context, evodevo::Edits& edits, evodevo::Rng&) const override {
    const bool begins = context.application == 1, ends = context.application == context.applications;
    if (!begins && !ends) return;
    const double whole = context.last_time - context.first_time;
    for (std::uint32_t s = 0; s < context.body.springs.size(); ++s) {
      const double turn = context.spring_memory[s][0];  // rad
      evodevo::Material material = context.body.materials[context.body.springs[s].material];
      if (turn == 0 || material.amplitude == 0) continue;
      if (begins && ends)
        material.phase += turn;
      else
        turn_faster(material, (begins ? 1 : -1) * turn / whole, context.time);
      edits.change_spring(s, {.material = material});
    }
  }

 private:
  /// Lets the phase of a material go forward by `rate` more from now on, rad/s; at this time (s) it stays as it is.
  static void turn_faster(evodevo::Material& material, double rate, double time) {
    material.frequency += rate / full_turn;
    material.phase -= rate * time;
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<BallisticPhase>("ballistic-phase",
                                                       "Changes the phases of muscles linearly from those at birth to "
                                                       "those that the genes set (Kriegman et al. 2018)."))
