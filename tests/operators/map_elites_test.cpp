// MAP-Elites with both kinds of cells.
#include <ranges>

#include "evodevo/helpers/selection/niches.hpp"
#include "evolution.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

const std::vector<Objective> ranges = {{"height", "m", true, Role::descriptor, 0, 2, 4},
                                       {"contact", "1", true, Role::descriptor, -1, 1, 4}};

Table random_table(std::uint64_t seed, std::uint32_t count) {
  Rng rng = stream(seed);
  Table table{.descriptors = ranges};
  for (std::uint32_t i = 0; i < count; ++i) {
    Individual one{.id = i};
    if (!rng.chance(0.2)) {
      one.scores = {rng.uniform()};
      one.descriptors = {rng.uniform(-0.2, 2.2), rng.uniform(-1.2, 1.2)};
    }
    table.rows.push_back(one);
  }
  return table;
}

/// Returns the best row of each cell, given the cell of each pair of descriptors.
template <class CellOf>
std::map<std::size_t, std::uint32_t> best_rows(const Table& table, const CellOf& cell_of) {
  std::map<std::size_t, std::uint32_t> best;
  for (std::uint32_t row = 0; row < table.rows.size(); ++row) {
    const Individual& one = table.rows[row];
    if (one.scores.empty()) continue;
    const auto found = best.emplace(cell_of(one.descriptors[0] / 2, (one.descriptors[1] + 1) / 2), row).first;
    if (one.scores[0] > table.rows[found->second].scores[0]) found->second = row;
  }
  return best;
}

TEST(MapElites, TheBestOfEachCellOfAGridSurvives) {
  const auto selection = make<Selection>("map-elites", "");
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Table table = random_table(seed, 60);
    const auto index = [](double share) { return std::min(3, std::max(0, static_cast<int>(std::floor(4 * share)))); };
    const auto best = best_rows(table, [&](double x, double y) { return 4 * index(x) + index(y); });
    const auto expected = std::views::values(best);
    const Survival survival = table.survivors(*selection, 100);
    EXPECT_THAT(survival.rows, ::testing::UnorderedElementsAreArray(expected.begin(), expected.end()));
    EXPECT_FALSE(survival.memory);
    EXPECT_TRUE(selection->memory().empty());
    const auto ok = std::ranges::count_if(table.rows, [](const Individual& one) { return !one.scores.empty(); });
    EXPECT_EQ(std::ssize(survival.notes), ok);
    for (const Note& note : survival.notes)
      EXPECT_EQ(best.at(static_cast<std::size_t>(note.value)) == note.row, std::ranges::count(expected, note.row) == 1);
  }
}

TEST(MapElites, AMemoryThatIsNotItsOwnIsRefused) {
  const auto selection = make<Selection>("map-elites", "cells = \"centroidal\"\ncount = 2");
  Table table = random_table(1, 8);
  const auto survive_with = [&](const std::vector<double>& centres) {
    table.memory.lists = {{"centres", centres}};
    table.survivors(*selection, 8);
  };
  const std::vector<double> two = {0.5, 0.5, 0.2, 0.1};
  EXPECT_NO_THROW(survive_with(two));
  EXPECT_THROW(survive_with({}), std::runtime_error);
  EXPECT_THROW(survive_with({0.5, 0.5, 0.2}), std::runtime_error);
  EXPECT_THROW(survive_with({0.5, 0.5}), std::runtime_error) << "of only one";
  EXPECT_THROW(survive_with({0.5, 0.5, 0.2, 1e200}), std::runtime_error) << "its distances are not finite";
  table.descriptors.pop_back();
  EXPECT_THAT([&] { survive_with(two); },
              ::testing::ThrowsMessage<std::runtime_error>(::testing::HasSubstr("1 descriptors")));
}

TEST(MapElites, TheBestOfTheCellWithTheNearestCentreSurvives) {
  const auto selection = make<Selection>("map-elites", "cells = \"centroidal\"\ncount = 12");
  Table table = random_table(1, 80);
  const Survival first = table.survivors(*selection, 100);
  ASSERT_TRUE(first.memory);
  const auto centres = places_in(*first.memory, "centres", 12, 2);
  const auto best = best_rows(table, [&](double x, double y) {
    const auto distance = [&](const Coordinates& centre) { return std::hypot(centre[0] - x, centre[1] - y); };
    return static_cast<std::size_t>(std::ranges::min_element(centres, {}, distance) - centres.begin());
  });
  const auto expected = std::views::values(best);
  EXPECT_THAT(first.rows, ::testing::UnorderedElementsAreArray(expected.begin(), expected.end()));

  const auto other = make<Selection>("map-elites", "cells = \"centroidal\"\ncount = 12");
  EXPECT_EQ(table.survivors(*other, 100, 2).memory, first.memory) << "the cells are the same in all runs";
  table.memory = *first.memory;
  const Survival second = table.survivors(*selection, 100, 2);
  EXPECT_FALSE(second.memory) << "the cells stay";
  EXPECT_EQ(second.rows, first.rows);
}

TEST(MapElites, AllBreedAlikeButTheWorstElitesDieIfThereAreTooFewPlaces) {
  const auto selection = make<Selection>("map-elites", "");
  const Table table{.rows = {{.scores = {1}, .descriptors = {0.1, 0}},
                             {.scores = {9}, .descriptors = {1.9, 0}},
                             {.scores = {8}, .descriptors = {1.8, 0}},
                             {.scores = {5}, .descriptors = {0.6, 0}}},
                    .descriptors = ranges};
  EXPECT_THAT(table.survivors(*selection, 2).rows, ::testing::ElementsAre(1, 3));
  std::vector<int> times(4, 0);
  for (const auto& [parent, mate] : table.parents(*selection, 4000)) ++times.at(parent);
  for (const int count : times) EXPECT_NEAR(count, 1000, 140);  // five standard deviations
}

TEST(MapElites, WhatLiesFarOutsideBelongsToTheNearestCellAndTheFailedLiveWhereAllFailed) {
  for (const char* cells : {"grid", "centroidal"}) {
    const auto selection = make<Selection>("map-elites", std::string("cells = \"") + cells + "\"\ncount = 30");
    const Table table{.rows = {{.scores = {1}, .descriptors = {2000, 0.1}, .id = 0},
                               {.scores = {2}, .descriptors = {1e300, 0.1}, .id = 1},
                               {.scores = {3}, .descriptors = {1.7e308, 0.1}, .id = 2},
                               {.scores = {4}, .descriptors = {-1.7e308, 0.1}, .id = 3}},
                      .descriptors = ranges};
    EXPECT_THAT(table.survivors(*selection, 4).rows, ::testing::ElementsAre(3, 2)) << cells;
    const Table failed{.rows = {{}, {}, {}}, .descriptors = ranges};
    EXPECT_THAT(failed.survivors(*selection, 2).rows, ::testing::SizeIs(2)) << cells;
  }
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
