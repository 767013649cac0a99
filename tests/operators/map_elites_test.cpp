// MAP-Elites with both kinds of cells.
#include <set>

#include "evodevo/helpers/selection/memory.hpp"
#include "evodevo/helpers/selection/niches.hpp"
#include "evolution.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

std::vector<Objective> ranges_with(std::uint32_t bins) {
  return {{"height", "m", true, Role::descriptor, 0, 2, bins}, {"contact", "1", true, Role::descriptor, -1, 1, bins}};
}
const std::vector<Objective> ranges = ranges_with(4);

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

TEST(MapElites, TheBestOfEachCellOfAGridSurvives) {
  const auto selection = make<Selection>("map-elites", "");
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Table table = random_table(seed, 60);
    const auto index = [](double share) { return std::min(3, std::max(0, static_cast<int>(std::floor(4 * share)))); };
    std::map<int, std::uint32_t> best;
    for (std::uint32_t row = 0; row < 60; ++row) {
      const Individual& one = table.rows[row];
      if (one.scores.empty()) continue;
      const int cell = 4 * index(one.descriptors[0] / 2) + index((one.descriptors[1] + 1) / 2);
      const auto found = best.emplace(cell, row).first;
      if (one.scores[0] > table.rows[found->second].scores[0]) found->second = row;
    }
    std::set<std::uint32_t> expected;
    for (const auto& [cell, row] : best) expected.insert(row);
    const Survival survival = table.survive(*selection, 100);
    EXPECT_EQ(std::set(survival.rows.begin(), survival.rows.end()), expected);
    EXPECT_EQ(survival.rows.size(), expected.size());
    EXPECT_TRUE(survival.memory.empty());
    EXPECT_EQ(survival.notes.size(),
              static_cast<std::size_t>(std::count_if(table.rows.begin(), table.rows.end(),
                                                     [](const Individual& one) { return !one.scores.empty(); })));
    for (const Note& note : survival.notes)
      EXPECT_EQ(best.at(static_cast<int>(note.value)) == note.row, expected.contains(note.row));
  }
}

TEST(MapElites, AMemoryOfImpossiblePlacesIsRefused) {
  const auto selection = make<Selection>("map-elites", "cells = \"centroidal\"\ncount = 12");
  Table table = random_table(1, 8);
  const auto is_refused = [&](const std::vector<Coordinates>& centres) {
    MemoryWriter writer;
    writer.write(centres);
    table.memory = writer.bytes();
    try {
      table.survive(*selection, 8);
      return false;
    } catch (const std::runtime_error&) {
      return true;
    }
  };
  EXPECT_FALSE(is_refused({{0.5, 0.5}, {0.2, 0.1}}));
  EXPECT_TRUE(is_refused({}));
  EXPECT_TRUE(is_refused({{0.5, 0.5}, {0.2}}));
  EXPECT_TRUE(is_refused({{0.5, 1e200}})) << "its distances are not finite";
}

TEST(MapElites, TheBestOfTheCellWithTheNearestCentreSurvives) {
  const auto selection = make<Selection>("map-elites", "cells = \"centroidal\"\ncount = 12");
  Table table = random_table(1, 80);
  const Survival first = table.survive(*selection, 100);
  MemoryReader reader(first.memory);
  const auto centres = reader.read_lists<double>();
  ASSERT_EQ(centres.size(), 12u);

  std::map<std::size_t, std::uint32_t> best;
  for (std::uint32_t row = 0; row < 80; ++row) {
    const Individual& one = table.rows[row];
    if (one.scores.empty()) continue;
    const double x = one.descriptors[0] / 2, y = (one.descriptors[1] + 1) / 2;
    std::size_t nearest = 0;
    const auto squared = [&](const Coordinates& c) { return (c[0] - x) * (c[0] - x) + (c[1] - y) * (c[1] - y); };
    for (std::size_t i = 1; i < centres.size(); ++i)
      if (squared(centres[i]) < squared(centres[nearest])) nearest = i;
    const auto found = best.emplace(nearest, row).first;
    if (one.scores[0] > table.rows[found->second].scores[0]) found->second = row;
  }
  std::set<std::uint32_t> expected;
  for (const auto& [cell, row] : best) expected.insert(row);
  EXPECT_EQ(std::set(first.rows.begin(), first.rows.end()), expected);

  const auto other = make<Selection>("map-elites", "cells = \"centroidal\"\ncount = 12");
  EXPECT_EQ(table.survive(*other, 100, 2).memory, first.memory) << "the cells are the same in all runs";
  table.memory = first.memory;
  const Survival second = table.survive(*selection, 100, 2);
  EXPECT_EQ(second.memory, first.memory) << "the cells stay";
  EXPECT_EQ(second.rows, first.rows);
}

TEST(MapElites, TheWorstElitesDieIfThereAreTooFewPlaces) {
  const auto selection = make<Selection>("map-elites", "");
  const Table table{.rows = {{.scores = {1}, .descriptors = {0.1, 0}},
                             {.scores = {9}, .descriptors = {1.9, 0}},
                             {.scores = {8}, .descriptors = {1.8, 0}},
                             {.scores = {5}, .descriptors = {0.6, 0}}},
                    .descriptors = ranges};
  EXPECT_THAT(table.survive(*selection, 2).rows, ::testing::ElementsAre(1, 3));
}

TEST(MapElites, WhatLiesFarOutsideBelongsToTheNearestCell) {
  for (const char* cells : {"grid", "centroidal"}) {
    const auto selection = make<Selection>("map-elites", std::string("cells = \"") + cells + "\"\ncount = 30");
    const Table table{.rows = {{.scores = {1}, .descriptors = {2000, 0.1}, .id = 0},
                               {.scores = {2}, .descriptors = {1e300, 0.1}, .id = 1},
                               {.scores = {3}, .descriptors = {1.7e308, 0.1}, .id = 2},
                               {.scores = {4}, .descriptors = {-1.7e308, 0.1}, .id = 3}},
                      .descriptors = ranges};
    EXPECT_THAT(table.survive(*selection, 4).rows, ::testing::ElementsAre(3, 2)) << cells;
  }
}

TEST(MapElites, AMemoryThatIsNotItsOwnIsRefused) {
  const auto selection = make<Selection>("map-elites", "cells = \"centroidal\"\ncount = 5");
  Table table = random_table(1, 20);
  table.memory = table.survive(*selection, 5).memory;
  table.descriptors.pop_back();
  EXPECT_THAT([&] { table.survive(*selection, 5); },
              ::testing::ThrowsMessage<std::runtime_error>(::testing::HasSubstr("1 descriptors")));
}

TEST(MapElites, LifeGoesOnWhereAllFailed) {
  for (const char* cells : {"grid", "centroidal"}) {
    const auto selection = make<Selection>("map-elites", std::string("cells = \"") + cells + "\"\ncount = 5");
    const Table table{.rows = {{}, {}, {}}, .descriptors = ranges};
    EXPECT_THAT(table.survive(*selection, 2).rows, ::testing::SizeIs(2));
  }
}

/// Every cell can be reached, and the best score in it is known: that of the corner nearest to the middle.
TEST(MapElites, FillsTheMapWithItsBest) {
  const auto selection = make<Selection>("map-elites", "");
  Evolution evolution(
      *selection, real_genes(2, -1, 1),
      [](Individual& one) {
        const double x = one.genome[0], y = one.genome[1];
        one.descriptors = {x + 1, y};
        one.scores = {-x * x - y * y};
      },
      1);
  evolution.table.descriptors = ranges_with(5);
  evolution.run(200, 100, 40);
  ASSERT_EQ(evolution.table.rows.size(), 25u);
  for (const Individual& one : evolution.table.rows) {
    const auto cell = static_cast<int>(one.notes.at("cell"));
    const auto nearest = [](int bin) { return std::max(0.0, std::abs(bin - 2) * 0.4 - 0.2); };
    const double best = -std::pow(nearest(cell / 5), 2) - std::pow(nearest(cell % 5), 2);
    EXPECT_NEAR(one.scores[0], best, 0.05) << cell;
  }
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
