// The loss of a block of genes.
#include <numeric>

#include "evodevo/plugin.hpp"

namespace {

/// Removes a random block and the blocks that refer to it. If too few blocks of some type would be left, it tries
/// another block.
class RemoveBlock final : public evodevo::Mutation {
 public:
  void mutate(evodevo::Genome& genome, const evodevo::VariationContext& context, evodevo::Rng& rng) const override {
    const evodevo::Layout& layout = context.layout;
    if (layout.is_fixed()) return;
    std::vector<std::uint32_t> order(genome.blocks.size());
    std::iota(order.begin(), order.end(), 0u);
    rng.shuffle(order);
    for (const std::uint32_t block : order) {
      if (layout.types[genome.blocks[block].type].is_fixed()) continue;
      evodevo::Genome without = genome;
      remove_block(without, layout, block);
      if (!is_within_limits(without, layout)) continue;
      genome = std::move(without);
      return;
    }
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<RemoveBlock>("remove-block",
                                                    "Removes a random block of genes and all that refers to it."))
