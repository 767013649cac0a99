#include <algorithm>
#include <numeric>
#include <set>

#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// A candidate for selection, with its own copy of the scores.
struct Row {
  std::vector<double> scores;  ///< empty if the individual has failed
  std::uint32_t age = 0;
  std::optional<std::uint32_t> parent = {};
};

/// Calls `use` with the context of a table, whose ids are the numbers of its rows.
template <class Use>
auto seen(const std::vector<Row>& rows, const Use& use) {
  std::vector<Candidate> table;
  for (const Row& row : rows) {
    table.push_back({row.scores, row.age, row.parent});
    table.back().id = static_cast<std::uint32_t>(table.size() - 1);
  }
  const Layout layout;
  const SelectionMemory memory;
  Rng rng = stream(1);
  return use(SelectionContext{table, {}, {}, {}, layout, 1, memory}, rng);
}

std::vector<std::uint32_t> survivors(const Selection& selection, const std::vector<Row>& rows,
                                     std::uint32_t population) {
  return seen(rows, [&](const auto& context, Rng& rng) { return selection.survivors(context, population, rng).rows; });
}

std::vector<Couple> parents(const Selection& selection, const std::vector<Row>& rows, std::uint32_t count) {
  return seen(rows, [&](const auto& context, Rng& rng) { return selection.parents(context, count, rng); });
}

/// Returns 20 random rows and up to 15 children of them. Scores have few different values, so that there are ties, and
/// some rows have failed.
std::vector<Row> random_rows(std::uint64_t seed, std::size_t objectives, double failing) {
  Rng rng = stream(seed);
  std::vector<Row> rows;
  for (std::uint32_t i = 0; i < 35; ++i) {
    Row row;
    row.age = rng.below(6);
    if (!rng.chance(failing))
      for (std::size_t o = 0; o < objectives; ++o) row.scores.push_back(rng.below(10));
    if (i >= 20 && rng.chance(0.9)) row.parent = rng.below(20);
    rows.push_back(row);
  }
  return rows;
}

class AnySelection : public ::testing::TestWithParam<const char*> {
 protected:
  std::unique_ptr<Selection> selection = make<Selection>(GetParam());
};

TEST_P(AnySelection, FillsThePopulationWithTheBestFirstScoreAndTheFailedLast) {
  std::vector<std::uint32_t> all(35);
  std::iota(all.begin(), all.end(), 0u);
  for (std::uint64_t seed = 0; seed < 60; ++seed)
    for (const std::uint32_t population : {1, 2, 5, 7, 20, 28, 34, 35, 50}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", population " + std::to_string(population));
      const auto rows = random_rows(seed, 1 + seed % 3, 0.5);
      const auto ok = [&](std::uint32_t i) { return !rows[i].scores.empty(); };
      const auto first = [&](std::uint32_t i) { return ok(i) ? rows[i].scores[0] : -1; };
      const auto living = survivors(*selection, rows, population);
      ASSERT_EQ(std::set(living.begin(), living.end()).size(), std::min(population, 35u));
      EXPECT_EQ(std::ranges::count_if(living, ok), std::min<long>(std::ranges::count_if(all, ok), population));
      EXPECT_EQ(first(std::ranges::max(living, {}, first)), first(std::ranges::max(all, {}, first)));
    }
  EXPECT_TRUE(survivors(*selection, {}, 10).empty());
  EXPECT_TRUE(survivors(*selection, random_rows(1, 2, 0.25), 0).empty());
}

TEST_P(AnySelection, ThoseWhoDidNotFailBreedWithOthersAndAllIfAllFailed) {
  const std::vector<Row> one{{{}, 1}, {{5, 5}, 3}, {{}, 2}}, failed(10, Row{{}, 1});
  for (const auto& rows : {random_rows(3, 2, 0.6), one, failed}) {
    const bool all_failed = std::ranges::all_of(rows, [](const Row& row) { return row.scores.empty(); });
    std::set<std::uint32_t> able, breeding;
    for (std::uint32_t i = 0; i < rows.size(); ++i)
      if (all_failed || !rows[i].scores.empty()) able.insert(i);
    const auto pairs = parents(*selection, rows, 2000);
    EXPECT_EQ(pairs.size(), 2000u);
    for (const auto& [parent, mate] : pairs) {
      EXPECT_EQ(parent == mate, able.size() == 1);
      EXPECT_TRUE(able.contains(mate));
      breeding.insert(parent);
    }
    EXPECT_EQ(breeding, able);
  }
  EXPECT_TRUE(parents(*selection, {}, 5).empty());
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
  for (const auto* name : {"age-fitness-pareto", "pareto-layers", "comma", "novelty"})
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

/// Expects that `living` are among those who survive in a population of so many.
void expect_living(const Selection& selection, const char* rule, const std::vector<Row>& rows, std::uint32_t population,
                   const std::vector<std::uint32_t>& living) {
  EXPECT_THAT(survivors(selection, rows, population),
              ::testing::AllOf(::testing::SizeIs(population), ::testing::IsSupersetOf(living)))
      << rule;
}

TEST(AgeFitnessPareto, SparesTheYoungAndThinsTheCrowd) {
  const auto selection = make<Selection>("age-fitness-pareto");
  expect_living(*selection, "the weak random individual 3 is on the front; the older copy of row 1 is not",
                {{{9}, 40}, {{5}, 10}, {{5}, 11}, {{0.1}, 0}}, 3, {0, 1, 3});
  expect_living(*selection, "all are on the front; rows 2 and 3 are close to each other",
                {{{0}, 0}, {{30}, 30}, {{50}, 50}, {{51}, 51}, {{80}, 80}, {{100}, 100}}, 5, {0, 1, 4, 5});
}

TEST(ParetoLayers, ReplaceByLayerThenFitness) {
  const auto selection = make<Selection>("pareto-layers");
  const Row champion{{100}, 0};  // dominates all others, so that the front contains only it
  expect_living(
      *selection,
      "row 1 loses to its child 3; row 2 keeps its place against its child 4, although row 1 is better than both",
      {champion, {{50}, 3}, {{10}, 3}, {{60}, 3, 1}, {{9}, 3, 2}}, 3, {0, 3, 2});
  expect_living(*selection, "row 1, of higher fitness, is dominated by row 2, and its child 3 only by the champion",
                {champion, {{50}, 9}, {{60}, 8}, {{20}, 2, 1}}, 3, {0, 2, 3});
  expect_living(*selection, "equals do not replace", {champion, {{50}, 3}, {{50}, 3, 1}}, 2, {0, 1});
  expect_living(*selection, "of several children, the best takes the place",
                {champion, {{10}, 3}, {{5}, 3}, {{20}, 3, 1}, {{30}, 3, 1}}, 3, {0, 4, 2});
  expect_living(
      *selection,
      "row 2 is weaker than its parent 1 but younger, so both are on the front; the worst of the others is removed",
      {{{100}, 9}, {{50}, 5}, {{40}, 4, 1}, {{30}, 6}, {{20}, 6}}, 4, {0, 1, 2, 3});
  expect_living(*selection, "the most crowded of too large a front go",
                {{{0}, 0}, {{30}, 30}, {{50}, 50}, {{51}, 51}, {{80}, 80}, {{100}, 100}, {{1}, 90}}, 5, {0, 1, 4, 5});
  expect_living(*selection, "the random individual 3 replaces the worst row",
                {champion, {{50}, 3}, {{10}, 3}, {{20}, 0}}, 3, {0, 1, 3});
  expect_living(*selection, "the random individual 3 is the worst row", {champion, {{50}, 3}, {{10}, 3}, {{5}, 4}}, 3,
                {0, 1, 2});
  expect_living(*selection, "losers fill free places before the failed",
                {champion, {}, {{50}, 3}, {{40}, 3, 2}, {{}, 0, 1}}, 3, {0, 2, 3});
  expect_living(*selection, "a failed child does not replace", {champion, {{-5}, 9}, {{}, 0, 1}}, 2, {0, 1});
  expect_living(*selection, "a failed parent is removed", {champion, {{}, 1}, {{-5}, 9, 1}}, 2, {0, 2});
}

TEST(ParetoLayers, AgeIsAnObjectiveUnlessToldOtherwise) {
  const std::vector<Row> rows{{{100}, 9}, {{50}, 5}, {{1}, 0}};
  EXPECT_THAT(survivors(*make<Selection>("pareto-layers", "age = false"), rows, 2),
              ::testing::UnorderedElementsAre(0, 1));
  // with the second objective, all three are on the front, and the one between the ends is the most crowded
  EXPECT_THAT(survivors(*make<Selection>("pareto-layers"), rows, 2), ::testing::UnorderedElementsAre(0, 2));
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
