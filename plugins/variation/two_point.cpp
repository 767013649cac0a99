// Two-point crossover, which the paper plans as future work for its neural networks (section VII).
#include "evodevo/plugin.hpp"

namespace {

/// Cuts the genome of the first parent at two positions, and takes the genes between the two cuts from the blocks of
/// the second parent that have the same ids. A cut may also lie before the first gene or after the last one.
class TwoPoint final : public evodevo::Crossover {
 public:
  evodevo::Genome cross(const evodevo::Parents& parents, const evodevo::VariationContext& context,
                        evodevo::Rng& rng) const override {
    const evodevo::Layout& layout = context.layout;
    evodevo::Genome child = parents.first;
    if (child.empty()) return child;
    const auto genes = static_cast<std::uint32_t>(child.size());
    std::uint32_t begin = rng.below(genes + 1), end = rng.below(genes);
    if (end >= begin) ++end;  // so that `end` is any of the positions except `begin`
    if (begin > end) std::swap(begin, end);
    const auto partners = homologous(child, parents.second, layout);
    const std::vector<evodevo::Block>& blocks = layout.blocks(child);
    for (std::uint32_t i = 0; i < blocks.size(); ++i) {
      const std::uint32_t first = std::max(begin, blocks[i].first),
                          last = std::min(end, blocks[i].first + blocks[i].count);
      if (!partners[i] || first >= last) continue;
      copy_genes(child, i, parents.second, *partners[i], layout, first - blocks[i].first, last - blocks[i].first);
    }
    return child;
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<TwoPoint>("two-point",
                                                 "Takes the genes between two random cuts from the second parent "
                                                 "(De Jong 1975; paper, section VII)."))
