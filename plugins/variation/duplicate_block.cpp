// Gene duplication (Ohno 1970): a copy of a block, which can then change while the original keeps its function.
#include "evodevo/helpers/block_choice.hpp"
#include "evodevo/plugin.hpp"

namespace {

/// Adds a copy of a random block, with an id of its own. References of the copy go where those of the original go.
class DuplicateBlock final : public evodevo::Mutation {
 public:
  void mutate(evodevo::Genome& genome, const evodevo::VariationContext& context, evodevo::Rng& rng) const override {
    const auto block = random_item(growable_blocks(genome, context.layout), rng);
    if (!block) return;
    const evodevo::Block original = genome.blocks[*block];
    add_block(genome, context.layout, original.type, std::span(genome.genes).subspan(original.first, original.count),
              evodevo::fresh_id(rng));
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<DuplicateBlock>("duplicate-block",
                                                       "Adds a copy of a random block of genes (Ohno 1970)."))
