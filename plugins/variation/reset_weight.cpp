// "Setting a random weight in the neural network encoding to a random value" (paper, section IV-B).
#include <numeric>

#include "evodevo/plugin.hpp"

namespace {

/// Works with all genes. A choice gene gets one of its other options, because drawing the old option again would waste
/// an evaluation on a copy.
class ResetWeight final : public evodevo::Mutation {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.integer(genes_, "genes", {1, 1'000'000, "1"}, "Number of different genes that get new random values.");
  }

  void mutate(evodevo::Genome& genome, const evodevo::VariationContext& context, evodevo::Rng& rng) const override {
    const std::size_t count = std::min(genome.size(), static_cast<std::size_t>(genes_));
    std::vector<std::uint32_t> left(genome.size());
    std::iota(left.begin(), left.end(), 0u);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t drawn = rng.below(static_cast<std::uint32_t>(left.size()));
      const std::uint32_t gene = left[drawn];
      genome[gene] = other_value(genome, context.layout, gene, rng);
      left[drawn] = left.back();
      left.pop_back();
    }
  }

 private:
  static float other_value(const evodevo::Genome& genome, const evodevo::Layout& layout, std::uint32_t gene,
                           evodevo::Rng& rng) {
    const std::uint32_t choices = layout.gene(genome, gene).choices;
    if (choices < 2) return layout.draw(genome, gene, rng);
    const auto option = static_cast<float>(rng.below(choices - 1));
    return option < genome[gene] ? option : option + 1;
  }

  std::int64_t genes_ = 1;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<ResetWeight>("reset-weight",
                                                    "Gives random genes new random values (paper, section IV-B)."))
