// Simulated binary crossover (Deb and Agrawal 1995).
#include <cmath>

#include "evodevo/plugin.hpp"

namespace {

/// Draws each real gene near the genes of both parents, with the spread of a one-point crossover of bits: values near a
/// parent are likely, and the mean of the two possible children is that of the parents. Other genes, and blocks that
/// only one parent has, come from the first parent.
class Sbx final : public evodevo::Crossover {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.real(index_, "index", {0, 1000, "1"}, "Distribution index eta; the larger, the closer children are to parents.");
  }

  evodevo::Genome cross(const evodevo::Parents& parents, const evodevo::VariationContext& context,
                        evodevo::Rng& rng) const override {
    const evodevo::Layout& layout = context.layout;
    evodevo::Genome child = parents.first;
    const auto partners = homologous(child, parents.second, layout);
    const std::vector<evodevo::Block>&mine = layout.blocks(child), &theirs = layout.blocks(parents.second);
    for (std::uint32_t block = 0; block < partners.size(); ++block) {
      if (!partners[block]) continue;
      for (std::uint32_t gene = 0; gene < mine[block].count; ++gene)
        if (const evodevo::GeneSpec& spec = layout.types[mine[block].type].gene(gene); spec.is_real())
          blend(child[mine[block].first + gene], parents.second[theirs[*partners[block]].first + gene], spec, rng);
    }
    return child;
  }

 private:
  void blend(float& one, float other, const evodevo::GeneSpec& spec, evodevo::Rng& rng) const {
    const double u = rng.uniform(), exponent = 1 / (index_ + 1);
    const double spread = u < 0.5 ? std::pow(2 * u, exponent) : std::pow(1 / (2 * (1 - u)), exponent);
    const double sign = rng.chance(0.5) ? 1 : -1;  // either of the two possible children
    const double value = 0.5 * ((1 + sign * spread) * double{one} + (1 - sign * spread) * double{other});
    if (one != other) one = std::clamp(static_cast<float>(value), spec.low, spec.high);
  }

  double index_ = 2;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Sbx>("sbx", "Simulated binary crossover of real genes (Deb and Agrawal 1995)."))
