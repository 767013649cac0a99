// Ranks and their statistics, compared with known results.
#include "statistics.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

namespace evodevo::tools::accuracy::EVODEVO_FILE {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
using Values = std::vector<double>;

TEST(Ranks, AreSharedByEqualsAndLowestForWhatIsNoNumber) {
  EXPECT_EQ(ranks(Values{3, 1, 3, 2}), (Values{2.5, 0, 2.5, 1}));
  EXPECT_EQ(ranks(Values{-5, none, 0, none}), (Values{2, 0.5, 3, 0.5}));
}

TEST(RankCorrelation, IsThatOfSpearman) {
  EXPECT_DOUBLE_EQ(rank_correlation(Values{1, 2, 3, 4}, Values{10, 200, 300, 4e4}), 1);
  EXPECT_DOUBLE_EQ(rank_correlation(Values{1, 2, 3, 4}, Values{4, 3, 2, 1}), -1);
  // 1 - 6 sum(d^2)/(n (n^2 - 1)), where the values of d^2 are 1, 1, 1, 1, 0
  EXPECT_DOUBLE_EQ(rank_correlation(Values{1, 2, 3, 4, 5}, Values{2, 1, 4, 3, 5}), 1 - 6 * 4.0 / (5 * 24));
  EXPECT_EQ(rank_correlation(Values{1, 2, 3}, Values{none, none, none}), 0) << "they tell nothing";
}

TEST(BootstrapInterval, HoldsTheCorrelationAndIsNarrowerForMore) {
  const auto interval_of = [](int n) {
    Values a, b;
    for (int i = 0; i < n; ++i) a.push_back(i), b.push_back(i + (i % 7) * n / 10.0);
    const Interval interval = bootstrap_interval(a, b, 400);
    EXPECT_LT(interval.low, rank_correlation(a, b));
    EXPECT_GT(interval.high, rank_correlation(a, b));
    return interval.high - interval.low;
  };
  // the width of an interval is inversely proportional to the square root of the number of values
  const double ratio = interval_of(30) / interval_of(480);
  EXPECT_GT(ratio, 2);
  EXPECT_LT(ratio, 8);
}

TEST(BootstrapInterval, OfAPerfectRankingIsAPoint) {
  const Values a{1, 2, 3, 4, 5, 6, 7, 8, 9};
  const Interval interval = bootstrap_interval(a, a, 100);
  EXPECT_DOUBLE_EQ(interval.low, 1);
  EXPECT_DOUBLE_EQ(interval.high, 1);
}

TEST(BestFound, IsCertainForTheTruthImpossibleForItsOppositeAndChanceForWhatTellsNothing) {
  Values truth(40), opposite(40);
  std::iota(truth.begin(), truth.end(), 0);
  std::iota(opposite.rbegin(), opposite.rend(), 0);
  EXPECT_EQ(best_found(truth, truth, 20, 3, 500), 1);
  EXPECT_EQ(best_found(truth, opposite, 20, 3, 500), 0);
  EXPECT_NEAR(best_found(truth, Values(40, none), 20, 3, 20000), 3.0 / 20, 0.01);
}

}  // namespace
}  // namespace evodevo::tools::accuracy::EVODEVO_FILE
