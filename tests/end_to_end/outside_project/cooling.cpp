// A mutation whose steps become smaller from generation to generation, as in simulated annealing (Kirkpatrick et al.
// 1983).
#include <algorithm>
#include <cmath>

#include "evodevo/plugin.hpp"

namespace {

/// Adds a uniformly distributed step to each real gene. The largest one halves every `half_life` generations.
class Cooling final : public evodevo::Mutation {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.real(step_, "step", {1e-6, 1, "1"}, "Largest step in generation 0, relative to the range of a gene.");
    p.real(half_life_, "half_life", {0.1, 1e6, "generations"}, "Generations in which the largest step halves.");
  }

  void mutate(evodevo::Genome& genome, const evodevo::VariationContext& context, evodevo::Rng& rng) const override {
    const double largest = step_ * std::exp2(-static_cast<double>(context.generation) / half_life_);
    for (const evodevo::Block& block : context.layout.blocks(genome)) {
      const evodevo::BlockType& type = context.layout.types[block.type];
      for (std::uint32_t gene = 0; gene < block.count; ++gene)
        if (const evodevo::GeneSpec& spec = type.gene(gene); spec.is_real()) {
          float& value = genome[block.first + gene];
          const double step = largest * (double{spec.high} - spec.low) * rng.uniform(-1, 1);
          value = std::clamp(static_cast<float>(value + step), spec.low, spec.high);
        }
    }
  }

 private:
  double step_ = 0.2, half_life_ = 20;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Cooling>("outside.cooling",
                                                "Adds steps to real genes that become smaller from generation to "
                                                "generation (Kirkpatrick et al. 1983)."))
