// Lexicase selection, compared with its exact probabilities.
#include "evodevo/helpers/selection/lexicase.hpp"

#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

using Table = std::vector<std::vector<double>>;

std::vector<CaseScores> spans(const Table& table) { return {table.begin(), table.end()}; }

/// Returns the probability of each individual, by enumerating all orders of the cases.
std::vector<double> probabilities(const Table& table, const std::vector<double>& tolerance) {
  std::vector<std::size_t> order(tolerance.size());
  std::iota(order.begin(), order.end(), 0u);
  std::vector<double> chance(table.size(), 0);
  double orders = 0;
  do {
    ++orders;
    std::vector<std::size_t> left(table.size());
    std::iota(left.begin(), left.end(), 0u);
    for (const std::size_t test : order) {
      double best = -1e300;
      for (const std::size_t i : left) best = std::max(best, table[i][test]);
      std::vector<std::size_t> stay;
      for (const std::size_t i : left)
        if (table[i][test] >= best - tolerance[test]) stay.push_back(i);
      left = stay;
    }
    for (const std::size_t i : left) chance[i] += 1.0 / static_cast<double>(left.size());
  } while (std::next_permutation(order.begin(), order.end()));
  for (double& one : chance) one /= orders;
  return chance;
}

void expect_probabilities(const Table& table, const std::vector<double>& tolerance) {
  const auto expected = probabilities(table, tolerance);
  const int draws = 40000;
  std::vector<double> share(table.size(), 0);
  Rng rng = stream(7);
  const auto individuals = spans(table);
  for (int i = 0; i < draws; ++i) share[draw_lexicase(individuals, tolerance, rng)] += 1.0 / draws;
  // five standard deviations of a binomial share
  for (std::size_t i = 0; i < table.size(); ++i) EXPECT_NEAR(share[i], expected[i], 5 * 0.5 / std::sqrt(draws)) << i;
}

TEST(Lexicase, DrawsWithItsExactProbabilities) {
  // the first is best in no case; the second in one, the third in two, the fourth ties with the third in one
  expect_probabilities({{2, 2, 2}, {9, 0, 0}, {0, 8, 9}, {1, 8, 0}}, {0, 0, 0});
  expect_probabilities(Table(4), {});
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    Rng rng = stream(seed);
    Table table(6, std::vector<double>(4));
    for (auto& scores : table)
      for (double& score : scores) score = rng.below(4);
    expect_probabilities(table, {0, 0, 0, 0});
    expect_probabilities(table, {1, 0, 2, 0.5});
  }
}

TEST(MedianDeviations, AreThoseOfEachCaseFromTheMiddle) {
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 3, 2}), 2.5);
  EXPECT_EQ(median({7}), 7);
  EXPECT_EQ(median({1e308, 1.5e308}), 1.25e308);
  const Table table{{1, 5}, {2, 5}, {3, 5}, {4, 5}, {100, 5}};
  EXPECT_EQ(median_deviations(spans(table)), (std::vector<double>{1, 0}));
  EXPECT_TRUE(median_deviations({}).empty());
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
