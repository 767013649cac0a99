// Operators on genomes whose blocks come and go.
#include <cmath>
#include <map>
#include <set>

#include "base/genome_sections.hpp"
#include "evodevo/blocks.hpp"
#include "evodevo/helpers/activations.hpp"
#include "evodevo/neat.hpp"
#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

constexpr std::uint32_t node = 0, link = 1;

/// Networks of at most 8 nodes and 12 links: at first three nodes, and links from 0 and 1 to 2.
Layout network() {
  Layout layout;
  neat::add_types(layout, 3, activation_names(), 8, 12);
  for (int i = 0; i < 3; ++i) layout.add_block_of(node);
  for (int i = 0; i < 2; ++i) layout.add_block_of(link);
  return layout;
}

Genome first_network() {
  Genome genome{0.5f, 1, -0.5f, 2, 0.25f, 0, 1.5f, 1, 0, 2, -2.5f, 1, 1, 2};
  genome.blocks = network().first_blocks;
  return genome;
}

std::set<BlockId> ids(const Genome& genome) {
  std::set<BlockId> all;
  for (const Block& block : genome.blocks) all.insert(block.id);
  return all;
}

std::uint32_t count(const Genome& genome, std::uint32_t type) { return count_blocks(genome, network(), type); }

/// Genes of the newest block of a type.
std::vector<float> newest(const Genome& genome, std::uint32_t type) {
  const auto last =
      std::find_if(genome.blocks.rbegin(), genome.blocks.rend(), [&](const Block& b) { return b.type == type; });
  const auto begin = genome.genes.begin() + last->first;
  return {begin, begin + last->count};
}

/// Returns the first network after a number of mutations.
Genome mutated(const Mutation& mutation, std::uint64_t seed, int times = 1, const Layout& layout = network()) {
  Rng rng = stream(seed);
  Genome genome = first_network();
  for (int i = 0; i < times; ++i) mutation.mutate(genome, {layout}, rng);
  return genome;
}

// blocks -------------------------------------------------------------------------------------------------------------

TEST(AddBlock, AddsOneOfAnyTypeUpToTheLimits) {
  const auto mutation = make<Mutation>("add-block");
  std::map<std::uint32_t, int> added;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const Genome genome = mutated(*mutation, seed);
    ASSERT_EQ(genome.blocks.size(), 6u);
    ++added[genome.blocks.back().type];
  }
  EXPECT_NEAR(added[node], 50, 25);
  EXPECT_NEAR(added[link], 50, 25);
  const Genome full = mutated(*mutation, 7, 40);
  EXPECT_EQ(count(full, node), 8u);
  EXPECT_EQ(count(full, link), 12u);
}

TEST(RemoveBlock, RemovesWhatRefersToItTooButLeavesAsManyAsTheLayoutAsksFor) {
  const auto mutation = make<Mutation>("remove-block");
  std::set<std::size_t> sizes;
  for (std::uint64_t seed = 0; seed < 50; ++seed) sizes.insert(mutated(*mutation, seed).blocks.size());
  EXPECT_THAT(sizes, ::testing::ElementsAre(2, 3, 4)) << "node 2 with both links, another node with its link, a link";
  Layout layout = network();
  layout.types[node].least = 3;
  layout.types[link].least = 1;
  const Genome least = mutated(*mutation, 3, 5, layout);
  EXPECT_EQ(count(least, node), 3u);
  EXPECT_EQ(count(least, link), 1u);
}

TEST(DuplicateBlock, CopiesGenesUnderANewId) {
  const auto mutation = make<Mutation>("duplicate-block");
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Genome genome = mutated(*mutation, seed);
    const Block copy = genome.blocks.back();
    EXPECT_FALSE(ids(first_network()).contains(copy.id));
    const std::vector<float> genes = newest(genome, copy.type);
    const auto original = std::search(genome.begin(), genome.end() - copy.count, genes.begin(), genes.end());
    EXPECT_NE(original, genome.end() - copy.count);
  }
}

// NEAT ---------------------------------------------------------------------------------------------------------------

TEST(AddNode, SplitsALink) {
  const Genome genome = mutated(*make<Mutation>("add-node"), 1);
  EXPECT_EQ(count(genome, node), 4u);
  EXPECT_EQ(count(genome, link), 4u);
  const bool first = genome[7] == 0;  // which of the two links is off
  EXPECT_EQ(genome[first ? 7 : 11], 0);
  EXPECT_EQ(genome[first ? 11 : 7], 1);
  EXPECT_EQ(newest(genome, node)[neat::bias], 0);
  const auto in = genome.genes.begin() + genome.blocks.end()[-2].first;
  EXPECT_EQ(std::vector<float>(in, in + 4), (std::vector<float>{1, 1, first ? 0.0f : 1.0f, 5}));
  EXPECT_EQ(newest(genome, link), (std::vector<float>{first ? 1.5f : -2.5f, 1, 5, 2}));
}

TEST(AddNode, OfTheSameLinkIsTheSameInnovation) {
  const auto mutation = make<Mutation>("add-node");
  std::set<std::set<BlockId>> outcomes;
  for (std::uint64_t seed = 0; seed < 30; ++seed) outcomes.insert(ids(mutated(*mutation, seed)));
  EXPECT_EQ(outcomes.size(), 2u) << "one for each link";
}

TEST(AddNode, SplitsNoLinkOfWhichAPartIsThere) {
  const auto mutation = make<Mutation>("add-node");
  const std::uint32_t added = 5, in = 6, out = 7;  // the blocks of the first split
  for (const auto& [kept, end] : {std::pair{in, neat::to}, {out, neat::from}, {added, neat::on}})
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      Genome genome = mutated(*mutation, seed);
      if (kept != added) {
        genome[genome.blocks[kept].first + end] =
            2;  // another mutation saves the link from being removed with the node
        remove_block(genome, network(), added);
        ASSERT_EQ(count(genome, link), 3u);
      }
      for (const Block& block : genome.blocks)
        if (block.type == link) genome[block.first + neat::on] = 1;
      Rng rng = stream(seed);
      for (int i = 0; i < 4; ++i) mutation->mutate(genome, {network()}, rng);
      ASSERT_GT(count(genome, node), 3u);
      ASSERT_EQ(genome_fault(genome, network()), "") << seed;
    }
}

TEST(AddLink, JoinsEveryPairOnce) {
  const Genome genome = mutated(*make<Mutation>("add-link", "attempts = 200"), 1, 20);
  std::set<std::pair<float, float>> pairs;
  for (const Block& block : genome.blocks)
    if (block.type == link) pairs.emplace(genome[block.first + neat::from], genome[block.first + neat::to]);
  EXPECT_EQ(pairs.size(), 6u) << "three nodes, two directions";
  EXPECT_EQ(count(genome, link), 6u);
}

TEST(AddLink, BetweenTheSameNodesIsTheSameInnovation) {
  const auto mutation = make<Mutation>("add-link", "attempts = 200");
  std::map<std::pair<float, float>, std::set<BlockId>> seen;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const Genome genome = mutated(*mutation, seed);
    const std::vector<float> added = newest(genome, link);
    seen[{added[neat::from], added[neat::to]}].insert(genome.blocks.back().id);
  }
  EXPECT_EQ(seen.size(), 4u);
  for (const auto& [pair, of_pair] : seen) EXPECT_EQ(of_pair.size(), 1u);
}

/// Returns the x coordinates that a network gives to the points of the ball, and the points themselves.
std::pair<std::vector<double>, std::vector<Vec3>> mapped(const Genome& genome) {
  const Blueprint blueprint = decoded(*make<Encoding>("neat", "points = 40\nside = 2.0"), genome);
  std::pair<std::vector<double>, std::vector<Vec3>> result;
  for (const Mass& mass : blueprint.body.masses) result.first.push_back(mass.rest.x);
  result.second = blueprint.origins;
  return result;
}

TEST(Neat, FirstNetworksAreLinear) {
  const auto encoding = make<Encoding>("neat", "points = 40\nside = 2.0");
  const Layout layout = encoding->layout(context());
  EXPECT_EQ(layout.first_blocks.size(), 4u + 8 + 32);
  Rng rng = stream(5);
  const Genome genome = encoding->random(layout, rng);
  EXPECT_EQ(genome_fault(genome, layout), "");
  const auto [x, points] = mapped(genome);
  const auto gene = [&](std::size_t block, std::uint32_t index) {
    return double{genome[genome.blocks[block].first + index]};
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    // links 0 to 3 lead from the inputs to x, the first output, which is node 4
    const double sum = gene(4, neat::bias) + gene(12, neat::weight) * points[i].x +
                       gene(13, neat::weight) * points[i].y + gene(14, neat::weight) * points[i].z +
                       gene(15, neat::weight) * norm(points[i]);
    EXPECT_NEAR(x[i], std::tanh(sum), 1e-12);
  }
}

TEST(Neat, HiddenNodesComputeTheirFunctions) {
  const auto encoding = make<Encoding>("neat", "points = 40\nside = 2.0");
  const Layout layout = encoding->layout(context());
  Rng rng = stream(6);
  Genome genome = encoding->random(layout, rng);
  for (const Block& block : genome.blocks) genome[block.first] = 0;                            // all weights and biases
  const std::uint32_t hidden = add_block(genome, layout, 0, std::vector<float>{0.5f, 2}, 77);  // a sine
  const auto at = static_cast<float>(hidden);
  add_block(genome, layout, 1, std::vector<float>{2, 1, 1, at}, 78);      // of y
  add_block(genome, layout, 1, std::vector<float>{0.75f, 1, at, 4}, 79);  // to x
  add_block(genome, layout, 1, std::vector<float>{3, 0, 2, 4}, 80);       // a link that is off
  add_block(genome, layout, 1, std::vector<float>{3, 1, 4, at}, 81);      // a link that closes a cycle
  EXPECT_EQ(genome_fault(genome, layout), "");
  const auto [x, points] = mapped(genome);
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_NEAR(x[i], std::tanh(0.75 * std::sin(0.5 + 2 * points[i].y)), 1e-12);
}

TEST(Neat, BearsTheLossOfAnyBlock) {
  const auto encoding = make<Encoding>("neat", "points = 20");
  const Layout layout = encoding->layout(context());
  const auto remove = make<Mutation>("remove-block");
  Rng rng = stream(7);
  Genome genome = encoding->random(layout, rng);
  while (!genome.blocks.empty()) {
    remove->mutate(genome, {layout}, rng);
    EXPECT_EQ(decoded(*encoding, genome).body.masses.size(), 20u);
  }
}

// crossovers ---------------------------------------------------------------------------------------------------------

TEST(Uniform, TakesBlocksOfTheBetterAndAsManyGenesOfTheWorseAsAskedFor) {
  const Layout layout = network();
  Genome worse = first_network(), better = first_network();
  worse[0] = 0.625f;
  worse[10] = 2.5f;
  add_block(worse, layout, node, std::vector<float>{1, 0}, 88);
  add_block(better, layout, node, std::vector<float>{2, 0}, 99);
  const auto expect_children = [&](const char* toml, const Parents& parents, double share, double tolerance) {
    const auto crossover = make<Crossover>("uniform", toml);
    int from_worse = 0;
    Rng rng = stream(1);
    for (int i = 0; i < 400; ++i) {
      const Genome child = crossover->cross(parents, {layout}, rng);
      EXPECT_EQ(ids(child), ids(better));
      EXPECT_TRUE(child[10] == -2.5f || child[10] == 2.5f);
      from_worse += child[10] == 2.5f;
    }
    EXPECT_NEAR(from_worse, 400 * share, tolerance);
  };
  expect_children("", {worse, better, true}, 0.5, 50);
  expect_children("share = 0.1", {worse, better, true}, 0.1, 30);
  expect_children("share = 0.1", {better, worse, false}, 0.1, 30);
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
