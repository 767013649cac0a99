// NSGA-II on problems whose fronts are known (Zitzler, Deb and Thiele 2000; Deb, Thiele, Laumanns and Zitzler 2005).
#include <cmath>
#include <set>

#include "evodevo/helpers/pareto.hpp"
#include "evolution.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

constexpr double pi = 3.14159265358979323846;

/// A problem with objectives to be minimised, and points all over its front.
struct Problem {
  const char* name;
  std::uint32_t genes;
  std::function<Point(const Genome&)> objectives;
  std::vector<Point> front;
};

/// ZDT6: the points of its front are spread unevenly, and are rarer the nearer they are to it.
Problem zdt6() {
  const auto first = [](double x) { return 1 - std::exp(-4 * x) * std::pow(std::sin(6 * pi * x), 6); };
  const auto objectives = [first](const Genome& x) {
    double sum = 0;
    for (std::size_t i = 1; i < x.size(); ++i) sum += x[i];
    const double g = 1 + 9 * std::pow(sum / static_cast<double>(x.size() - 1), 0.25), f = first(x[0]);
    return Point{f, g - f * f / g};
  };
  double least = 1;
  for (int i = 0; i <= 10'000; ++i) least = std::min(least, first(i / 10'000.0));
  std::vector<Point> front;
  for (int i = 0; i <= 1000; ++i) {
    const double f = least + (1 - least) * i / 1000;
    front.push_back({f, 1 - f * f});
  }
  return {"ZDT6", 10, objectives, front};
}

/// The front of DTLZ1 is a triangle, on which the objectives sum to 0.5. There are many local fronts before it.
Problem dtlz1() {
  const auto on_triangle = [](double a, double b) { return Point{a * b / 2, a * (1 - b) / 2, (1 - a) / 2}; };
  const auto objectives = [on_triangle](const Genome& x) {
    double g = static_cast<double>(x.size() - 2);
    for (std::size_t i = 2; i < x.size(); ++i) g += (x[i] - 0.5) * (x[i] - 0.5) - std::cos(20 * pi * (x[i] - 0.5));
    Point point = on_triangle(x[0], x[1]);
    for (double& one : point) one *= 1 + 100 * g;
    return point;
  };
  std::vector<Point> front;
  for (int i = 0; i <= 12; ++i)
    for (int j = 0; i + j <= 12; ++j) front.push_back({i / 24.0, j / 24.0, (12 - i - j) / 24.0});
  return {"DTLZ1", 7, objectives, front};
}

/// A problem of the ZDT family: the second objective is g h(f1, g), and g is 1 on the front.
Problem zdt(const char* name, double (*h)(double f, double g)) {
  const auto objectives = [h](const Genome& x) {
    double sum = 0;
    for (std::size_t i = 1; i < x.size(); ++i) sum += x[i];
    const double g = 1 + 9 * sum / static_cast<double>(x.size() - 1);
    return Point{x[0], g * h(x[0], g)};
  };
  std::vector<Point> candidates, front;
  for (int i = 0; i <= 1000; ++i) candidates.push_back({-i / 1000.0, -h(i / 1000.0, 1)});
  const auto layer = pareto_layers(candidates);  // parts of some curves are dominated
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (layer[i] == 0) front.push_back({-candidates[i][0], -candidates[i][1]});
  return {name, 10, objectives, front};
}

/// The front of DTLZ2 is the part of the unit sphere in which no coordinate is negative.
Problem dtlz2() {
  const auto on_sphere = [](double a, double b) {
    return Point{std::cos(a) * std::cos(b), std::cos(a) * std::sin(b), std::sin(a)};
  };
  const auto objectives = [on_sphere](const Genome& x) {
    double g = 0;
    for (std::size_t i = 2; i < x.size(); ++i) g += (x[i] - 0.5) * (x[i] - 0.5);
    Point point = on_sphere(x[0] * pi / 2, x[1] * pi / 2);
    for (double& one : point) one *= 1 + g;
    return point;
  };
  std::vector<Point> front;
  for (int i = 0; i <= 12; ++i)
    for (int j = 0; j <= 12; ++j) front.push_back(on_sphere(i * pi / 24, j * pi / 24));
  return {"DTLZ2", 8, objectives, front};
}

double distance(const Point& a, const Point& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

/// Returns the mean distance from points to the nearest others.
double mean_distance(const std::vector<Point>& points, const std::vector<Point>& others) {
  double sum = 0;
  for (const Point& point : points) {
    double least = 1e300;
    for (const Point& other : others) least = std::min(least, distance(point, other));
    sum += least;
  }
  return sum / static_cast<double>(points.size());
}

std::vector<Point> evolved(const Selection& selection, const Problem& problem, int generations) {
  Evolution evolution(
      selection, real_genes(problem.genes, 0, 1),
      [&](Individual& one) {
        for (const double objective : problem.objectives(one.genome)) one.scores.push_back(-objective);
      },
      1);
  evolution.run(generations, 100, 100);
  std::vector<Point> points;
  for (const Individual& one : evolution.table.rows) points.push_back(problem.objectives(one.genome));
  return points;
}

TEST(Nsga2, FindsTheWholeFront) {
  const auto selection = make<Selection>("nsga2");
  const Problem problems[] = {
      zdt("ZDT1", [](double f, double g) { return 1 - std::sqrt(f / g); }),
      zdt("ZDT2", [](double f, double g) { return 1 - f * f / (g * g); }),
      zdt("ZDT3", [](double f, double g) { return 1 - std::sqrt(f / g) - f / g * std::sin(10 * pi * f); }),
      zdt6(),
      dtlz1(),
      dtlz2()};
  for (const Problem& problem : problems) {
    const auto found = evolved(*selection, problem, 250);
    ASSERT_EQ(found.size(), 100u);
    const bool is_surface = problem.front[0].size() == 3;  // its points are farther apart
    EXPECT_LT(mean_distance(found, problem.front), is_surface ? 0.06 : 0.01) << problem.name << ": not at the front";
    EXPECT_LT(mean_distance(problem.front, found), is_surface ? 0.12 : 0.012) << problem.name << ": gaps";
  }
}

std::vector<Individual> random_individuals(std::uint64_t seed, std::size_t count) {
  Rng rng = stream(seed);
  std::vector<Individual> rows(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    rows[i].id = i;
    rows[i].scores = {rng.uniform(), rng.uniform()};
  }
  return rows;
}

/// Returns each row's layer: how long the longest chain of rows is of which each dominates the next, up to it. It takes
/// steps that grow with the third power of the number of rows.
std::vector<std::uint32_t> layers_by_chains(const std::vector<Individual>& rows) {
  std::vector<std::uint32_t> layer(rows.size(), 0);
  for (std::size_t round = 0; round < rows.size(); ++round)
    for (std::size_t i = 0; i < rows.size(); ++i)
      for (std::size_t j = 0; j < rows.size(); ++j)
        if (dominates(rows[j].scores, rows[i].scores)) layer[i] = std::max(layer[i], layer[j] + 1);
  return layer;
}

TEST(Nsga2, WholeLayersSurvive) {
  const auto selection = make<Selection>("nsga2");
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Table table{.rows = random_individuals(seed, 60)};
    const auto layer = layers_by_chains(table.rows);
    const auto living = table.survive(*selection, 30).rows;
    ASSERT_EQ(living.size(), 30u);
    std::uint32_t deepest = 0;
    for (const std::uint32_t row : living) deepest = std::max(deepest, layer[row]);
    for (std::uint32_t row = 0; row < 60; ++row)
      EXPECT_TRUE(layer[row] >= deepest || std::count(living.begin(), living.end(), row) == 1);
  }
}

TEST(Nsga2, ParentsAreOfBetterLayersOrLessCrowded) {
  const auto selection = make<Selection>("nsga2");
  // three rows on the front, of which 1 is the only crowded one, and a row behind it
  const Table table{.rows = {{.scores = {0, 10}}, {.scores = {5, 5}}, {.scores = {10, 0}}, {.scores = {1, 1}}}};
  std::vector<double> share(4, 0);
  for (const auto& [parent, mate] : table.couples(*selection, 16000)) share[parent] += 16.0 / 16000;
  // the better of two draws is the i-th best of four in 7, 5, 3 and 1 of 16 cases
  EXPECT_NEAR(share[0] + share[2], 12, 0.5);
  EXPECT_NEAR(share[1], 3, 0.3);
  EXPECT_NEAR(share[3], 1, 0.2);
}

TEST(Nsga2, ChanceDecidesAmongEquals) {
  const auto selection = make<Selection>("nsga2");
  // the ends of the front, which have the same room; that with the higher first score is no better
  const Table table{.rows = {{.scores = {0, 10}}, {.scores = {5, 5}}, {.scores = {10, 0}}}};
  double ends[2] = {0, 0};
  const int seeds = 400, couples = 40;
  for (std::uint64_t seed = 0; seed < seeds; ++seed)
    for (const auto& [parent, mate] : table.couples(*selection, couples, seed))
      if (parent != 1) ends[parent / 2] += 1.0 / (seeds * couples);
  // one of them wins 5 and the other 3 of the 9 draws of two
  EXPECT_NEAR(ends[0], 4 / 9.0, 0.03);
  EXPECT_NEAR(ends[1], 4 / 9.0, 0.03);
}

TEST(Nsga2, TheLeastInfeasibleBreedAmongTheFailed) {
  const auto selection = make<Selection>("nsga2");
  const Table table{.rows = {{.violation = 3}, {.violation = 1}, {.violation = 2}}};
  std::vector<double> share(3, 0);
  const int seeds = 200, couples = 40;
  for (std::uint64_t seed = 0; seed < seeds; ++seed)
    for (const auto& [parent, mate] : table.couples(*selection, couples, seed))
      share[parent] += 9.0 / (seeds * couples);
  // the better of two draws is the i-th best of three in 5, 3 and 1 of 9 cases
  EXPECT_NEAR(share[1], 5, 0.3);
  EXPECT_NEAR(share[2], 3, 0.3);
  EXPECT_NEAR(share[0], 1, 0.3);
}

TEST(Nsga2, TheLeastInfeasibleSurviveAmongTheFailed) {
  const auto selection = make<Selection>("nsga2");
  Table table{.rows = {{.violation = 3}, {.violation = 1}, {.violation = 2}, {.scores = {1, 1}}}};
  EXPECT_THAT(table.survive(*selection, 2).rows, ::testing::UnorderedElementsAre(3, 1));
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
