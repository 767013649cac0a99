// Gaussian mutation with a rate for each block of genes that evolves (Kriegman, Cheney & Bongard 2018, "How
// morphological development can guide evolution", where a block is a voxel).
#include "evodevo/plugin.hpp"

namespace {

/// Adds normally distributed steps to real genes, relative to the range of each gene. Each block has a mutation rate:
/// the probability that a gene of the block changes. The rates are genes of the mutation's own, mutated before they are
/// used, so that good rates spread with the genomes that they made. Genes at the same position of all blocks, such as
/// the sizes of all voxels, are varied together: each position is drawn with the same probability, and at least one is.
/// In genomes whose blocks come and go, a block that first genomes do not have has the smallest rate.
class BlockRates final : public evodevo::Mutation {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.real(sigma_, "sigma", {1e-6, 1, "1"},
           "Standard deviation of the steps of genes, relative to the range of a gene.");
    p.real(least_rate_, "least_rate", {1e-6, 1, "1"},
           "Smallest mutation rate of a block, with which random individuals begin.");
    p.real(rate_sigma_, "rate_sigma", {0, 1, "1"}, "Standard deviation of the steps of mutation rates; 0: fixed.");
    p.real(share_, "share", {0.001, 1, "1"},
           "Probability that the genes at one position of all blocks are varied; at least one position is.");
  }

  evodevo::Layout layout(const evodevo::Layout& others) const override {
    evodevo::Layout own;
    if (others.first_blocks.empty()) return own;
    const auto blocks = static_cast<std::uint32_t>(others.first_blocks.size());
    own.add_block(blocks, {static_cast<float>(least_rate_), 1}, "rates");
    own.types.front().gene_names = {"rate"};
    return own;
  }

  evodevo::Genome random(const evodevo::Layout& own, evodevo::Rng& rng) const override {
    evodevo::Genome rates(own.first_size(), static_cast<float>(least_rate_));
    change_rates(rates.genes, rng);
    return rates;
  }

  void mutate(evodevo::Genome& genome, const evodevo::VariationContext& context, evodevo::Rng& rng) const override {
    const evodevo::Layout& layout = context.layout;
    const std::span<float> rates = layout.own_genes(genome);
    change_rates(rates, rng);
    const std::vector<std::uint8_t> varied = drawn_positions(genome, layout, rng);
    const std::vector<evodevo::Block>& blocks = layout.blocks(genome);
    for (std::uint32_t i = 0; i < blocks.size(); ++i) {
      const evodevo::BlockType& type = layout.types[blocks[i].type];
      if (type.section == layout.own) continue;
      const double rate = rate_of(blocks[i], i, layout, rates);
      for (std::uint32_t position = 0; position < blocks[i].count; ++position)
        if (const evodevo::GeneSpec& spec = type.gene(position);
            varied[position] && spec.is_real() && rng.chance(rate)) {
          float& gene = genome[blocks[i].first + position];
          const double step = sigma_ * (double{spec.high} - spec.low) * rng.normal();
          gene = std::clamp(gene + static_cast<float>(step), spec.low, spec.high);
        }
    }
  }

 private:
  void change_rates(std::span<float> rates, evodevo::Rng& rng) const {
    for (float& rate : rates)
      rate = std::clamp(rate + static_cast<float>(rate_sigma_ * rng.normal()), static_cast<float>(least_rate_), 1.0f);
  }

  /// Draws the positions whose genes are varied among those at which a block of another section has a real gene, and
  /// draws again until there is one. Returns a mark for each position.
  std::vector<std::uint8_t> drawn_positions(const evodevo::Genome& genome, const evodevo::Layout& layout,
                                            evodevo::Rng& rng) const {
    std::vector<std::uint8_t> real;
    for (const evodevo::Block& block : layout.blocks(genome)) {
      const evodevo::BlockType& type = layout.types[block.type];
      if (type.section == layout.own) continue;
      real.resize(std::max<std::size_t>(real.size(), block.count));
      for (std::uint32_t position = 0; position < block.count; ++position)
        real[position] |= type.gene(position).is_real();
    }
    std::vector<std::uint8_t> drawn(real.size());
    if (std::ranges::count(real, 1) == 0) return drawn;
    while (std::ranges::count(drawn, 1) == 0)
      for (std::size_t i = 0; i < real.size(); ++i) drawn[i] = real[i] && rng.chance(share_);
    return drawn;
  }

  /// Returns the rate of block `i` of a genome: that of the block of first genomes from which it descends.
  double rate_of(const evodevo::Block& block, std::uint32_t i, const evodevo::Layout& layout,
                 std::span<const float> rates) const {
    if (layout.is_fixed()) return rates[i];
    const auto same = [&](const evodevo::Block& first) { return first.type == block.type && first.id == block.id; };
    const auto found = std::ranges::find_if(layout.first_blocks, same) - layout.first_blocks.begin();
    return static_cast<std::size_t>(found) < rates.size() ? double{rates[found]} : least_rate_;
  }

  double sigma_ = 0.5;
  double least_rate_ = 1.0 / 48;
  double rate_sigma_ = 4.0 / 48;
  double share_ = 0.25;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<BlockRates>("block-rates",
                                                   "Adds normal steps to real genes, with a mutation rate for each "
                                                   "block that evolves (Kriegman et al. 2018)."))
