// Differences between genomes, computed by hand.
#include "evodevo/helpers/selection/homology.hpp"

#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// A node has one real gene in [0, 10]; a link has a choice of three and a reference to a node.
struct Network {
  Layout layout;
  std::uint32_t node, link;

  Network() {
    node = layout.add_type({.name = "node", .genes = {{.low = 0, .high = 10}}, .least = 0, .most = 100});
    link = layout.add_type({.name = "link", .genes = {{.choices = 3}, {.refers_to = node}}, .least = 0, .most = 100});
  }
  Genome genome(std::vector<std::pair<BlockId, float>> nodes) const {
    Genome genome;
    for (const auto& [id, value] : nodes) add_block(genome, layout, node, std::vector{value}, id);
    return genome;
  }
  void add_link(Genome& genome, BlockId id, float choice, float to) const {
    add_block(genome, layout, link, std::vector{choice, to}, id);
  }
};

const Network network;

void expect_distance(const Genome& one, const Genome& other, double blocks, double genes) {
  for (const auto& [a, b] : {std::pair(&one, &other), std::pair(&other, &one)}) {
    const GenomeDistance found = genome_distance(*a, *b, network.layout);
    EXPECT_NEAR(found.blocks, blocks, 1e-12);
    EXPECT_NEAR(found.genes, genes, 1e-7);
  }
}

TEST(GenomeDistance, CountsBlocksWithoutCounterpart) {
  expect_distance(network.genome({{1, 5}, {2, 5}, {3, 5}}), network.genome({{3, 5}, {4, 5}}), 3 / 5.0, 0);
  expect_distance(network.genome({{1, 5}}), network.genome({{2, 9}}), 1, 0);
  expect_distance({}, {}, 0, 0);
}

TEST(GenomeDistance, ComparesGenesByTheirRanges) {
  expect_distance(network.genome({{1, 2}, {2, 10}}), network.genome({{2, 0}, {1, 5}}), 0, (0.3 + 1) / 2);
}

TEST(GenomeDistance, ComparesChoicesAndWhatReferencesMean) {
  Genome one = network.genome({{1, 0}, {2, 0}}), other = network.genome({{2, 0}, {1, 0}});
  network.add_link(one, 7, 2, 0);    // to node 1
  network.add_link(other, 7, 1, 1);  // to node 1 as well, another choice
  expect_distance(one, other, 0, 1 / 4.0);
  other[3] = 0;  // to node 2
  expect_distance(one, other, 0, 2 / 4.0);
}

TEST(GenomeDistance, OfFixedLayoutsComparesAllGenes) {
  Layout layout;
  layout.add_block({{.low = -1, .high = 1}, {.choices = 2}});
  layout.add_block({{.low = 3, .high = 3}});
  const GenomeDistance found = genome_distance({-1, 0, 3}, {1, 1, 3}, layout);
  EXPECT_EQ(found.blocks, 0);
  EXPECT_NEAR(found.genes, 2 / 3.0, 1e-12);
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
