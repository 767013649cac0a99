// How much two genomes differ, by their homologous blocks (the compatibility of Stanley and Miikkulainen 2002, for
// genomes of any layout).
#pragma once

#include <cmath>

#include "evodevo/blocks.hpp"

namespace evodevo {

/// The difference between two genomes; both numbers are from 0 to 1.
struct GenomeDistance {
  double blocks = 0;  ///< share of the blocks of both genomes that have no homologous one in the other
  double genes = 0;   ///< mean difference between the genes of homologous blocks; see genome_distance()
};

/// Compares two genomes of a layout. Real genes differ by their distance relative to their range. Choices differ by 0
/// or 1, and so do references, which are equal if they refer to homologous blocks.
inline GenomeDistance genome_distance(const Genome& one, const Genome& other, const Layout& layout) {
  const auto partners = homologous(one, other, layout);
  const std::vector<Block>&mine = layout.blocks(one), &theirs = layout.blocks(other);
  std::size_t paired = 0, genes = 0;
  double sum = 0;
  for (std::uint32_t i = 0; i < mine.size(); ++i) {
    if (!partners[i]) continue;
    const Block &a = mine[i], &b = theirs[*partners[i]];
    ++paired;
    genes += a.count;
    for (std::uint32_t gene = 0; gene < a.count; ++gene) {
      const GeneSpec& spec = layout.types[a.type].gene(gene);
      const float x = one[a.first + gene], y = other[b.first + gene];
      if (spec.is_reference())
        sum += partners[target_of(one, layout, a, gene)] != target_of(other, layout, b, gene);
      else if (spec.is_choice())
        sum += x != y;
      else if (spec.high > spec.low)
        sum += std::abs(double{x} - y) / (double{spec.high} - spec.low);
    }
  }
  const std::size_t blocks = mine.size() + theirs.size();
  return {blocks == 0 ? 0 : 1 - 2.0 * static_cast<double>(paired) / static_cast<double>(blocks),
          genes == 0 ? 0 : sum / static_cast<double>(genes)};
}

}  // namespace evodevo
