// The arithmetic of the study of stress, and the completeness of its data.
#include "overlap.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "support/scratch.hpp"

namespace evodevo::tools::stress::EVODEVO_FILE {
namespace {

std::vector<double> rising(std::size_t springs, double from = 0) {
  std::vector<double> stress(springs);
  std::iota(stress.begin(), stress.end(), from);
  return stress;
}

TEST(Overlap, CountsTheLeastAndTheMostThatBothRankingsHave) {
  const std::vector<double> truth = rising(1000);
  EXPECT_EQ(found(truth, truth).least, 1);
  EXPECT_EQ(found(truth, truth).most, 1);
  // 25 of the 125 least stressed springs, and 40 of the 100 most stressed, are exchanged with springs in the middle
  std::vector<double> estimate = truth;
  for (std::size_t i = 0; i < 25; ++i) std::swap(estimate[i], estimate[500 + i]);
  for (std::size_t i = 0; i < 40; ++i) std::swap(estimate[999 - i], estimate[600 + i]);
  EXPECT_DOUBLE_EQ(found(truth, estimate).least, 0.8);
  EXPECT_DOUBLE_EQ(found(truth, estimate).most, 0.6);
}

const Case scene{"scene", "file.toml"};

/// A robot whose springs have their final order from cycle time `known` on, and the reverse order before.
StressOverTime robot_known_from(std::size_t known) {
  StressOverTime robot;
  for (std::size_t t = 0; t < cycle_times().size(); ++t) {
    std::vector<double> stress = rising(500, 1);
    if (t < known)
      for (double& value : stress) value = -value;
    robot.push_back(stress);
  }
  return robot;
}

TEST(Overlap, RowsHoldMeansOverTheRobots) {
  Table table = overlap_table();
  add_rows(scene, {robot_known_from(2), robot_known_from(4)}, table);
  ASSERT_EQ(table.rows().size(), 2 * cycle_times().size());
  const double expected[] = {0, 0, 0.5, 0.5, 1, 1, 1, 1, 1, 1};
  for (std::size_t row = 0; row < table.rows().size(); ++row) {
    EXPECT_EQ(table.number(row, "found (1)"), expected[row / 2]) << row;
    EXPECT_EQ(table.number(row, "robots"), 2);
    EXPECT_EQ(table.number(row, "by chance (1)"), (row % 2 ? 100 : 125) / 500.0);
  }
  EXPECT_NEAR(table.number(4, "found by the 10th percentile (1)"), 0.1, 1e-12);
  EXPECT_NEAR(table.number(4, "found by the 90th percentile (1)"), 0.9, 1e-12);
}

TEST(Overlap, TheShortestCycleIsTheOneFromWhichOnEnoughIsFound) {
  const std::vector<double> times = cycle_times();
  const std::size_t last = times.size() - 1;
  Table table = overlap_table();
  // half of the springs are found from the fourth time on, and all from the sixth on
  add_rows(scene, {robot_known_from(3), robot_known_from(5)}, table);
  add_rows({"other", "file.toml"}, {robot_known_from(last)}, table);
  const double shares[] = {0.4, 0.5, 0.6, 0.9};
  const Table shortest = shortest_cycles(table, shares);
  ASSERT_EQ(shortest.rows().size(), 2 * 2 * 4u) << "scenes, least and most, shares";
  for (std::size_t row = 0; row < 8; ++row) {
    EXPECT_EQ(shortest.text(row, "scene"), "scene");
    EXPECT_EQ(shortest.text(row, "sought"), row < 4 ? "least stressed" : "most stressed");
    EXPECT_EQ(shortest.number(row, "share found (1)"), shares[row % 4]);
    EXPECT_EQ(shortest.number(row, "shortest cycle (s)"), times[row % 4 < 2 ? 3 : 5]) << row;
  }
  for (std::size_t row = 8; row < 16; ++row) {
    EXPECT_EQ(shortest.text(row, "scene"), "other");
    EXPECT_TRUE(std::isnan(shortest.number(row, "shortest cycle (s)"))) << "the last finds itself";
  }
}

TEST(Overlap, TimesReachFarEnoughToTellWhenMostIsFound) {
  const std::vector<double> times = cycle_times();
  EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
  EXPECT_GE(std::count_if(times.begin(), times.end(), [](double time) { return time > 5 && time < 10; }), 2);
}

TEST(Overlap, TheSceneOfTheFirstIsThereWithStillMuscles) {
  const auto all = cases({"a/walk.toml", "swim.toml"});
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].scene, "walk");
  EXPECT_EQ(all[1].scene, "swim");
  EXPECT_EQ(all[2].scene, "walk, muscles still");
  EXPECT_EQ(all[2].experiment, "a/walk.toml");
  EXPECT_TRUE(all[2].muscles_still);
  EXPECT_THROW(cases({"a/evo.toml", "b/evo.toml"}), std::invalid_argument) << "scenes that could not be told apart";
}

TEST(Overlap, RandomRobotsGiveEveryTime) {
  const evodevo::testing::Scratch scratch;
  const std::string file = scratch.write("swim.toml", R"(
[experiment]
[encoding]
name = "neural"
points = 130
[[mutation]]
name = "reset-weight"
[scene.drag]
[[fitness]]
name = "distance"
[selection]
name = "elitist"
)");
  const auto robots = simulate({"swim", file}, 1, "cpu");
  ASSERT_EQ(robots.size(), 1u);
  ASSERT_EQ(robots[0].size(), cycle_times().size());
  for (const auto& stress : robots[0]) EXPECT_EQ(stress.size(), robots[0][0].size());
  EXPECT_GE(robots[0][0].size(), 1250u);
  EXPECT_NE(robots[0].front(), robots[0].back());
}

}  // namespace
}  // namespace evodevo::tools::stress::EVODEVO_FILE
