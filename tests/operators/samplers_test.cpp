// Selections that make the children themselves: cma-es and differential.
#include <set>

#include "evolution.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// Real genes with different ranges, one of which is a point.
Layout uneven_genes() {
  Layout layout;
  layout.add_block(4, {-5, 5});
  layout.add_block({{.low = 0, .high = 100}, {.low = 3, .high = 3}});
  return layout;
}

/// 0 at (1, 1, 1, 1, 40), below elsewhere, and steeper along the later genes.
void evaluate_bowl(Individual& one) {
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i) sum += std::pow(10.0, static_cast<double>(i)) * std::pow(one.genome[i] - 1, 2);
  one.scores = {-sum - std::pow(one.genome[4] - 40, 2)};
}

void expect_within(const Layout& layout, const Genome& genome) {
  ASSERT_EQ(genome.size(), layout.first_size());
  for (std::size_t gene = 0; gene < genome.size(); ++gene) {
    const GeneSpec& spec = layout.gene(genome, gene);
    EXPECT_TRUE(genome[gene] >= spec.low && genome[gene] <= spec.high) << genome[gene];
  }
}

class Sampler : public ::testing::TestWithParam<const char*> {
 protected:
  std::unique_ptr<Selection> selection = make<Selection>(GetParam());
};

TEST_P(Sampler, MakesTheFirstGeneration) {
  EXPECT_TRUE(selection->overrides.children);
  EXPECT_TRUE(selection->traits().needs_real_genes);
  const Table table{.layout = uneven_genes()};
  const auto children = table.children(*selection, 50);
  ASSERT_EQ(children.size(), 50u);
  std::set<std::vector<float>> different;
  for (const Child& child : children) {
    expect_within(table.layout, child.genome);
    EXPECT_TRUE(child.parents.empty());
    different.insert(child.genome.genes);
  }
  EXPECT_EQ(different.size(), 50u);
  EXPECT_NE(table.children(*selection, 50, 2)[0].genome, children[0].genome);
}

TEST_P(Sampler, FindsTheOptimumWithinTheBounds) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Evolution evolution(
        *selection, uneven_genes(),
        [&](Individual& one) {
          expect_within(uneven_genes(), one.genome);
          evaluate_bowl(one);
        },
        seed);
    evolution.run(300, 20, 20);
    EXPECT_GT(evolution.best(), -1e-6) << seed;
  }
}

TEST_P(Sampler, PrefersTheLessInfeasibleUntilSomeoneIsFeasible) {
  // feasible only where the first gene is above 4.9
  Evolution evolution(
      *selection, uneven_genes(),
      [](Individual& one) {
        one.violation = std::max(0.0, 4.9 - one.genome[0]);
        if (one.violation == 0) evaluate_bowl(one);
      },
      1);
  evolution.run(300, 20, 20);
  EXPECT_NEAR(evolution.best(), -3.9 * 3.9, 0.5);
}

INSTANTIATE_TEST_SUITE_P(Samplers, Sampler, ::testing::Values("cma-es", "differential"));

TEST(CmaEsSelection, LearnsFromNewbornsAlone) {
  const auto selection = make<Selection>("cma-es");
  EXPECT_EQ(selection->traits().least_children, 2u);
  Table table{.layout = uneven_genes()};
  for (const Child& child : table.children(*selection, 12)) {
    table.rows.push_back({.genome = child.genome, .is_newborn = true});
    evaluate_bowl(table.rows.back());
  }
  const auto memory = table.survivors(*selection, 5).memory;
  ASSERT_TRUE(memory);
  EXPECT_EQ(memory->list("distribution").size(), 6u * 7) << "one of the six genes has only one value";
  table.rows.push_back({.scores = {1e9}, .genome = table.rows[0].genome});
  const Survival survival = table.survivors(*selection, 5);
  EXPECT_EQ(survival.memory, memory);
  EXPECT_EQ(survival.rows.front(), 12u) << "the best so far lives on";
  table.rows.back().is_newborn = true;
  EXPECT_NE(table.survivors(*selection, 5).memory, memory);
}

TEST(CmaEsSelection, TheFirstStepIsAShareOfTheRange) {
  const auto selection = make<Selection>("cma-es", "step = 0.02");
  Table table;
  table.layout.add_block(1, {-5, 5});
  table.layout.add_block(1, {0, 100});
  double squares[2] = {};
  for (const Child& child : table.children(*selection, 400)) {
    squares[0] += std::pow(child.genome[0], 2);
    squares[1] += std::pow(child.genome[1] - 50, 2);
  }
  EXPECT_NEAR(std::sqrt(squares[0] / 400), 0.2, 0.03);
  EXPECT_NEAR(std::sqrt(squares[1] / 400), 2, 0.3);
}

TEST(CmaEsSelection, GenesWithOneValueChangeNothing) {
  const auto selection = make<Selection>("cma-es");
  const auto free_genes = [&](bool with_fixed) {
    Layout layout = real_genes(4, -5, 5);
    if (with_fixed) layout.add_block(9, {3, 3});
    Evolution evolution(
        *selection, layout, [](Individual& one) { one.scores = {-std::abs(one.genome[0]) - std::abs(one.genome[3])}; },
        1);
    evolution.run(20, 10, 10);
    std::vector<std::vector<float>> genes;
    for (const Individual& one : evolution.table.rows) {
      genes.emplace_back(one.genome.begin(), one.genome.begin() + 4);
      for (std::size_t i = 4; i < one.genome.size(); ++i) EXPECT_EQ(one.genome[i], 3);
    }
    return genes;
  };
  EXPECT_EQ(free_genes(true), free_genes(false));
}

TEST(CmaEsSelection, RefusesOtherGenomesAndAMemoryThatIsNotItsOwn) {
  const auto selection = make<Selection>("cma-es");
  for (const auto& [layout, genes] : {std::pair(real_genes(4, 3, 3), " 0 genes"), {real_genes(1001, 0, 1), " 1001 "}})
    EXPECT_THAT(
        [&] { Table{.layout = layout}.children(*selection, 1); },
        ::testing::ThrowsMessage<std::runtime_error>(testing::naming(genes, "1000", "encoding", "differential")));
  Evolution evolution(*selection, uneven_genes(), evaluate_bowl, 1);
  evolution.run(2, 10, 10);
  const auto refusal_of = [&](const SelectionMemory& memory) {
    evolution.table.memory = memory;
    return testing::refusal<std::runtime_error>([&] { evolution.table.children(*selection, 5); });
  };
  const SelectionMemory own = evolution.table.memory;
  SelectionMemory longer = own, newer = own;
  longer.lists["distribution"].push_back(0);
  newer.version = 2;
  EXPECT_THAT(refusal_of(longer), testing::naming("43 numbers", "42", "5 genes"));
  EXPECT_THAT(refusal_of(newer), testing::naming("version 2", "expected 1"));
  EXPECT_THAT(refusal_of({.lists = {{"mean", {1}}}}), testing::naming("\"distribution\""));
}

TEST(Differential, DrawsGenomesWhileTooFewAreAlive) {
  const auto selection = make<Selection>("differential");
  EXPECT_EQ(selection->traits().least_population, 4u);
  Evolution evolution(*selection, uneven_genes(), evaluate_bowl, 1);
  evolution.step(20, 3);
  for (const Child& child : evolution.table.children(*selection, 10)) {
    expect_within(uneven_genes(), child.genome);
    EXPECT_TRUE(child.parents.empty());
  }
  evolution.step(20, 3);
  for (const Child& child : evolution.table.children(*selection, 10)) EXPECT_EQ(child.parents.size(), 1u);
}

TEST(Differential, WhatWouldLeaveTheBoundsLiesBetweenThemAndWhereItStarted) {
  const auto selection = make<Selection>("differential", "factor = 2\ncrossover = 1");
  for (const bool is_high : {true, false}) {
    Table table{.layout = real_genes(1, 0, 1)};
    for (const float gene : {0.8f, 0.9f, 0.95f, 0.99f}) table.rows.push_back({.genome = {is_high ? gene : 1 - gene}});
    int returned = 0;
    for (const Child& child : table.children(*selection, 400)) {
      const double gene = child.genome[0];
      bool is_sum = false, is_between = false;
      for (std::uint32_t a = 0; a < 4; ++a)
        for (std::uint32_t b = 0; b < 4; ++b)
          for (std::uint32_t c = 0; c < 4; ++c) {
            if (std::set{a, b, c, child.parents.at(0)}.size() < 4) continue;
            const double start = table.rows[a].genome[0];
            const double sum = start + 2 * (double{table.rows[b].genome[0]} - table.rows[c].genome[0]);
            is_sum |= gene == static_cast<float>(sum);
            is_between |= (sum > 1 && gene >= start && gene < 1) || (sum < 0 && gene > 0 && gene <= start);
          }
      EXPECT_TRUE(is_sum || is_between) << gene;
      returned += !is_sum;
    }
    EXPECT_GT(returned, 100);
  }
}

/// Every gene of a child is that of its parent, or the sum that Storn and Price define, of three others.
TEST(Differential, ChildrenAreSumsOfOthers) {
  const auto selection = make<Selection>("differential", "factor = 0.5\ncrossover = 0.4");
  Table table{.layout = real_genes(8, -100, 100)};
  Rng rng = stream(1);
  for (std::uint32_t i = 0; i < 7; ++i) {
    table.rows.push_back({.scores = {1.0 * i}, .genome = Genome(8), .id = i});
    for (float& gene : table.rows.back().genome) gene = static_cast<float>(rng.uniform(-10, 10));
  }
  int changed = 0;
  std::map<std::uint32_t, int> turns;
  for (const Child& child : table.children(*selection, 70)) {
    ASSERT_EQ(child.parents.size(), 1u);
    const std::uint32_t parent = child.parents[0];
    ++turns[parent];
    const Genome& own = table.rows[parent].genome;
    std::vector<std::size_t> others;
    for (std::size_t gene = 0; gene < 8; ++gene)
      if (child.genome[gene] != own[gene]) others.push_back(gene);
    EXPECT_GE(others.size(), 1u);
    changed += static_cast<int>(others.size());
    int explained = 0;
    for (std::uint32_t a = 0; a < 7; ++a)
      for (std::uint32_t b = 0; b < 7; ++b)
        for (std::uint32_t c = 0; c < 7; ++c) {
          if (std::set{a, b, c, parent}.size() < 4) continue;
          explained += std::all_of(others.begin(), others.end(), [&](std::size_t gene) {
            const double sum =
                table.rows[a].genome[gene] + 0.5 * (double{table.rows[b].genome[gene]} - table.rows[c].genome[gene]);
            return child.genome[gene] == static_cast<float>(sum);
          });
        }
    EXPECT_GE(explained, 1);
  }
  for (std::uint32_t row = 0; row < 7; ++row) EXPECT_EQ(turns[row], 10) << "each is a parent equally often";
  // one gene for certain, and 0.4 of the other seven
  EXPECT_NEAR(changed / 70.0, 1 + 0.4 * 7, 0.5);
}

TEST(Differential, TheBestChildTakesItsParentsPlaceUnlessItIsWorse) {
  const auto selection = make<Selection>("differential");
  const auto expect_living = [&](const char* rule, const Table& table, std::uint32_t population,
                                 const std::vector<std::uint32_t>& living) {
    EXPECT_THAT(table.survivors(*selection, population).rows, ::testing::UnorderedElementsAreArray(living)) << rule;
  };
  expect_living("children that are better, worse and equal, and one that failed",
                {.rows = {{.scores = {5}},
                          {.scores = {6}},
                          {.scores = {1}},
                          {.scores = {0}},
                          {.scores = {9}, .challenges = 0},
                          {.scores = {5.5}, .challenges = 1},
                          {.scores = {1}, .challenges = 2},
                          {.challenges = 3}}},
                4, {4, 1, 6, 3});
  expect_living("of several children, the best competes",
                {.rows = {{.scores = {5}},
                          {.scores = {1}},
                          {.scores = {9}, .challenges = 0},
                          {.scores = {8}, .challenges = 0},
                          {.scores = {0}, .challenges = 1}}},
                2, {2, 1});
  expect_living("those who failed compete by their violations",
                {.rows = {{.violation = 1},
                          {.violation = 3},
                          {.violation = 2, .challenges = 0},
                          {.violation = 4, .challenges = 1}}},
                2, {0, 1});
  expect_living("losers take the places of those who failed",
                {.rows = {{.scores = {5}}, {}, {.scores = {3}, .challenges = 0}, {.violation = 1, .challenges = 1}}}, 2,
                {0, 2});
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
