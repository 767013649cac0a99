// A mutation with a gene of its own.
#include <algorithm>
#include <cmath>

#include "evodevo/plugin.hpp"

namespace {

/// Gives each gene a new random value with a probability that is a gene of the mutation's own. This gene is inherited,
/// and changes before it is used.
class AdaptiveReset final : public evodevo::Mutation {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.real(rate_, "rate", {0.001, 1, "1"}, "Probability, in random individuals, that a gene gets a new value.");
    p.real(learning_rate_, "learning_rate", {0, 2, "1"}, "Standard deviation of the steps of ln(rate).");
  }

  evodevo::Layout layout(const evodevo::Layout&) const override {
    evodevo::Layout own;
    own.add_block(1, {smallest, 0}, "rate");
    own.types.front().gene_names = {"ln(rate)"};
    return own;
  }

  evodevo::Genome random(const evodevo::Layout&, evodevo::Rng&) const override {
    return {static_cast<float>(std::log(rate_))};
  }

  void mutate(evodevo::Genome& genome, const evodevo::VariationContext& context, evodevo::Rng& rng) const override {
    const evodevo::Layout& layout = context.layout;
    float& log_rate = layout.own_genes(genome)[0];
    log_rate = std::clamp(log_rate + static_cast<float>(learning_rate_ * rng.normal()), smallest, 0.0F);
    const double rate = std::exp(double{log_rate});
    for (const evodevo::Block& block : layout.blocks(genome))
      if (layout.types[block.type].section != layout.own)
        for (std::uint32_t gene = block.first; gene < block.first + block.count; ++gene)
          if (rng.chance(rate)) genome[gene] = layout.draw(genome, gene, rng);
  }

 private:
  static constexpr float smallest = -7;  // of ln(rate); the smallest rate is 0.0009

  double rate_ = 0.1;
  double learning_rate_ = 0.3;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<AdaptiveReset>("outside.adaptive-reset",
                                                      "Draws genes anew, at a rate that evolves."))
