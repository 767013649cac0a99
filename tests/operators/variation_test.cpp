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

std::vector<std::size_t> differences(const Genome& a, const Genome& b) {
  std::vector<std::size_t> positions;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (a[i] != b[i]) positions.push_back(i);
  return positions;
}

Genome mutant(Genome genome, const Mutation& mutation, const Layout& layout, Rng& rng) {
  mutation.mutate(genome, {layout}, rng);
  return genome;
}

// reset-weight -------------------------------------------------------------------------------------------------------

TEST(ResetWeight, ChangesExactlyOneGeneAndEveryGeneAlike) {
  const auto mutation = make<Mutation>("reset-weight");
  const Layout layout = mixed_layout();
  Rng rng = stream(1);
  const Genome parent = random_genome(layout, rng);
  std::vector<int> hits(parent.size(), 0);
  for (int i = 0; i < 7000; ++i) {
    const auto changed = differences(parent, mutant(parent, *mutation, layout, rng));
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
    mutation->mutate(genome, {layout}, rng);
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

TEST(ResetWeight, ChangesAsManyDifferentGenesAsItIsToldIfTheyHaveOtherOptions) {
  const Layout layout = mixed_layout();
  Rng rng = stream(3);
  const Genome parent = random_genome(layout, rng);
  for (const auto& [genes, expected] : {std::pair{2, 2u}, {6, 6u}, {7, 7u}, {100, 7u}}) {
    const auto mutation = make<Mutation>("reset-weight", "genes = " + std::to_string(genes));
    for (int i = 0; i < 50; ++i)
      EXPECT_EQ(differences(parent, mutant(parent, *mutation, layout, rng)).size(), expected);
  }
  Layout no_choice;
  no_choice.add_block(1, {0, 0, 1});
  EXPECT_EQ(mutant({0}, *make<Mutation>("reset-weight"), no_choice, rng), Genome{0});
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

/// Genomes of 40 voxels with two real genes each, a choice between them, and a rate for each voxel.
struct Voxels {
  Voxels(const std::string& toml, std::uint64_t seed) : mutation(make<Mutation>("block-rates", toml)) {
    Layout voxels;
    for (int i = 0; i < 40; ++i) voxels.add_block({{-1, 1}, {0, 0, 3}, {2, 6}}, "voxel");
    layout = with_own_genes(*mutation, voxels);
    rng = stream(seed);
    parent = random_genome(layout, rng);
  }
  Genome child() { return mutant(parent, *mutation, layout, rng); }

  std::unique_ptr<Mutation> mutation;
  Layout layout;
  Rng rng = stream(0);
  Genome parent;
};

TEST(BlockRates, ChangesGenesWithTheRateOfTheirBlock) {
  Voxels voxels("share = 1.0\nrate_sigma = 0.0\nleast_rate = 0.1\nsigma = 0.01", 1);
  const std::size_t own = voxels.parent.size() - 40;
  for (std::size_t i = 0; i < 40; ++i) voxels.parent[own + i] = i < 20 ? 0.25f : 0.75f;
  int slow = 0, fast = 0;
  constexpr int rounds = 500;
  for (int i = 0; i < rounds; ++i)
    for (const std::size_t gene : differences(voxels.parent, voxels.child())) {
      EXPECT_NE(gene % 3, 1u) << "a choice";
      EXPECT_LT(gene, own) << "rates are fixed";
      ++(gene < own / 2 ? slow : fast);
    }
  // of 20 blocks with two real genes each; five standard deviations are below 0.02 of the genes
  EXPECT_NEAR(slow / (40.0 * rounds), 0.25, 0.02);
  EXPECT_NEAR(fast / (40.0 * rounds), 0.75, 0.02);
}

TEST(BlockRates, StepsAreRelativeToTheRangeOfAGene) {
  Voxels voxels("share = 1.0\nleast_rate = 1.0\nsigma = 0.01", 2);
  for (std::size_t i = 0; i < 120; ++i)
    if (i % 3 != 1) voxels.parent[i] = i % 3 == 0 ? 0.0f : 4.0f;
  double narrow = 0, wide = 0;
  constexpr int rounds = 100;
  for (int i = 0; i < rounds; ++i) {
    const Genome child = voxels.child();
    for (std::size_t gene = 0; gene < 120; gene += 3) {
      narrow += std::pow(child[gene] - voxels.parent[gene], 2);
      wide += std::pow(child[gene + 2] - voxels.parent[gene + 2], 2);
    }
  }
  EXPECT_NEAR(std::sqrt(narrow / (40 * rounds)), 0.01 * 2, 0.0015);
  EXPECT_NEAR(std::sqrt(wide / (40 * rounds)), 0.01 * 4, 0.003);
}

TEST(BlockRates, VariesOnePositionOrMoreOfAllBlocks) {
  Voxels voxels("share = 0.2\nrate_sigma = 0.0\nleast_rate = 1.0\nsigma = 0.01", 3);
  std::map<std::set<std::size_t>, int> seen;
  constexpr int rounds = 3000;
  for (int i = 0; i < rounds; ++i) {
    std::set<std::size_t> positions;
    for (const std::size_t gene : differences(voxels.parent, voxels.child())) positions.insert(gene % 3);
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
      const Genome parent{0, 4, 1};
      Rng rng = stream(seed);
      const Genome child = mutant(parent, *mutation, with_own_genes(*mutation, voxel), rng);
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
  for (int i = 0; i < 200; ++i)
    for (const std::size_t gene : differences(parent, mutant(parent, *mutation, layout, rng)))
      ++(gene == 0 ? first : later);
  EXPECT_EQ(first, 200);
  EXPECT_NEAR(later / (50.0 * 200), 0.01, 0.005);
}

// gaussian -----------------------------------------------------------------------------------------------------------

/// Mutates genomes of 1,000 zeros in [-1, 1], a choice, and the logarithm of a step size.
std::vector<Genome> mutated_zeros(const std::string& toml, float log_sigma, int rounds, std::uint64_t seed) {
  const auto mutation = make<Mutation>("gaussian", toml);
  Layout others;
  others.add_block(1000, {-1, 1});
  others.add_block(1, {0, 0, 3});
  const Layout layout = with_own_genes(*mutation, others);
  Rng rng = stream(seed);
  Genome parent(1002, 0);
  parent[1001] = log_sigma;
  std::vector<Genome> mutants;
  for (int i = 0; i < rounds; ++i) mutants.push_back(mutant(parent, *mutation, layout, rng));
  return mutants;
}

TEST(Gaussian, StepsAreNormalWithTheSizeThatIsInherited) {
  double sum = 0, squares = 0, beyond = 0;
  const std::string fixed = "sigma = 0.2\nlearning_rate = 0.0\nshare = 1.0";
  for (const Genome& genome : mutated_zeros(fixed, std::log(0.05f), 20, 2)) {
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
  int changed = 0;
  for (const Genome& genome : mutated_zeros("share = 0.25", std::log(0.1f), 20, 5))
    for (std::size_t gene = 0; gene < 1000; ++gene) changed += genome[gene] != 0;
  EXPECT_NEAR(changed, 5000, 310);
}

TEST(Gaussian, StepSizesBeginAsToldAndVary) {
  Rng any = stream(1);
  EXPECT_FLOAT_EQ(make<Mutation>("gaussian", "sigma = 0.05")->random({}, any)[0], std::log(0.05f));
  double sum = 0, squares = 0;
  for (const Genome& genome : mutated_zeros("learning_rate = 0.3", std::log(0.05f), 2000, 3)) {
    const double step = genome[1001] - std::log(0.05);
    sum += step;
    squares += step * step;
  }
  EXPECT_NEAR(sum / 2000, 0, 0.03);
  EXPECT_NEAR(std::sqrt(squares / 2000), 0.3, 0.02);
}

// crossovers ---------------------------------------------------------------------------------------------------------

TEST(Crossovers, NothingComesOfNothing) {
  const Genome nothing;
  Rng rng = stream(3);
  for (const char* name : {"swap-neuron", "two-point"})
    EXPECT_TRUE(make<Crossover>(name)->cross({nothing, nothing}, {Layout{}}, rng).empty()) << name;
}

/// Returns how often each set of genes was taken from the second parent.
std::map<std::vector<std::size_t>, int> exchanges(const char* name, const Layout& layout, int rounds) {
  const auto crossover = make<Crossover>(name);
  std::map<std::vector<std::size_t>, int> seen;
  Rng rng = stream(4);
  const Genome mother(layout.first_size(), 0), father(layout.first_size(), 1);
  for (int i = 0; i < rounds; ++i) {
    const Genome child = crossover->cross({mother, father}, {layout}, rng);
    for (const float gene : child) EXPECT_TRUE(gene == 0 || gene == 1) << gene;
    ++seen[differences(mother, child)];
  }
  return seen;
}

TEST(SwapNeuron, SwapsOneWholeGroup) {
  const auto seen = exchanges("swap-neuron", mixed_layout(), 3000);
  ASSERT_EQ(seen.size(), 3u);
  for (const auto& group : {std::vector<std::size_t>{0, 1}, {2, 3, 4}, {5, 6}}) {
    ASSERT_TRUE(seen.contains(group));
    EXPECT_NEAR(seen.at(group), 1000, 130);
  }
}

TEST(TwoPoint, SwapsEverySegmentAlikeOften) {
  Layout four, one;
  four.add_block(4, {0, 1});
  one.add_block(1, {0, 1});
  const auto seen = exchanges("two-point", four, 10000);
  ASSERT_EQ(seen.size(), 10u);  // pairs of the five positions at which genomes can be cut
  for (const auto& [genes, count] : seen) {
    EXPECT_EQ(genes.back() - genes.front() + 1, genes.size()) << "not one segment";
    EXPECT_NEAR(count, 1000, 150);
  }
  EXPECT_THAT(exchanges("two-point", one, 20), ::testing::ElementsAre(std::pair(std::vector<std::size_t>{0}, 20)));
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
    const Genome child = crossover->cross({first, second}, {layout}, rng);
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

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
