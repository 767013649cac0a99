#include <cmath>
#include <map>
#include <set>

#include "base/genome_sections.hpp"
#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// A layout of two real genes, a group of three genes with four options each, and two real genes of another range.
Layout mixed_layout() {
  Layout layout;
  layout.add_block(2, {-1, 1});
  layout.add_block(3, {0, 0, 4});
  layout.add_block(2, {2, 3});
  return layout;
}

void expect_within(const Genome& genome, const Layout& layout) { EXPECT_EQ(genome_fault(genome, layout), ""); }

std::vector<std::size_t> differences(const Genome& a, const Genome& b) {
  std::vector<std::size_t> positions;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (a[i] != b[i]) positions.push_back(i);
  return positions;
}

// reset-weight -------------------------------------------------------------------------------------------------------

TEST(ResetWeight, ChangesExactlyOneGeneAndEveryGeneAlike) {
  const auto mutation = make<Mutation>("reset-weight");
  const Layout layout = mixed_layout();
  Rng rng = stream(1);
  const Genome parent = random_genome(layout, rng);
  std::vector<int> hits(parent.size(), 0);
  for (int i = 0; i < 7000; ++i) {
    Genome child = parent;
    mutation->mutate(child, layout, rng);
    expect_within(child, layout);
    const auto changed = differences(parent, child);
    ASSERT_EQ(changed.size(), 1u);
    ++hits[changed[0]];
  }
  // the expected count is 1,000; five standard deviations are 150
  for (const int count : hits) EXPECT_NEAR(count, 1000, 150);
}

TEST(ResetWeight, ReachesAllValues) {
  const auto mutation = make<Mutation>("reset-weight");
  const Layout layout = mixed_layout();
  Rng rng = stream(2);
  Genome genome = random_genome(layout, rng);
  std::map<float, int> options;
  double low = 1, high = -1, sum = 0;
  constexpr int rounds = 14000;
  for (int i = 0; i < rounds; ++i) {
    mutation->mutate(genome, layout, rng);
    ++options[genome[3]];
    low = std::min<double>(low, genome[0]);
    high = std::max<double>(high, genome[0]);
    sum += genome[5];
  }
  ASSERT_EQ(options.size(), 4u);
  for (const auto& [option, count] : options) EXPECT_NEAR(count, rounds / 4, rounds / 20) << option;
  EXPECT_LT(low, -0.99);
  EXPECT_GT(high, 0.99);
  EXPECT_NEAR(sum / rounds, 2.5, 0.1);
}

TEST(ResetWeight, ChangesAsManyDifferentGenesAsItIsTold) {
  const Layout layout = mixed_layout();
  Rng rng = stream(3);
  const Genome parent = random_genome(layout, rng);
  for (const auto& [genes, expected] : {std::pair{2, 2u}, {6, 6u}, {7, 7u}, {100, 7u}}) {
    const auto mutation = make<Mutation>("reset-weight", "genes = " + std::to_string(genes));
    for (int i = 0; i < 50; ++i) {
      Genome child = parent;
      mutation->mutate(child, layout, rng);
      EXPECT_EQ(differences(parent, child).size(), expected);
    }
  }
}

TEST(ResetWeight, LeavesNoChoiceAndNoGenesAlone) {
  const auto mutation = make<Mutation>("reset-weight");
  Rng rng = stream(4);
  Layout layout;
  Genome genome;
  mutation->mutate(genome, layout, rng);
  EXPECT_TRUE(genome.empty());
  layout.add_block(1, {0, 0, 1});
  genome = {0};
  mutation->mutate(genome, layout, rng);
  EXPECT_EQ(genome, Genome{0});
}

TEST(ResetWeight, DependsOnItsKeyAlone) {
  const auto mutation = make<Mutation>("reset-weight");
  Layout layout;
  layout.add_block(1000, {-1, 1});
  const auto child = [&](std::uint64_t seed) {
    Rng rng = stream(seed);
    Genome genome(1000, 0);
    mutation->mutate(genome, layout, rng);
    return genome;
  };
  const Genome one = from_eight_threads([&] { return child(1); });
  EXPECT_NE(one, child(2));
}

// block-rates --------------------------------------------------------------------------------------------------------

/// Returns the layout of genomes with the genes that a mutation owns behind others.
Layout with_own_genes(const Mutation& mutation, const Layout& others) {
  Layout whole;
  whole.sections.clear();
  add_section(whole, "others", others);
  whole.own = add_section(whole, "own", mutation.layout(others));
  return whole;
}

/// The layout of 40 voxels with two real genes each, a choice between them, and a rate for each voxel.
Layout voxels_with_rates(const Mutation& mutation) {
  Layout layout;
  for (int i = 0; i < 40; ++i) layout.add_block({{-1, 1}, {0, 0, 3}, {2, 6}}, "voxel");
  return with_own_genes(mutation, layout);
}

TEST(BlockRates, ChangesGenesWithTheRateOfTheirBlock) {
  const auto mutation = make<Mutation>("block-rates", "share = 1.0\nrate_sigma = 0.0\nleast_rate = 0.1\nsigma = 0.01");
  const Layout layout = voxels_with_rates(*mutation);
  Rng rng = stream(1);
  Genome parent = random_genome(layout, rng);
  const std::size_t own = parent.size() - 40;
  for (std::size_t i = 0; i < 40; ++i) parent[own + i] = i < 20 ? 0.25f : 0.75f;
  int slow = 0, fast = 0;
  constexpr int rounds = 500;
  for (int i = 0; i < rounds; ++i) {
    Genome child = parent;
    mutation->mutate(child, layout, rng);
    expect_within(child, layout);
    for (const std::size_t gene : differences(parent, child)) {
      EXPECT_NE(gene % 3, 1u) << "a choice";
      EXPECT_LT(gene, own) << "rates are fixed";
      ++(gene < own / 2 ? slow : fast);
    }
  }
  // of 20 blocks with two real genes each; five standard deviations are below 0.02 of the genes
  EXPECT_NEAR(slow / (40.0 * rounds), 0.25, 0.02);
  EXPECT_NEAR(fast / (40.0 * rounds), 0.75, 0.02);
}

TEST(BlockRates, StepsAreRelativeToTheRangeOfAGene) {
  const auto mutation = make<Mutation>("block-rates", "share = 1.0\nleast_rate = 1.0\nsigma = 0.01");
  const Layout layout = voxels_with_rates(*mutation);
  Rng rng = stream(2);
  Genome parent = random_genome(layout, rng);
  for (std::size_t i = 0; i < 120; ++i)
    if (i % 3 != 1) parent[i] = i % 3 == 0 ? 0.0f : 4.0f;
  double narrow = 0, wide = 0;
  constexpr int rounds = 100;
  for (int i = 0; i < rounds; ++i) {
    Genome child = parent;
    mutation->mutate(child, layout, rng);
    for (std::size_t voxel = 0; voxel < 40; ++voxel) {
      narrow += std::pow(child[3 * voxel] - parent[3 * voxel], 2);
      wide += std::pow(child[3 * voxel + 2] - parent[3 * voxel + 2], 2);
    }
  }
  EXPECT_NEAR(std::sqrt(narrow / (40 * rounds)), 0.01 * 2, 0.0015);
  EXPECT_NEAR(std::sqrt(wide / (40 * rounds)), 0.01 * 4, 0.003);
}

TEST(BlockRates, VariesOnePositionOrMoreOfAllBlocks) {
  const auto mutation = make<Mutation>("block-rates", "share = 0.2\nrate_sigma = 0.0\nleast_rate = 1.0\nsigma = 0.01");
  const Layout layout = voxels_with_rates(*mutation);
  Rng rng = stream(3);
  const Genome parent = random_genome(layout, rng);
  std::map<std::set<std::size_t>, int> seen;
  constexpr int rounds = 3000;
  for (int i = 0; i < rounds; ++i) {
    Genome child = parent;
    mutation->mutate(child, layout, rng);
    std::set<std::size_t> positions;
    for (const std::size_t gene : differences(parent, child)) positions.insert(gene % 3);
    ++seen[positions];
  }
  // of two positions, one alone with 0.16 each and both with 0.04; never none, so that these add up to 1
  ASSERT_EQ(seen.size(), 3u);
  EXPECT_NEAR((seen[{0, 2}]) / double(rounds), 0.04 / 0.36, 0.03);
  EXPECT_NEAR((seen[{0}]) / double(rounds), 0.16 / 0.36, 0.05);
  EXPECT_NEAR((seen[{2}]) / double(rounds), 0.16 / 0.36, 0.05);
}

/// Counts would not tell a share from one that is 1 % larger, but the numbers that are drawn do.
TEST(BlockRates, DrawsAPositionIfTheNumberIsBelowTheShare) {
  int tried = 0;
  for (std::uint32_t seed = 1; seed <= 100; ++seed) {
    Rng numbers = stream(seed);
    numbers.normal();  // for the only rate
    const double first = numbers.uniform(), second = numbers.uniform();
    if (first < 0.01 || second > 0.99 * first) continue;  // so that the second position is always drawn at once
    ++tried;
    for (const double part : {0.995, 1.005}) {
      const auto mutation = make<Mutation>(
          "block-rates", "rate_sigma = 0.0\nleast_rate = 1.0\nsigma = 0.01\nshare = " + std::to_string(part * first));
      Layout voxel;
      voxel.add_block({{-1, 1}, {2, 6}}, "voxel");
      const Layout layout = with_own_genes(*mutation, voxel);
      const Genome parent{0, 4, 1};
      Genome child = parent;
      Rng rng = stream(seed);
      mutation->mutate(child, layout, rng);
      EXPECT_EQ(child[0] != parent[0], part > 1) << seed;
      EXPECT_NE(child[1], parent[1]) << seed;
    }
  }
  EXPECT_GT(tried, 20);
}

TEST(BlockRates, RatesWalkAtRandomAboveTheLeast) {
  const auto mutation = make<Mutation>("block-rates", "rate_sigma = 0.1\nleast_rate = 0.05");
  Layout own = mutation->layout(mixed_layout());
  ASSERT_EQ(own.first_size(), 3u) << "one for each block";
  EXPECT_EQ(own.gene({}, 0).low, 0.05f);
  EXPECT_EQ(own.gene({}, 0).high, 1.0f);
  Rng rng = stream(4);
  int at_least = 0;
  double squares = 0;
  constexpr int rounds = 2000;
  for (int i = 0; i < rounds; ++i)
    for (const float rate : mutation->random(own, rng)) {
      ASSERT_GE(rate, 0.05f);
      at_least += rate == 0.05f;
      squares += std::pow(rate - 0.05, 2);
    }
  // half of the first steps go down, and so nowhere; the others have half of the variance
  EXPECT_NEAR(at_least / (3.0 * rounds), 0.5, 0.035);
  EXPECT_NEAR(squares / (3.0 * rounds), 0.1 * 0.1 / 2, 0.0006);
}

TEST(BlockRates, BlocksThatCameLaterHaveTheLeastRate) {
  const auto mutation = make<Mutation>("block-rates", "share = 1.0\nrate_sigma = 0.0\nleast_rate = 0.01");
  Layout others;
  const std::uint32_t type = others.add_type({"node", {{-1, 1}}, 1, 100});
  others.add_block_of(type);
  const Layout layout = with_own_genes(*mutation, others);
  Rng rng = stream(5);
  Genome parent = random_genome(layout, rng);
  parent[1] = 1;  // the rate of the first block
  for (int i = 0; i < 50; ++i) add_block(parent, layout, type, std::vector<float>{0.5f}, fresh_id(rng));
  int first = 0, later = 0;
  for (int i = 0; i < 200; ++i) {
    Genome child = parent;
    mutation->mutate(child, layout, rng);
    expect_within(child, layout);
    for (const std::size_t gene : differences(parent, child)) ++(gene == 0 ? first : later);
  }
  EXPECT_EQ(first, 200);
  EXPECT_NEAR(later / (50.0 * 200), 0.01, 0.005);
}

// crossovers ---------------------------------------------------------------------------------------------------------

class AnyCrossover : public ::testing::TestWithParam<const char*> {};

TEST_P(AnyCrossover, TwinsHaveTwins) {
  const auto crossover = make<Crossover>(GetParam());
  const Layout layout = mixed_layout();
  Rng rng = stream(1);
  const Genome parent = random_genome(layout, rng);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(crossover->cross({parent, parent}, layout, rng), parent);
  }
}

TEST_P(AnyCrossover, TakesGenesOfTheSecondParentPositionByPosition) {
  const auto crossover = make<Crossover>(GetParam());
  const Layout layout = mixed_layout();
  Rng rng = stream(2);
  const Genome mother{0, 0, 0, 0, 0, 2, 2}, father{1, 1, 1, 1, 1, 3, 3};
  std::vector<int> taken(mother.size(), 0);
  for (int i = 0; i < 300; ++i) {
    const Genome child = crossover->cross({mother, father}, layout, rng);
    EXPECT_FALSE(differences(mother, child).empty());
    for (std::size_t g = 0; g < mother.size(); ++g) {
      EXPECT_TRUE(child[g] == mother[g] || child[g] == father[g]);
      taken[g] += child[g] == father[g];
    }
  }
  for (const int count : taken) {
    EXPECT_GT(count, 50);
    EXPECT_LT(count, 250);
  }
}

TEST_P(AnyCrossover, NothingComesOfNothing) {
  const Genome nothing;
  Rng rng = stream(3);
  EXPECT_TRUE(make<Crossover>(GetParam())->cross({nothing, nothing}, {}, rng).empty());
}

TEST_P(AnyCrossover, DependsOnItsKeyAlone) {
  const auto crossover = make<Crossover>(GetParam());
  Layout layout;
  for (int i = 0; i < 100; ++i) layout.add_block(10, {-1, 1});
  const auto child = [&](std::uint64_t seed) {
    Rng rng = stream(seed);
    const Genome mother(1000, 0), father(1000, 1);
    return crossover->cross({mother, father}, layout, rng);
  };
  const Genome one = from_eight_threads([&] { return child(1); });
  EXPECT_NE(one, child(2));
}

INSTANTIATE_TEST_SUITE_P(Crossovers, AnyCrossover, ::testing::Values("swap-neuron", "two-point"));

/// Returns how often each set of genes was exchanged.
std::map<std::vector<std::size_t>, int> exchanges(const Crossover& crossover, const Layout& layout, int rounds) {
  std::map<std::vector<std::size_t>, int> seen;
  Rng rng = stream(4);
  const Genome mother(layout.first_size(), 0), father(layout.first_size(), 1);
  for (int i = 0; i < rounds; ++i) {
    ++seen[differences(mother, crossover.cross({mother, father}, layout, rng))];
  }
  return seen;
}

TEST(SwapNeuron, SwapsOneWholeGroup) {
  const auto seen = exchanges(*make<Crossover>("swap-neuron"), mixed_layout(), 3000);
  ASSERT_EQ(seen.size(), 3u);
  for (const auto& group : {std::vector<std::size_t>{0, 1}, {2, 3, 4}, {5, 6}}) {
    ASSERT_TRUE(seen.contains(group));
    EXPECT_NEAR(seen.at(group), 1000, 130);
  }
}

TEST(TwoPoint, SwapsEverySegmentAlikeOften) {
  Layout layout;
  layout.add_block(4, {0, 1});
  const auto seen = exchanges(*make<Crossover>("two-point"), layout, 10000);
  ASSERT_EQ(seen.size(), 10u);  // pairs of the five positions at which genomes can be cut
  for (const auto& [genes, count] : seen) {
    EXPECT_EQ(genes.back() - genes.front() + 1, genes.size()) << "not one segment";
    EXPECT_NEAR(count, 1000, 150);
  }
}

TEST(TwoPoint, WorksOnOneGene) {
  Layout layout;
  layout.add_block(1, {0, 1});
  const auto seen = exchanges(*make<Crossover>("two-point"), layout, 20);
  EXPECT_THAT(seen, ::testing::ElementsAre(std::pair(std::vector<std::size_t>{0}, 20)));
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
