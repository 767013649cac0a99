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
  evodevo::Measure measure(evodevo::Causes::List) const override { return {"wear", "1"}; }
  std::vector<std::string> mass_memory() const override { return {"wear"}; }
  std::vector<std::string> spring_memory() const override { return {"times"}; }

  evodevo::Layout layout(const evodevo::EncodingContext&) const override {
    evodevo::Layout own;
    own.add_block_of(own.add_type({"callus", {{0, 0.5F}, {0.01F, 0.5F}}, 1, 1, {"threshold", "hardening"}}));
    return own;
  }

  void develop(const evodevo::DevoContext& context, evodevo::Edits& edits, evodevo::Rng&) const override {
    for (std::size_t mass = 0; mass < context.body.masses.size(); ++mass)
      edits.mass_memory.push_back((context.mass_memory[mass][0] + context.contact[mass]) / 2);
    for (std::uint32_t s = 0; s < context.body.springs.size(); ++s) {
      const Spring& spring = context.body.springs[s];
      const double wear = std::max(edits.mass_memory[spring.a], edits.mass_memory[spring.b]);
      edits.spring_memory.push_back(context.spring_memory[s][0]);
      if (wear <= context.own[0] || spring.stiffness_factor > 4) continue;
      if (context.draw(spring.a, spring.b, "hardens") > 0.8) continue;
      edits.changed_springs.push_back(
          {.spring = s, .stiffness_factor = (1 + context.own[1]) * spring.stiffness_factor});
      edits.causes.changed_springs.push_back(wear);
      edits.spring_memory[s] += 1;
    }
    support(context, edits);
  }

 private:
  /// Supports the first spring that has become stiffer twice.
  static void support(const evodevo::DevoContext& context, evodevo::Edits& edits) {
    const auto twice = std::find(edits.spring_memory.begin(), edits.spring_memory.end(), 2);
    if (twice == edits.spring_memory.end()) return;
    const Spring& spring = context.body.springs[static_cast<std::size_t>(twice - edits.spring_memory.begin())];
    const double wear = (edits.mass_memory[spring.a] + edits.mass_memory[spring.b]) / 2;
    const auto middle = static_cast<std::uint32_t>(context.body.masses.size());
    edits.new_masses.push_back({.position = 0.5 * (context.position(spring.a) + context.position(spring.b)),
                                .mass = context.mass,
                                .mother = std::min(spring.a, spring.b)});
    edits.causes.new_masses.push_back(wear);
    edits.mass_memory.push_back(wear);
    for (const std::uint32_t end : {spring.a, spring.b}) {
      edits.new_springs.push_back({end, middle, context.body.materials[spring.material], {}, spring.stiffness_factor});
      edits.causes.new_springs.push_back(wear);
      edits.spring_memory.push_back(0);
    }
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Callus>("outside.callus", "Hardens springs where a body rubs on the ground."))
