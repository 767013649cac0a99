// Genomes, and the layout that describes their genes.
#pragma once

#include <cstdint>
#include <vector>

#include "evodevo/rng.hpp"

namespace evodevo {

/// The values that one gene may have. The value of a real gene is a number from `low` to `high`; the value of a choice
/// gene is the index of one of `choices` options, a whole number from 0 to choices-1.
struct GeneSpec {
  float low = -1, high = 1;
  std::uint32_t choices = 0;  ///< number of options; 0: a real gene

  bool is_choice() const { return choices > 0; }

  /// Returns a random value, uniformly distributed over all allowed values.
  float draw(Rng& rng) const {
    if (is_choice()) return static_cast<float>(rng.below(choices));
    return static_cast<float>(rng.uniform(low, high));
  }
};

/// Consecutive genes that belong together, such as the bias and the input weights of one neuron.
struct GeneGroup {
  std::uint32_t first = 0, count = 0;
};

/// The description of all genes of a genome.
struct Layout {
  std::vector<GeneSpec> genes;
  std::vector<GeneGroup> groups;

  /// Appends `count` genes with the same description and makes them a group.
  void add_group(std::uint32_t count, GeneSpec spec) {
    groups.push_back({static_cast<std::uint32_t>(genes.size()), count});
    genes.insert(genes.end(), count, spec);
  }
  /// Appends genes with the given descriptions and makes them a group.
  void add_group(const std::vector<GeneSpec>& specs) {
    groups.push_back({static_cast<std::uint32_t>(genes.size()), static_cast<std::uint32_t>(specs.size())});
    genes.insert(genes.end(), specs.begin(), specs.end());
  }
};

/// The values of the genes, in the order of Layout::genes.
using Genome = std::vector<float>;

/// Returns a genome whose genes are independent and uniformly distributed over their allowed values.
inline Genome random_genome(const Layout& layout, Rng& rng) {
  Genome genome;
  genome.reserve(layout.genes.size());
  for (const GeneSpec& gene : layout.genes) genome.push_back(gene.draw(rng));
  return genome;
}

}  // namespace evodevo
