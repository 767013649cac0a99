// "Setting a random weight in the neural network encoding to a random value" (paper, section IV-B).
#include <numeric>

#include "evodevo/plugin.hpp"

namespace {

/// Works with real genes and with choice genes. A choice gene gets one of its other options, because drawing the old
/// option again would waste an evaluation on a copy.
class ResetWeight final : public evodevo::Mutation {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.integer(genes_, "genes", {1, 1'000'000, "1"}, "Number of different genes that get new random values.");
  }

  void mutate(evodevo::Genome& genome, const evodevo::Layout& layout, evodevo::Rng& rng) const override {
    const std::size_t count = std::min(genome.size(), static_cast<std::size_t>(genes_));
    std::vector<std::uint32_t> left(genome.size());
    std::iota(left.begin(), left.end(), 0u);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t drawn = rng.below(static_cast<std::uint32_t>(left.size()));
      const std::uint32_t gene = left[drawn];
      genome[gene] = other_value(genome[gene], layout.genes[gene], rng);
      left[drawn] = left.back();
      left.pop_back();
    }
  }

 private:
  static float other_value(float old, const evodevo::GeneSpec& spec, evodevo::Rng& rng) {
    if (spec.choices < 2) return spec.draw(rng);
    const auto option = static_cast<float>(rng.below(spec.choices - 1));
    return option < old ? option : option + 1;
  }

  std::int64_t genes_ = 1;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<ResetWeight>("reset-weight",
                                                    "Gives random genes new random values (paper, section IV-B)."))
