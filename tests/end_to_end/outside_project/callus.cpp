// A devo operator whose rule evolves, and which remembers.
#include <algorithm>

#include "evodevo/plugin.hpp"

namespace {

using evodevo::Spring;

/// Skin that rubs against the ground gets hard. Every mass remembers how much it was in contact lately. Springs at a
/// mass above a threshold become stiffer, four out of five of them in each cycle; a spring that has become stiffer
/// twice is supported by a new mass in its middle, the daughter of one of its ends. Two genes are the threshold and the
/// amount by which springs become stiffer.
class Callus final : public evodevo::Devo {
 public:
  evodevo::Traits traits() const override { return {.locality = 3}; }  // another spring is supported: mass and springs
  evodevo::RecordRequest observes() const override { return {.contact = true}; }
  evodevo::Measure measure(evodevo::EditKind) const override { return {"wear", "1"}; }
  std::vector<std::string> mass_memory() const override { return {"wear"}; }
  std::vector<std::string> spring_memory() const override { return {"times"}; }

  evodevo::Layout layout(const evodevo::EncodingContext&) const override {
    evodevo::Layout own;
    own.add_block_of(own.add_type({"callus", {{0, 0.5F}, {0.01F, 0.5F}}, 1, 1, {"threshold", "hardening"}}));
    return own;
  }

  void develop(const evodevo::DevoContext& context, evodevo::Edits& edits, evodevo::Rng&) const override {
    std::vector<double> wear;
    for (std::uint32_t mass = 0; mass < context.body.masses.size(); ++mass) {
      wear.push_back((context.mass_memory[mass][0] + context.contact[mass]) / 2);
      edits.remember_mass(mass, {wear[mass]});
    }
    std::optional<std::uint32_t> twice;  // the first spring that has become stiffer twice
    for (std::uint32_t s = 0; s < context.body.springs.size(); ++s) {
      const Spring& spring = context.body.springs[s];
      const double worn = std::max(wear[spring.a], wear[spring.b]);
      double times = context.spring_memory[s][0];
      if (worn > context.own[0] && spring.stiffness_factor <= 4 && context.draw(spring.a, spring.b, "hardens") <= 0.8) {
        edits.change_spring(s, {.stiffness_factor = (1 + context.own[1]) * spring.stiffness_factor, .cause = worn});
        edits.remember_spring(s, {++times});
      }
      if (times == 2 && !twice) twice = s;
    }
    if (twice)
      support(*twice, (wear[context.body.springs[*twice].a] + wear[context.body.springs[*twice].b]) / 2, context,
              edits);
  }

 private:
  static void support(std::uint32_t index, double wear, const evodevo::DevoContext& context, evodevo::Edits& edits) {
    const Spring& spring = context.body.springs[index];
    const std::uint32_t middle = edits.divide(
        std::min(spring.a, spring.b), 0.5 * (context.position(spring.a) + context.position(spring.b)), {.cause = wear});
    edits.remember_mass(middle, {wear});
    for (const std::uint32_t end : {spring.a, spring.b})
      edits.join(end, middle, context.body.materials[spring.material],
                 {.stiffness_factor = spring.stiffness_factor, .cause = wear});
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Callus>("outside.callus", "Hardens springs where a body rubs on the ground."))
