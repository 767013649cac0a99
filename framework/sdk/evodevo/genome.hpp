// Genes, and the layout that tells operators what they are.
#pragma once

#include <cstdint>
#include <vector>

#include "evodevo/rng.hpp"

namespace evodevo {

/// One gene: a real number within bounds, or one of `choices` options, kept as the whole numbers 0 … choices-1.
struct GeneSpec {
  float low = -1, high = 1;
  std::uint32_t choices = 0;  ///< 0: a real gene

  bool is_choice() const { return choices > 0; }

  /// A fresh value, uniform over all that are allowed.
  float draw(Rng& rng) const {
    if (is_choice()) return static_cast<float>(rng.below(choices));
    return static_cast<float>(rng.uniform(low, high));
  }
};

/// Consecutive genes that belong together, such as the bias and the weights that meet in one neuron.
struct GeneGroup {
  std::uint32_t first = 0, count = 0;
};

struct Layout {
  std::vector<GeneSpec> genes;
  std::vector<GeneGroup> groups;

  /// Appends `count` genes of one kind as a group of their own.
  void add_group(std::uint32_t count, GeneSpec spec) {
    groups.push_back({static_cast<std::uint32_t>(genes.size()), count});
    genes.insert(genes.end(), count, spec);
  }
  /// Appends genes of several kinds as a group of their own.
  void add_group(const std::vector<GeneSpec>& specs) {
    groups.push_back({static_cast<std::uint32_t>(genes.size()), static_cast<std::uint32_t>(specs.size())});
    genes.insert(genes.end(), specs.begin(), specs.end());
  }
};

/// The values of the genes, in the layout's order.
using Genome = std::vector<float>;

/// A genome whose genes are drawn independently, uniform over what each may be.
inline Genome random_genome(const Layout& layout, Rng& rng) {
  Genome genome;
  genome.reserve(layout.genes.size());
  for (const GeneSpec& gene : layout.genes) genome.push_back(gene.draw(rng));
  return genome;
}

}  // namespace evodevo
