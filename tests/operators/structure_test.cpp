// Operators on genomes whose blocks come and go, and on the values of their genes.
#include <cmath>
#include <map>
#include <set>

#include "base/genome_sections.hpp"
#include "evodevo/blocks.hpp"
#include "evodevo/neat.hpp"
#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

constexpr std::uint32_t node = 0, link = 1;

/// Networks of at most 8 nodes and 12 links: at first three nodes, and links from 0 and 1 to 2.
Layout network() {
  Layout layout;
  neat::add_types(layout, 3, 5, 8, 12);
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

// blocks -------------------------------------------------------------------------------------------------------------

class Structural : public ::testing::TestWithParam<const char*> {};

TEST_P(Structural, KeepsGenomesWithinTheirLayout) {
  const auto mutation = make<Mutation>(GetParam());
  const Layout layout = network();
  Rng rng = stream(1);
  for (int start = 0; start < 20; ++start) {
    Genome genome = random_genome(layout, rng);
    for (int i = 0; i < 40; ++i) {
      mutation->mutate(genome, layout, rng);
      ASSERT_EQ(genome_fault(genome, layout), "");
    }
  }
}

TEST_P(Structural, LeavesGenomesAloneWhoseBlocksAreFixed) {
  Layout layout;
  layout.add_block(3, {-1, 1});
  Rng rng = stream(2);
  const Genome before = random_genome(layout, rng);
  Genome genome = before;
  make<Mutation>(GetParam())->mutate(genome, layout, rng);
  EXPECT_EQ(genome, before);
}

INSTANTIATE_TEST_SUITE_P(Mutations, Structural,
                         ::testing::Values("add-block", "remove-block", "duplicate-block", "add-node", "add-link"));

TEST(AddBlock, AddsOneOfAnyTypeUpToTheLimits) {
  const auto mutation = make<Mutation>("add-block");
  std::map<std::uint32_t, int> added;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Rng rng = stream(seed);
    Genome genome = first_network();
    mutation->mutate(genome, network(), rng);
    ASSERT_EQ(genome.blocks.size(), 6u);
    ++added[genome.blocks.back().type];
  }
  EXPECT_NEAR(added[node], 50, 25);
  EXPECT_NEAR(added[link], 50, 25);
  Genome full = first_network();
  Rng rng = stream(7);
  for (int i = 0; i < 40; ++i) mutation->mutate(full, network(), rng);
  EXPECT_EQ(count(full, node), 8u);
  EXPECT_EQ(count(full, link), 12u);
}

TEST(RemoveBlock, RemovesWhatRefersToItToo) {
  const auto mutation = make<Mutation>("remove-block");
  std::set<std::size_t> sizes;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Rng rng = stream(seed);
    Genome genome = first_network();
    mutation->mutate(genome, network(), rng);
    sizes.insert(genome.blocks.size());
  }
  EXPECT_THAT(sizes, ::testing::ElementsAre(2, 3, 4)) << "node 2 with both links, another node with its link, a link";
}

TEST(RemoveBlock, LeavesAsManyAsTheLayoutAsksFor) {
  Layout layout = network();
  layout.types[node].least = 3;
  layout.types[link].least = 1;
  const auto mutation = make<Mutation>("remove-block");
  Rng rng = stream(3);
  Genome genome = first_network();
  for (int i = 0; i < 5; ++i) mutation->mutate(genome, layout, rng);
  EXPECT_EQ(count(genome, node), 3u);
  EXPECT_EQ(count(genome, link), 1u);
}

TEST(DuplicateBlock, CopiesGenesUnderANewId) {
  const auto mutation = make<Mutation>("duplicate-block");
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Rng rng = stream(seed);
    Genome genome = first_network();
    const std::set<BlockId> before = ids(genome);
    mutation->mutate(genome, network(), rng);
    const Block copy = genome.blocks.back();
    EXPECT_FALSE(before.contains(copy.id));
    const std::vector<float> genes = newest(genome, copy.type);
    const auto original = std::search(genome.begin(), genome.end() - copy.count, genes.begin(), genes.end());
    EXPECT_NE(original, genome.end() - copy.count);
  }
}

// NEAT ---------------------------------------------------------------------------------------------------------------

TEST(AddNode, SplitsALink) {
  const auto mutation = make<Mutation>("add-node");
  Rng rng = stream(1);
  Genome genome = first_network();
  mutation->mutate(genome, network(), rng);
  EXPECT_EQ(count(genome, node), 4u);
  EXPECT_EQ(count(genome, link), 4u);
  const bool first = genome[7] == 0;  // which of the two links is off
  EXPECT_EQ(genome[first ? 7 : 11], 0);
  EXPECT_EQ(genome[first ? 11 : 7], 1);
  EXPECT_EQ(newest(genome, node)[neat::bias], 0);
  const auto in = genome.blocks.end()[-2].first;
  EXPECT_EQ(std::vector<float>(genome.genes.begin() + in, genome.genes.begin() + in + 4),
            (std::vector<float>{1, 1, first ? 0.0f : 1.0f, 5}));
  EXPECT_EQ(newest(genome, link), (std::vector<float>{first ? 1.5f : -2.5f, 1, 5, 2}));
}

TEST(AddNode, OfTheSameLinkIsTheSameInnovation) {
  const auto mutation = make<Mutation>("add-node");
  std::set<std::set<BlockId>> outcomes;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    Rng rng = stream(seed);
    Genome genome = first_network();
    mutation->mutate(genome, network(), rng);
    outcomes.insert(ids(genome));
  }
  EXPECT_EQ(outcomes.size(), 2u) << "one for each link";
}

TEST(AddNode, SplitsNoLinkTwice) {
  const auto mutation = make<Mutation>("add-node");
  Rng rng = stream(1);
  Genome genome = first_network();
  mutation->mutate(genome, network(), rng);
  for (const Block& block : genome.blocks)
    if (block.type == link) genome[block.first + neat::on] = 1;
  const std::set<BlockId> once = ids(genome);
  for (int i = 0; i < 3; ++i) mutation->mutate(genome, network(), rng);
  EXPECT_EQ(ids(genome).size(), genome.blocks.size());
  EXPECT_GT(genome.blocks.size(), once.size()) << "but other links";
}

TEST(AddNode, SplitsNoLinkOfWhichAPartIsThere) {
  const auto mutation = make<Mutation>("add-node");
  const std::uint32_t added = 5, in = 6, out = 7;  // the blocks of the first split
  for (const auto& [kept, end] : {std::pair{in, neat::to}, {out, neat::from}})
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      Rng rng = stream(seed);
      Genome genome = first_network();
      mutation->mutate(genome, network(), rng);
      genome[genome.blocks[kept].first + end] = 2;  // another mutation saves the link from being removed with the node
      remove_block(genome, network(), added);
      ASSERT_EQ(count(genome, link), 3u);
      for (const Block& block : genome.blocks)
        if (block.type == link) genome[block.first + neat::on] = 1;
      for (int i = 0; i < 4; ++i) mutation->mutate(genome, network(), rng);
      ASSERT_GT(count(genome, node), 3u);
      ASSERT_EQ(genome_fault(genome, network()), "") << seed;
    }
}

TEST(AddLink, JoinsEveryPairOnce) {
  const auto mutation = make<Mutation>("add-link", "attempts = 200");
  Rng rng = stream(1);
  Genome genome = first_network();
  for (int i = 0; i < 20; ++i) mutation->mutate(genome, network(), rng);
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
    Rng rng = stream(seed);
    Genome genome = first_network();
    mutation->mutate(genome, network(), rng);
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
    remove->mutate(genome, layout, rng);
    EXPECT_EQ(decoded(*encoding, genome).body.masses.size(), 20u);
  }
}

// crossovers ---------------------------------------------------------------------------------------------------------

TEST(Uniform, TakesBlocksOfTheBetterAndGenesOfBoth) {
  const auto crossover = make<Crossover>("uniform");
  const Layout layout = network();
  Genome worse = first_network(), better = first_network();
  for (float& gene : worse.genes) gene = gene == 0.5f ? 0.625f : gene;
  worse[10] = 2.5f;
  add_block(worse, layout, node, std::vector<float>{1, 0}, 88);
  add_block(better, layout, node, std::vector<float>{2, 0}, 99);
  int from_worse = 0;
  Rng rng = stream(1);
  for (int i = 0; i < 400; ++i) {
    const Genome child = crossover->cross({worse, better, true}, layout, rng);
    EXPECT_EQ(ids(child), ids(better));
    EXPECT_EQ(genome_fault(child, layout), "");
    EXPECT_TRUE(child[10] == -2.5f || child[10] == 2.5f);
    from_worse += child[10] == 2.5f;
  }
  EXPECT_NEAR(from_worse, 200, 50);
}

TEST(Uniform, TakesTheShareOfTheWorseThatIsAskedFor) {
  const auto crossover = make<Crossover>("uniform", "share = 0.1");
  const Layout layout = network();
  Genome worse = first_network();
  const Genome better = first_network();
  worse[10] = 2.5f;
  Rng rng = stream(2);
  for (const auto& parents : {Parents{worse, better, true}, Parents{better, worse, false}}) {
    int from_worse = 0;
    for (int i = 0; i < 400; ++i) from_worse += crossover->cross(parents, layout, rng)[10] == 2.5f;
    EXPECT_NEAR(from_worse, 40, 30);
  }
}

TEST(Sbx, SpreadsChildrenAsDebAndAgrawalSay) {
  Layout layout;
  layout.add_block(1, {-100, 100});
  layout.add_block(1, {0, 0, 3});
  const Genome first{-1, 2}, second{3, 0};  // the mean is 1, and half the distance is 2
  const auto crossover = make<Crossover>("sbx", "index = 2.0");
  Rng rng = stream(2);
  constexpr int children = 20000;
  int within_half = 0, within_one = 0;
  double sum = 0;
  for (int i = 0; i < children; ++i) {
    const Genome child = crossover->cross({first, second}, layout, rng);
    EXPECT_EQ(child[1], 2) << "a choice is not blended";
    const double spread = std::abs(child[0] - 1) / 2;
    within_half += spread < 0.5;
    within_one += spread < 1;
    sum += child[0];
  }
  // the distribution function of the spread b is b^3 / 2 up to 1 (index 2)
  EXPECT_NEAR(static_cast<double>(within_half) / children, 0.0625, 0.008);
  EXPECT_NEAR(static_cast<double>(within_one) / children, 0.5, 0.015);
  EXPECT_NEAR(sum / children, 1, 0.1);
}

// gaussian -----------------------------------------------------------------------------------------------------------

/// A layout with 1,000 real genes in [-1, 1], one choice, and the mutation's own section.
Layout with_own(const Mutation& mutation) {
  Layout others;
  others.add_block(1000, {-1, 1});
  others.add_block(1, {0, 0, 3});
  Layout whole{.sections = {}};
  add_section(whole, "encoding", others);
  whole.own = add_section(whole, "gaussian", mutation.layout(others));
  return whole;
}

Genome zeros(const Mutation& mutation, const Layout& whole) {
  Rng rng = stream(1);
  Genome others(1001, 0);
  return join({others, mutation.random(mutation.layout(whole), rng)}, whole);
}

TEST(Gaussian, StepsAreNormal) {
  const auto mutation = make<Mutation>("gaussian", "sigma = 0.05\nlearning_rate = 0.0\nshare = 1.0");
  const Layout layout = with_own(*mutation);
  double sum = 0, squares = 0, beyond = 0;
  Rng rng = stream(2);
  for (int i = 0; i < 20; ++i) {
    Genome genome = zeros(*mutation, layout);
    mutation->mutate(genome, layout, rng);
    EXPECT_EQ(genome[1000], 0) << "a choice";
    for (std::size_t gene = 0; gene < 1000; ++gene) {
      sum += genome[gene];
      squares += double{genome[gene]} * genome[gene];
      beyond += std::abs(genome[gene]) > 0.1;
    }
  }
  // the standard deviation is 0.05 of the range, 0.1
  EXPECT_NEAR(sum / 20000, 0, 0.003);
  EXPECT_NEAR(std::sqrt(squares / 20000), 0.1, 0.002);
  EXPECT_NEAR(beyond / 20000, 0.3173, 0.015) << "beyond one standard deviation";
}

TEST(Gaussian, ChangesTheShareOfGenesThatIsAskedFor) {
  const auto mutation = make<Mutation>("gaussian", "share = 0.25");
  const Layout layout = with_own(*mutation);
  Rng rng = stream(5);
  int changed = 0;
  for (int i = 0; i < 20; ++i) {
    Genome genome = zeros(*mutation, layout);
    mutation->mutate(genome, layout, rng);
    for (std::size_t gene = 0; gene < 1000; ++gene) changed += genome[gene] != 0;
  }
  EXPECT_NEAR(changed, 5000, 310);
}

TEST(Gaussian, StepSizeIsInheritedAndVaries) {
  const auto mutation = make<Mutation>("gaussian", "sigma = 0.05\nlearning_rate = 0.3");
  const Layout layout = with_own(*mutation);
  double sum = 0, squares = 0;
  Rng rng = stream(3);
  for (int i = 0; i < 2000; ++i) {
    Genome genome = zeros(*mutation, layout);
    EXPECT_FLOAT_EQ(genome[1001], std::log(0.05f));
    mutation->mutate(genome, layout, rng);
    const double step = genome[1001] - std::log(0.05);
    sum += step;
    squares += step * step;
  }
  EXPECT_NEAR(sum / 2000, 0, 0.03);
  EXPECT_NEAR(std::sqrt(squares / 2000), 0.3, 0.02);
}

TEST(Gaussian, EvolvesItsStepSizeOnASphere) {
  // a (1, 10) strategy on f = |x|^2 in ten dimensions: with self-adaptation it approaches the optimum by its own scale
  const auto mutation = make<Mutation>("gaussian", "sigma = 0.2\nlearning_rate = 0.3\nshare = 1.0");
  Layout others;
  others.add_block(10, {-1, 1});
  Layout layout{.sections = {}};
  add_section(layout, "encoding", others);
  layout.own = add_section(layout, "gaussian", mutation->layout(others));
  Rng rng = stream(4);
  const auto f = [](const Genome& g) {
    double sum = 0;
    for (std::size_t i = 0; i < 10; ++i) sum += double{g[i]} * g[i];
    return sum;
  };
  Genome parent = join({Genome(10, 0.9f), mutation->random(mutation->layout(others), rng)}, layout);
  for (int generation = 0; generation < 300; ++generation) {
    Genome best;
    for (int i = 0; i < 10; ++i) {
      Genome child = parent;
      mutation->mutate(child, layout, rng);
      if (best.empty() || f(child) < f(best)) best = child;
    }
    parent = best;
  }
  EXPECT_LT(f(parent), 1e-6);
  EXPECT_LT(std::exp(parent[10]), 1e-3) << "the step size has followed";
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
