// Uniform crossover (Syswerda 1989); with blocks that come and go, the crossover of NEAT (Stanley and Miikkulainen
// 2002).
#include "evodevo/plugin.hpp"

namespace {

/// The child has the blocks of the better parent. The genes of each block that the other parent has too come from
/// either parent.
class Uniform final : public evodevo::Crossover {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.real(share_, "share", {0, 1, "1"}, "Probability that a gene comes from the worse of the two parents.");
  }

  evodevo::Genome cross(const evodevo::Parents& parents, const evodevo::VariationContext& context,
                        evodevo::Rng& rng) const override {
    const evodevo::Layout& layout = context.layout;
    evodevo::Genome child = parents.better();
    const auto partners = homologous(child, parents.other(), layout);
    for (std::uint32_t block = 0; block < partners.size(); ++block)
      for (std::uint32_t gene = 0; partners[block] && gene < layout.blocks(child)[block].count; ++gene)
        if (rng.chance(share_)) copy_genes(child, block, parents.other(), *partners[block], layout, gene, gene + 1);
    return child;
  }

 private:
  double share_ = 0.5;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Uniform>("uniform",
                                                "Takes each gene from either parent, and blocks that only one has "
                                                "from the better (Syswerda 1989; Stanley and Miikkulainen 2002)."))
