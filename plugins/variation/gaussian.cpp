// Gaussian mutation with a step size that evolves (evolution strategies: Rechenberg 1973, Schwefel 1977).
#include <cmath>

#include "evodevo/plugin.hpp"

namespace {

/// Adds normally distributed steps to real genes, relative to the range of each gene. The step size is a gene of the
/// mutation's own: it is inherited, and mutated before it is used, so that good step sizes spread with the genomes that
/// they made (log-normal self-adaptation: Beyer and Schwefel 2002).
class Gaussian final : public evodevo::Mutation {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.real(sigma_, "sigma", {1e-6, 1, "1"}, "Step size of random individuals, relative to the range of a gene.");
    p.real(learning_rate_, "learning_rate", {0, 2, "1"}, "Standard deviation of the steps of ln(step size); 0: fixed.");
    p.real(share_, "share", {0, 1, "1"}, "Probability that a gene changes.");
  }

  evodevo::Layout layout(const evodevo::Layout&) const override {
    evodevo::Layout own;
    own.add_block(1, {smallest, largest}, "step");
    own.types.front().gene_names = {"ln(sigma)"};
    return own;
  }

  evodevo::Genome random(const evodevo::Layout&, evodevo::Rng&) const override {
    return {static_cast<float>(std::log(sigma_))};
  }

  void mutate(evodevo::Genome& genome, const evodevo::VariationContext& context, evodevo::Rng& rng) const override {
    const evodevo::Layout& layout = context.layout;
    float& log_sigma = layout.own_genes(genome)[0];
    log_sigma = std::clamp(log_sigma + static_cast<float>(learning_rate_ * rng.normal()), smallest, largest);
    const double sigma = std::exp(double{log_sigma});
    for (const evodevo::Block& block : layout.blocks(genome)) {
      const evodevo::BlockType& type = layout.types[block.type];
      if (type.section == layout.own) continue;
      for (std::uint32_t gene = 0; gene < block.count; ++gene)
        if (const evodevo::GeneSpec& spec = type.gene(gene); spec.is_real() && rng.chance(share_)) {
          const double step = sigma * (double{spec.high} - spec.low) * rng.normal();
          genome[block.first + gene] =
              std::clamp(genome[block.first + gene] + static_cast<float>(step), spec.low, spec.high);
        }
    }
  }

 private:
  static constexpr float smallest = -14, largest = 0;  // of ln(sigma); sigma is 1e-6 to 1

  double sigma_ = 0.1;
  double learning_rate_ = 0.2;
  double share_ = 0.1;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Gaussian>("gaussian",
                                                 "Adds normal steps to real genes, with a step size that evolves "
                                                 "(Beyer and Schwefel 2002)."))
