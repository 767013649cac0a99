// A new block of genes with random values.
#include "evodevo/helpers/block_choice.hpp"
#include "evodevo/plugin.hpp"

namespace {

/// Adds a block of a random type among those that may have one more. References of the block go to random blocks of
/// their types. A type without blocks whose blocks refer to a type without blocks gets none.
class AddBlock final : public evodevo::Mutation {
 public:
  void mutate(evodevo::Genome& genome, const evodevo::VariationContext& context, evodevo::Rng& rng) const override {
    const evodevo::Layout& layout = context.layout;
    std::vector<std::uint32_t> types;
    for (std::uint32_t type = 0; type < layout.types.size(); ++type)
      if (count_blocks(genome, layout, type) < layout.types[type].most && has_targets(genome, layout, type))
        types.push_back(type);
    const auto type = random_item(types, rng);
    if (!type) return;
    const std::vector<float> genes(layout.types[*type].genes.size(), 0);
    const std::uint32_t first = genome.blocks[add_block(genome, layout, *type, genes, evodevo::fresh_id(rng))].first;
    for (std::size_t gene = first; gene < first + genes.size(); ++gene) genome[gene] = layout.draw(genome, gene, rng);
  }

 private:
  /// Whether there are blocks to which the references of a new block can go. It may refer to itself.
  static bool has_targets(const evodevo::Genome& genome, const evodevo::Layout& layout, std::uint32_t type) {
    const std::vector<evodevo::GeneSpec>& genes = layout.types[type].genes;
    return std::all_of(genes.begin(), genes.end(), [&](const evodevo::GeneSpec& gene) {
      return !gene.is_reference() || *gene.refers_to == type || count_blocks(genome, layout, *gene.refers_to) > 0;
    });
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<AddBlock>("add-block", "Adds a block of random genes."))
