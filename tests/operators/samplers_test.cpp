// Selections that make the children themselves: cma-es and differential.
#include <set>

#include "evodevo/helpers/selection/memory.hpp"
#include "evolution.hpp"

namespace evodevo::test {
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

class Sampler : public testing::TestWithParam<const char*> {
 protected:
  std::unique_ptr<Selection> selection = make<Selection>(GetParam());
};

TEST_P(Sampler, MakesTheFirstGeneration) {
  EXPECT_TRUE(selection->traits().makes_children);
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

TEST_P(Sampler, FindsOptimaOnTheBounds) {
  Evolution evolution(
      *selection, real_genes(6, -1, 3),
      [](Individual& one) {
        one.scores = {0};
        for (const float gene : one.genome) one.scores[0] -= gene;
      },
      1);
  evolution.run(300, 20, 20);
  EXPECT_NEAR(evolution.best(), 6, 1e-4);
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

INSTANTIATE_TEST_SUITE_P(Samplers, Sampler, testing::Values("cma-es", "differential"));

TEST(CmaEsSelection, LearnsFromNewbornsAlone) {
  const auto selection = make<Selection>("cma-es");
  Table table{.layout = uneven_genes()};
  for (const Child& child : table.children(*selection, 12)) {
    Individual newborn{.genome = child.genome, .id = static_cast<std::uint32_t>(table.rows.size()), .is_newborn = true};
    evaluate_bowl(newborn);
    table.rows.push_back(newborn);
  }
  const auto memory = table.survive(*selection, 5).memory;
  EXPECT_EQ(MemoryReader(memory).read_list<double>().size(), 7u * 8);
  Individual old{.scores = {1e9}, .genome = table.rows[0].genome, .id = 100};
  table.rows.push_back(old);
  const Survival survival = table.survive(*selection, 5);
  EXPECT_EQ(survival.memory, memory);
  EXPECT_EQ(survival.rows.front(), 12u) << "the best so far lives on";
  table.rows.back().is_newborn = true;
  EXPECT_NE(table.survive(*selection, 5).memory, memory);
}

TEST(CmaEsSelection, ASmallGenerationOrNoneTeachesLittle) {
  const auto selection = make<Selection>("cma-es");
  Table table{.rows = {{.scores = {1}, .genome = Genome(6, 3), .id = 1, .is_newborn = true}}, .layout = uneven_genes()};
  const auto before = table.survive(*selection, 5).memory;
  table.memory = before;
  EXPECT_EQ(table.survive(*selection, 5).memory, before);
}

TEST(CmaEsSelection, RefusesGenomesThatAreTooLong) {
  const auto selection = make<Selection>("cma-es");
  const Table table{.layout = real_genes(1001, 0, 1)};
  try {
    table.children(*selection, 1);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("1001"));
    EXPECT_THAT(error.what(), testing::HasSubstr("1000"));
    EXPECT_THAT(error.what(), testing::HasSubstr("differential"));
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

TEST(Differential, ChildrenDoNotDependOnTheOrderOfThoseWhoFailed) {
  const auto selection = make<Selection>("differential");
  Table table{.layout = real_genes(2, 0, 1)};
  for (const float gene : {0.1f, 0.7f, 0.3f, 0.9f, 0.5f}) table.rows.push_back({.genome = {gene, 1 - gene}});
  const auto made = [&] {
    std::vector<std::vector<float>> genes;
    for (const Child& child : table.children(*selection, 10)) genes.push_back(child.genome.genes);
    return genes;
  };
  const auto straight = made();
  std::reverse(table.rows.begin(), table.rows.end());
  EXPECT_EQ(made(), straight);
}

TEST(Differential, AChildTakesItsParentsPlaceUnlessItIsWorse) {
  const auto selection = make<Selection>("differential");
  const Table table{.rows = {{.scores = {5}},
                             {.scores = {6}},
                             {.scores = {1}},
                             {.scores = {0}},
                             {.scores = {9}, .challenges = 0},
                             {.scores = {5.5}, .challenges = 1},
                             {.scores = {1}, .challenges = 2},
                             {.challenges = 3}}};
  EXPECT_THAT(table.survive(*selection, 4).rows, testing::UnorderedElementsAre(4, 1, 6, 3));
}

TEST(Differential, OfSeveralChildrenTheBestCompetes) {
  const auto selection = make<Selection>("differential");
  const Table table{.rows = {{.scores = {5}},
                             {.scores = {1}},
                             {.scores = {9}, .challenges = 0},
                             {.scores = {8}, .challenges = 0},
                             {.scores = {0}, .challenges = 1}}};
  EXPECT_THAT(table.survive(*selection, 2).rows, testing::UnorderedElementsAre(2, 1));
}

TEST(Differential, LosersTakeThePlacesOfThoseWhoFailed) {
  const auto selection = make<Selection>("differential");
  const Table table{.rows = {{.scores = {5}}, {}, {.scores = {3}, .challenges = 0}, {.violation = 1, .challenges = 1}}};
  EXPECT_THAT(table.survive(*selection, 2).rows, testing::UnorderedElementsAre(0, 2));
}

}  // namespace
}  // namespace evodevo::test
