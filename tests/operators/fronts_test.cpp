// NSGA-II, also on problems whose fronts are known (Zitzler, Deb and Thiele 2000).
#include <cmath>

#include "evodevo/helpers/selection/pareto.hpp"
#include "evolution.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

constexpr double pi = 3.14159265358979323846;

/// A problem of the ZDT family, whose objectives are to be minimised: the second is g h(f1, g), and g is 1 on the
/// front.
struct Problem {
  const char* name;
  double (*h)(double f, double g);

  Point objectives(const Genome& x) const {
    double sum = 0;
    for (std::size_t i = 1; i < x.size(); ++i) sum += x[i];
    const double g = 1 + 9 * sum / static_cast<double>(x.size() - 1);
    return {x[0], g * h(x[0], g)};
  }

  /// Points all over the front.
  std::vector<Point> front() const {
    std::vector<Point> candidates, front;
    for (int i = 0; i <= 1000; ++i) candidates.push_back({-i / 1000.0, -h(i / 1000.0, 1)});
    const auto layer = pareto_layers(candidates);  // parts of some curves are dominated
    for (std::size_t i = 0; i < candidates.size(); ++i)
      if (layer[i] == 0) front.push_back({-candidates[i][0], -candidates[i][1]});
    return front;
  }
};

/// Returns the mean distance from points to the nearest others.
double mean_distance(const std::vector<Point>& points, const std::vector<Point>& others) {
  double sum = 0;
  for (const Point& point : points) {
    double least = 1e300;
    for (const Point& other : others) least = std::min(least, std::hypot(point[0] - other[0], point[1] - other[1]));
    sum += least;
  }
  return sum / static_cast<double>(points.size());
}

TEST(Nsga2, FindsTheWholeFront) {
  const auto selection = make<Selection>("nsga2");
  const Problem problems[] = {
      {"ZDT1", [](double f, double g) { return 1 - std::sqrt(f / g); }},
      {"ZDT2", [](double f, double g) { return 1 - f * f / (g * g); }},
      {"ZDT3", [](double f, double g) { return 1 - std::sqrt(f / g) - f / g * std::sin(10 * pi * f); }}};
  for (const Problem& problem : problems) {
    const auto evaluate = [&](Individual& one) {
      for (const double objective : problem.objectives(one.genome)) one.scores.push_back(-objective);
    };
    Evolution evolution(*selection, real_genes(10, 0, 1), evaluate, 1);
    evolution.run(250, 100, 100);
    std::vector<Point> found;
    for (const Individual& one : evolution.table.rows) found.push_back(problem.objectives(one.genome));
    ASSERT_EQ(found.size(), 100u);
    EXPECT_LT(mean_distance(found, problem.front()), 0.01) << problem.name << ": not at the front";
    EXPECT_LT(mean_distance(problem.front(), found), 0.012) << problem.name << ": gaps";
  }
}

TEST(Nsga2, WholeLayersSurvive) {
  const auto selection = make<Selection>("nsga2");
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Rng rng = stream(seed);
    Table table;
    std::vector<Point> points;
    for (std::uint32_t i = 0; i < 60; ++i) {
      points.push_back({rng.uniform(), rng.uniform()});
      table.rows.push_back({.scores = points.back(), .id = i});
    }
    const auto layer = pareto_layers(points);
    const auto living = table.survivors(*selection, 30).rows;
    ASSERT_EQ(living.size(), 30u);
    std::uint32_t deepest = 0;
    for (const std::uint32_t row : living) deepest = std::max(deepest, layer[row]);
    for (std::uint32_t row = 0; row < 60; ++row)
      EXPECT_TRUE(layer[row] >= deepest || std::count(living.begin(), living.end(), row) == 1);
  }
}

/// Returns how often each row is a parent, relative to all couples that NSGA-II chooses with several seeds.
std::vector<double> shares(const Table& table) {
  const auto selection = make<Selection>("nsga2");
  constexpr int seeds = 400, couples = 40;
  std::vector<double> share(table.rows.size(), 0);
  for (std::uint64_t seed = 0; seed < seeds; ++seed)
    for (const auto& [parent, mate] : table.parents(*selection, couples, seed))
      share[parent] += 1.0 / (seeds * couples);
  return share;
}

TEST(Nsga2, ParentsAreOfBetterLayersOrLessCrowdedAndChanceDecidesAmongEquals) {
  // three rows on the front, of which 1 is the only crowded one, and a row behind it
  const auto share =
      shares({.rows = {{.scores = {0, 10}}, {.scores = {5, 5}}, {.scores = {10, 0}}, {.scores = {1, 1}}}});
  // the better of two draws is the i-th best of four in 7, 5, 3 and 1 of 16 cases
  EXPECT_NEAR(share[0] + share[2], 12 / 16.0, 0.5 / 16);
  EXPECT_NEAR(share[1], 3 / 16.0, 0.3 / 16);
  EXPECT_NEAR(share[3], 1 / 16.0, 0.2 / 16);
  // the ends of the front, which have the same room; that with the higher first score is no better
  const auto ends = shares({.rows = {{.scores = {0, 10}}, {.scores = {5, 5}}, {.scores = {10, 0}}}});
  // one of them wins 5 and the other 3 of the 9 draws of two
  EXPECT_NEAR(ends[0], 4 / 9.0, 0.03);
  EXPECT_NEAR(ends[2], 4 / 9.0, 0.03);
}

TEST(Nsga2, TheLeastInfeasibleBreedAndSurviveAmongTheFailed) {
  const auto share = shares({.rows = {{.violation = 3}, {.violation = 1}, {.violation = 2}}});
  // the better of two draws is the i-th best of three in 5, 3 and 1 of 9 cases
  EXPECT_NEAR(share[1], 5 / 9.0, 0.3 / 9);
  EXPECT_NEAR(share[2], 3 / 9.0, 0.3 / 9);
  EXPECT_NEAR(share[0], 1 / 9.0, 0.3 / 9);
  const Table table{.rows = {{.violation = 3}, {.violation = 1}, {.violation = 2}, {.scores = {1, 1}}}};
  EXPECT_THAT(table.survivors(*make<Selection>("nsga2"), 2).rows, ::testing::UnorderedElementsAre(3, 1));
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
