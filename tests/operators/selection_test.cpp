#include <map>
#include <set>

#include "evodevo/helpers/pareto.hpp"
#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// A candidate for selection, with its own copy of the scores.
struct Row {
  std::vector<double> scores;  ///< empty if the individual has failed
  std::uint32_t age = 0;
  std::optional<std::uint32_t> parent = {};

  friend auto operator<=>(const Row& a, const Row& b) {
    return std::tie(a.scores, a.age) <=> std::tie(b.scores, b.age);
  }
  friend bool operator==(const Row& a, const Row& b) { return (a <=> b) == 0; }
};

std::vector<Candidate> candidates(const std::vector<Row>& rows) {
  std::vector<Candidate> table;
  for (const Row& row : rows) table.push_back({row.scores, row.age, row.parent});
  return table;
}

std::vector<std::uint32_t> survivors(const Selection& selection, const std::vector<Row>& rows, std::uint32_t population,
                                     std::uint64_t seed = 1) {
  Rng rng = stream(seed);
  return selection.survivors(candidates(rows), population, rng);
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> parents(const Selection& selection, const std::vector<Row>& rows,
                                                             std::uint32_t count, std::uint64_t seed = 1) {
  Rng rng = stream(seed);
  return selection.parents(candidates(rows), count, rng);
}

/// Returns `old` random rows and up to `children` children of them. Scores have few different values, so that there are
/// ties, and some rows have failed.
std::vector<Row> random_rows(std::uint64_t seed, std::uint32_t old = 20, std::uint32_t children = 15,
                             std::size_t objectives = 2, double failing = 0.25) {
  Rng rng = stream(seed);
  std::vector<Row> rows;
  for (std::uint32_t i = 0; i < old + children; ++i) {
    Row row;
    row.age = rng.below(6);
    if (!rng.chance(failing))
      for (std::size_t o = 0; o < objectives; ++o) row.scores.push_back(rng.below(10));
    if (i >= old && rng.chance(0.9)) row.parent = rng.below(old);
    rows.push_back(row);
  }
  return rows;
}

/// Returns random rows with distinct scores, so that there are no ties.
std::vector<Row> rows_without_ties(std::uint64_t seed) {
  auto rows = random_rows(seed);
  Rng rng = stream(seed + 1000);
  for (Row& row : rows)
    for (double& score : row.scores) score += rng.uniform();
  std::uint32_t age = 0;
  for (Row& row : rows)
    if (row.scores.empty()) row.age = ++age;
  return rows;
}

/// Returns the same rows in another order.
std::vector<Row> permuted(const std::vector<Row>& rows, std::uint64_t seed) {
  std::vector<std::uint32_t> order(rows.size()), position(rows.size());
  for (std::uint32_t i = 0; i < rows.size(); ++i) order[i] = i;
  Rng rng = stream(seed);
  rng.shuffle(order);
  for (std::uint32_t i = 0; i < rows.size(); ++i) position[order[i]] = i;
  std::vector<Row> result;
  for (const std::uint32_t i : order) {
    result.push_back(rows[i]);
    if (rows[i].parent) result.back().parent = position[*rows[i].parent];
  }
  return result;
}

template <class Indices>
std::multiset<Row> pick(const std::vector<Row>& rows, const Indices& indices) {
  std::multiset<Row> picked;
  for (const std::uint32_t i : indices) picked.insert(rows[i]);
  return picked;
}

class AnySelection : public ::testing::TestWithParam<const char*> {
 protected:
  std::unique_ptr<Selection> selection = make<Selection>(GetParam());
};

TEST_P(AnySelection, FillsThePopulationWithDifferentRows) {
  for (std::uint64_t seed = 0; seed < 30; ++seed)
    for (const std::uint32_t population : {1, 2, 7, 20, 34, 35, 50}) {
      const auto living = survivors(*selection, random_rows(seed), population);
      EXPECT_EQ(living.size(), std::min(population, 35u));
      EXPECT_EQ(std::set(living.begin(), living.end()).size(), living.size());
      for (const std::uint32_t i : living) EXPECT_LT(i, 35u);
    }
  EXPECT_TRUE(survivors(*selection, {}, 10).empty());
  EXPECT_TRUE(survivors(*selection, random_rows(1), 0).empty());
}

TEST_P(AnySelection, FailedRowsSurviveOnlyWhereAllOthersDo) {
  for (std::uint64_t seed = 0; seed < 60; ++seed)
    for (const std::uint32_t population : {1, 5, 20, 28}) {
      const auto rows = random_rows(seed, 20, 15, 1 + seed % 3, 0.5);
      const auto living = survivors(*selection, rows, population);
      const auto all_ok = std::count_if(rows.begin(), rows.end(), [](const Row& row) { return !row.scores.empty(); });
      const auto living_ok =
          std::count_if(living.begin(), living.end(), [&](std::uint32_t i) { return !rows[i].scores.empty(); });
      EXPECT_EQ(living_ok, std::min<long>(all_ok, population)) << "seed " << seed;
    }
}

TEST_P(AnySelection, TheBestFirstScoreSurvives) {
  for (std::uint64_t seed = 0; seed < 60; ++seed)
    for (const std::uint32_t population : {1, 2, 5, 20}) {
      const auto rows = random_rows(seed, 20, 15, 1 + seed % 3);
      const auto first = [&](const Row& row) { return row.scores.empty() ? -1 : row.scores[0]; };
      double best = -1, living_best = -1;
      for (const Row& row : rows) best = std::max(best, first(row));
      for (const std::uint32_t i : survivors(*selection, rows, population))
        living_best = std::max(living_best, first(rows[i]));
      EXPECT_EQ(living_best, best) << "seed " << seed << ", population " << population;
    }
}

TEST_P(AnySelection, DoesNotDependOnTheOrderOfBirth) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const auto rows = rows_without_ties(seed), others = permuted(rows, seed);
    for (const std::uint32_t population : {5, 20})
      EXPECT_EQ(pick(rows, survivors(*selection, rows, population)),
                pick(others, survivors(*selection, others, population)));
    const auto pairs = parents(*selection, rows, 50), other_pairs = parents(*selection, others, 50);
    for (std::size_t i = 0; i < 50; ++i) {
      EXPECT_EQ(rows[pairs[i].first], others[other_pairs[i].first]);
      EXPECT_EQ(rows[pairs[i].second], others[other_pairs[i].second]);
    }
  }
}

TEST_P(AnySelection, FailedRowsDoNotBreedWhereOthersCan) {
  const auto rows = random_rows(3, 20, 15, 2, 0.6);
  std::set<std::uint32_t> breeding;
  const auto pairs = parents(*selection, rows, 2000);
  ASSERT_EQ(pairs.size(), 2000u);
  for (const auto& [parent, mate] : pairs) {
    EXPECT_NE(parent, mate);
    EXPECT_FALSE(rows[parent].scores.empty());
    EXPECT_FALSE(rows[mate].scores.empty());
    breeding.insert(parent);
  }
  // every individual that has not failed becomes a parent
  EXPECT_EQ(breeding.size(), static_cast<std::size_t>(std::count_if(
                                 rows.begin(), rows.end(), [](const Row& row) { return !row.scores.empty(); })));
}

TEST_P(AnySelection, OneRowBreedsWithItself) {
  for (const auto& [parent, mate] : parents(*selection, {{{}, 1}, {{5, 5}, 3}, {{}, 2}}, 20)) {
    EXPECT_EQ(parent, 1u);
    EXPECT_EQ(mate, 1u);
  }
  EXPECT_TRUE(parents(*selection, {}, 5).empty());
}

TEST_P(AnySelection, LifeGoesOnWhereAllFailed) {
  const std::vector<Row> rows(10, Row{{}, 1});
  EXPECT_EQ(survivors(*selection, rows, 6).size(), 6u);
  std::set<std::uint32_t> breeding;
  for (const auto& [parent, mate] : parents(*selection, rows, 300)) {
    EXPECT_NE(parent, mate);
    breeding.insert(parent);
  }
  EXPECT_EQ(breeding.size(), 10u);
}

TEST_P(AnySelection, DependsOnItsKeyAlone) {
  const auto rows = random_rows(5);
  const auto pairs = from_eight_threads([&] { return parents(*selection, rows, 20, 1); });
  EXPECT_NE(pairs, parents(*selection, rows, 20, 2));
  from_eight_threads([&] { return survivors(*selection, rows, 20); });
}

INSTANTIATE_TEST_SUITE_P(Selections, AnySelection,
                         ::testing::Values("age-fitness-pareto", "pareto-layers", "elitist", "nsga2"));

/// Returns how often each of ten rows, best first, is a parent, in percent.
std::vector<double> shares(const Selection& selection) {
  std::vector<Row> rows;
  for (int i = 0; i < 10; ++i) rows.push_back({{10.0 - i}, 1});
  std::vector<double> share(10, 0);
  for (const auto& [parent, mate] : parents(selection, rows, 20000)) share[parent] += 100.0 / 20000;
  return share;
}

TEST(UniformParents, HaveTheSameChance) {
  for (const auto* name : {"age-fitness-pareto", "pareto-layers"})
    for (const double share : shares(*make<Selection>(name))) EXPECT_NEAR(share, 10, 1.1) << name;
}

TEST(Elitist, ParentsAreWinnersOfTournaments) {
  const auto two = shares(*make<Selection>("elitist"));
  // the better of two draws is row i in 2 (9 - i) + 1 of 100 cases
  for (int i = 0; i < 10; ++i) EXPECT_NEAR(two[static_cast<std::size_t>(i)], 2 * (9 - i) + 1, 1.5);
  for (const double share : shares(*make<Selection>("elitist", "tournament = 1"))) EXPECT_NEAR(share, 10, 1.1);
  // the best row nearly always wins; its mate is nevertheless another row
  const auto strict = make<Selection>("elitist", "tournament = 100");
  for (const auto& [parent, mate] : parents(*strict, {{{1}}, {{3}}, {{2}}}, 50)) {
    EXPECT_EQ(parent, 1u);
    EXPECT_EQ(mate, 2u);
  }
}

TEST(Elitist, KeepsTheBest) {
  const auto selection = make<Selection>("elitist");
  EXPECT_THAT(survivors(*selection, {{{1, 9}}, {{5, 0}}, {}, {{-3, 9}}, {{4, 0}}}, 3), ::testing::ElementsAre(1, 4, 0));
  // ties are decided by further scores, then by lower age, then by earlier birth
  EXPECT_THAT(survivors(*selection, {{{1, 1}, 5}, {{1, 2}, 9}, {{1, 1}, 3}, {{1, 1}, 3}}, 3),
              ::testing::ElementsAre(1, 2, 3));
}

TEST(AgeFitnessPareto, KeepsWholeLayersFirst) {
  const auto selection = make<Selection>("age-fitness-pareto");
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const auto rows = random_rows(seed, 20, 15, 1 + seed % 2);
    const auto layer = pareto_layers(scores_and_youth(candidates(rows)));
    const auto living = survivors(*selection, rows, 12);
    std::uint32_t deepest = 0;
    for (const std::uint32_t i : living) deepest = std::max(deepest, layer[i]);
    for (std::uint32_t i = 0; i < rows.size(); ++i) {
      const bool lives = std::find(living.begin(), living.end(), i) != living.end();
      EXPECT_TRUE(lives || layer[i] >= deepest);
    }
  }
}

TEST(AgeFitnessPareto, SparesTheYoung) {
  const auto selection = make<Selection>("age-fitness-pareto");
  // the weak random individual 3 is on the front; the older copy of row 1 is not
  EXPECT_THAT(survivors(*selection, {{{9}, 40}, {{5}, 10}, {{5}, 11}, {{0.1}, 0}}, 3),
              ::testing::UnorderedElementsAre(0, 1, 3));
}

TEST(AgeFitnessPareto, ThinsTheCrowd) {
  const auto selection = make<Selection>("age-fitness-pareto");
  // all rows are on the front; rows 2 and 3 are close to each other
  EXPECT_THAT(survivors(*selection, {{{0}, 0}, {{30}, 30}, {{50}, 50}, {{51}, 51}, {{80}, 80}, {{100}, 100}}, 5),
              ::testing::AllOf(::testing::SizeIs(5), ::testing::IsSupersetOf({0, 1, 4, 5})));
}

// pareto-layers ------------------------------------------------------------------------------------------------------

// row 0 of each table, which dominates all others, so that the front contains only it
const Row champion{{100}, 0};

TEST(ParetoLayers, AChildTakesItsParentsPlaceOnlyIfBetter) {
  const auto selection = make<Selection>("pareto-layers");
  // row 1 loses to its child 3; row 2 keeps its place against its child 4, although row 1 is better than both of them
  EXPECT_THAT(survivors(*selection, {champion, {{50}, 3}, {{10}, 3}, {{60}, 3, 1}, {{9}, 3, 2}}, 3),
              ::testing::UnorderedElementsAre(0, 3, 2));
}

TEST(ParetoLayers, AHigherLayerBeatsAHigherFitness) {
  const auto selection = make<Selection>("pareto-layers");
  // row 1 is dominated by row 2, row 3 only by the champion
  EXPECT_THAT(survivors(*selection, {champion, {{50}, 9}, {{60}, 8}, {{20}, 2, 1}}, 3),
              ::testing::UnorderedElementsAre(0, 2, 3));
}

TEST(ParetoLayers, EqualsDoNotReplace) {
  const auto selection = make<Selection>("pareto-layers");
  EXPECT_THAT(survivors(*selection, {champion, {{50}, 3}, {{50}, 3, 1}}, 2), ::testing::UnorderedElementsAre(0, 1));
}

TEST(ParetoLayers, OfSeveralChildrenTheBestTakesThePlace) {
  const auto selection = make<Selection>("pareto-layers");
  EXPECT_THAT(survivors(*selection, {champion, {{10}, 3}, {{5}, 3}, {{20}, 3, 1}, {{30}, 3, 1}}, 3),
              ::testing::UnorderedElementsAre(0, 4, 2));
}

TEST(ParetoLayers, TheFrontIsExempt) {
  const auto selection = make<Selection>("pareto-layers");
  // row 2 is weaker than its parent 1 but younger, so both are on the front; the worst of the others is removed
  EXPECT_THAT(survivors(*selection, {{{100}, 9}, {{50}, 5}, {{40}, 4, 1}, {{30}, 6}, {{20}, 6}}, 4),
              ::testing::UnorderedElementsAre(0, 1, 2, 3));
}

TEST(ParetoLayers, TheMostCrowdedOfTooLargeAFrontGo) {
  const auto selection = make<Selection>("pareto-layers");
  EXPECT_THAT(
      survivors(*selection, {{{0}, 0}, {{30}, 30}, {{50}, 50}, {{51}, 51}, {{80}, 80}, {{100}, 100}, {{1}, 90}}, 5),
      ::testing::AllOf(::testing::SizeIs(5), ::testing::IsSupersetOf({0, 1, 4, 5})));
}

TEST(ParetoLayers, NewcomersChallengeTheWorst) {
  const auto selection = make<Selection>("pareto-layers");
  // in the first table, the random individual 3, which is as old as the champion, replaces the worst row; in the second
  // table, it is the worst row itself
  EXPECT_THAT(survivors(*selection, {champion, {{50}, 3}, {{10}, 3}, {{20}, 0}}, 3),
              ::testing::UnorderedElementsAre(0, 1, 3));
  EXPECT_THAT(survivors(*selection, {champion, {{50}, 3}, {{10}, 3}, {{5}, 4}}, 3),
              ::testing::UnorderedElementsAre(0, 1, 2));
}

TEST(ParetoLayers, AgeIsAnObjectiveUnlessToldOtherwise) {
  const std::vector<Row> rows{{{100}, 9}, {{50}, 5}, {{1}, 0}};
  EXPECT_THAT(survivors(*make<Selection>("pareto-layers", "age = false"), rows, 2),
              ::testing::UnorderedElementsAre(0, 1));
  // with the second objective, all three are on the front, and the one between the ends is the most crowded
  EXPECT_THAT(survivors(*make<Selection>("pareto-layers"), rows, 2), ::testing::UnorderedElementsAre(0, 2));
}

TEST(ParetoLayers, LosersFillFreePlacesBeforeTheFailed) {
  const auto selection = make<Selection>("pareto-layers");
  EXPECT_THAT(survivors(*selection, {champion, {}, {{50}, 3}, {{40}, 3, 2}, {{}, 0, 1}}, 3),
              ::testing::UnorderedElementsAre(0, 2, 3));
}

TEST(ParetoLayers, AFailedChildDoesNotReplace) {
  const auto selection = make<Selection>("pareto-layers");
  EXPECT_THAT(survivors(*selection, {champion, {{-5}, 9}, {{}, 0, 1}}, 2), ::testing::UnorderedElementsAre(0, 1));
  // a failed parent is removed
  EXPECT_THAT(survivors(*selection, {champion, {{}, 1}, {{-5}, 9, 1}}, 2), ::testing::UnorderedElementsAre(0, 2));
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
