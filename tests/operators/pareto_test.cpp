// The helpers for selection operators, compared with direct implementations of their definitions.
#include "evodevo/helpers/selection/pareto.hpp"

#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// Random points with many ties; about one in seven has failed.
std::vector<Point> random_points(std::uint64_t seed, std::size_t count, std::size_t objectives) {
  Rng rng = stream(seed);
  std::vector<Point> points(count);
  for (Point& point : points)
    if (!rng.chance(0.15))
      for (std::size_t o = 0; o < objectives; ++o) point.push_back(rng.below(8));
  return points;
}

/// Computes layers by removing one front after the other.
std::vector<std::uint32_t> peel(const std::vector<Point>& points) {
  constexpr std::uint32_t none = 1000000;
  std::vector<std::uint32_t> layer(points.size(), none);
  for (std::uint32_t depth = 0; std::count(layer.begin(), layer.end(), none) > 0; ++depth) {
    const auto before = layer;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (before[i] != none) continue;
      bool beaten = false;
      for (std::size_t j = 0; j < points.size(); ++j) beaten |= before[j] == none && dominates(points[j], points[i]);
      if (!beaten) layer[i] = depth;
    }
  }
  return layer;
}

TEST(Dominance, NeedsNoWorseAnywhereAndBetterSomewhereUnlessTheOtherFailed) {
  EXPECT_TRUE(dominates({2, 1}, {1, 1}));
  EXPECT_FALSE(dominates({1, 1}, {1, 1}));
  EXPECT_FALSE(dominates({2, 0}, {1, 1}));
  EXPECT_FALSE(dominates({1, 1}, {2, 0}));
  EXPECT_TRUE(dominates({-1e300, -1e300}, {}));
  EXPECT_FALSE(dominates({}, {-1e300, -1e300}));
  EXPECT_FALSE(dominates({}, {}));
}

TEST(ParetoLayersOf, PointsAreThoseOfPeelingFronts) {
  for (std::uint64_t seed = 0; seed < 40; ++seed)
    for (const std::size_t objectives : {1, 2, 3}) {
      const auto points = random_points(seed, 60, objectives);
      EXPECT_EQ(pareto_layers(points), peel(points)) << "seed " << seed << ", objectives " << objectives;
    }
  EXPECT_TRUE(pareto_layers({}).empty());
  EXPECT_EQ(pareto_layers({{}, {}}), (std::vector<std::uint32_t>{0, 0}));
}

TEST(Youth, IsTheLastObjective) {
  const std::vector<double> scores{3, 4};
  const std::vector<Candidate> rows{{scores, 7, {}}, {{}, 2, {}}};
  EXPECT_EQ(scores_and_youth(rows), (std::vector<Point>{{3, 4, -7}, {}}));
}

/// Selects the least crowded points; recomputes crowding distances after each removal.
std::vector<std::uint32_t> thin(const std::vector<Point>& points, std::vector<std::uint32_t> members,
                                std::size_t count) {
  while (members.size() > count) {
    std::vector<double> room(members.size(), 0);
    for (std::size_t o = 0; o < points[0].size(); ++o) {
      auto order = members;
      std::sort(order.begin(), order.end(), [&](auto a, auto b) { return points[a][o] < points[b][o]; });
      const double range = points[order.back()][o] - points[order.front()][o];
      for (std::size_t i = 0; i < members.size(); ++i) {
        const auto at = std::find(order.begin(), order.end(), members[i]);
        if (at == order.begin() || at + 1 == order.end())
          room[i] = std::numeric_limits<double>::infinity();
        else
          room[i] += (points[*(at + 1)][o] - points[*(at - 1)][o]) / range;
      }
    }
    std::size_t most_crowded = 0;
    for (std::size_t i = 0; i < room.size(); ++i)
      if (room[i] <= room[most_crowded]) most_crowded = i;
    members.erase(members.begin() + static_cast<std::ptrdiff_t>(most_crowded));
  }
  return members;
}

TEST(LeastCrowded, AreThoseThatStayWhenTheMostCrowdedGoOneByOne) {
  for (std::uint64_t seed = 0; seed < 20; ++seed)
    for (const std::size_t objectives : {2, 3}) {
      Rng rng = stream(seed);
      std::vector<Point> points(50);
      for (Point& point : points)
        for (std::size_t o = 0; o < objectives; ++o) point.push_back(rng.uniform());
      std::vector<std::uint32_t> members;
      for (std::uint32_t i = 0; i < 50; i += 1 + rng.below(2)) members.push_back(i);
      for (const std::size_t count : {0, 1, 3, 10, 20})
        EXPECT_EQ(least_crowded(points, members, count), thin(points, members, count)) << seed;
    }
}

TEST(LeastCrowded, CopiesGoFirstAndTheLastOfEqualsGoes) {
  const std::vector<Point> points{{1, 3}, {2, 2}, {2, 2}, {2, 2}, {3, 1}};
  EXPECT_THAT(least_crowded(points, {0, 1, 2, 3, 4}, 3), ::testing::IsSupersetOf({0, 4}));
  EXPECT_THAT(least_crowded(points, {0, 1, 2, 3, 4}, 9), ::testing::SizeIs(5));
  for (const Point& point : {Point{1, 1}, Point{}})
    EXPECT_THAT(least_crowded(std::vector(4, point), {0, 1, 2, 3}, 2), ::testing::ElementsAre(0, 1));
}

TEST(LeastCrowded, BearsTheGreatestNumbers) {
  const std::vector<Point> points{{-1e308, 3}, {0, 2}, {1e307, 1}, {1e308, 0}};
  EXPECT_THAT(least_crowded(points, {0, 1, 2, 3}, 3), ::testing::ElementsAre(0, 1, 3));
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
