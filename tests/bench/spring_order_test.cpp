// The orders of springs in which the paper's methods are measured, and the random permutations of Skip-Shift.
#include "paper/spring_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "common/bodies.hpp"
#include "paper/permutation.hpp"

namespace evodevo::tools::bench::EVODEVO_FILE {
namespace {

/// Returns the share of full warps in which no two springs share a mass.
double warps_without_conflict(const Body& body, const std::vector<std::uint32_t>& order) {
  std::size_t free = 0, warps = 0;
  for (std::size_t first = 0; first + 32 <= order.size(); first += 32, ++warps) {
    std::set<std::uint32_t> masses;
    for (std::size_t i = first; i < first + 32; ++i)
      masses.insert({body.springs[order[i]].a, body.springs[order[i]].b});
    free += masses.size() == 64;
  }
  return static_cast<double>(free) / static_cast<double>(warps);
}

TEST(SpringOrder, HoldsEachSpringOnceAndSortsByTheFirstMass) {
  Body body = random_ball(100);
  std::vector<std::uint32_t> all(body.springs.size());
  std::iota(all.begin(), all.end(), 0u);
  for (const SpringOrder order : spring_orders) {
    std::vector<std::uint32_t> springs = ordered_springs(body, order);
    EXPECT_EQ(springs == all, order == SpringOrder::as_built || order == SpringOrder::by_first_mass) << name(order);
    std::sort(springs.begin(), springs.end());
    EXPECT_EQ(springs, all) << name(order);
  }
  std::reverse(body.springs.begin(), body.springs.end());
  EXPECT_TRUE(std::ranges::is_sorted(ordered_springs(body, SpringOrder::by_first_mass), {},
                                     [&](std::uint32_t i) { return body.springs[i].a; }));
}

TEST(SpringOrder, SpreadsSpringsSoThatThoseOfAWarpShareNoMass) {
  const Body body = random_ball(1000);
  EXPECT_GT(warps_without_conflict(body, ordered_springs(body, SpringOrder::spread)), 0.95);
  EXPECT_LT(warps_without_conflict(body, ordered_springs(body, SpringOrder::shuffled)), 0.5);
}

constexpr std::uint32_t springs = 14230, groups = 256, tallies = 100 * groups;

TEST(Permutation, HoldsEachNumberOnce) {
  for (const std::uint32_t count : {1u, 2u, 3u, 31u, 256u, 257u, 1000u, springs}) {
    std::vector<int> seen(count);
    const Permutation order = shifted(count, 3, 7);
    for (std::uint32_t i = 0; i < count; ++i) {
      ASSERT_LT(order(i), count);
      ++seen[order(i)];
    }
    EXPECT_EQ(seen, std::vector<int>(count, 1)) << count;
  }
}

TEST(Permutation, GivesEveryPlaceEverySpring) {
  // expected chi-squared for 256 equally likely ranges: 255 +- 23
  std::vector<double> seen(groups);
  for (std::uint32_t tally = 1; tally <= tallies; ++tally)
    ++seen[std::uint64_t{shifted(springs, 0, tally)(5)} * groups / springs];
  const double expected = tallies / groups;
  double chi_squared = 0;
  for (const double count : seen) chi_squared += (count - expected) * (count - expected) / expected;
  EXPECT_LT(chi_squared, 255 + 6 * 23);
  EXPECT_GT(chi_squared, 255 - 6 * 23);
}

TEST(Permutation, PutsSpringsThatWereInOneGroupIntoOthers) {
  // springs whose positions in an order are equal modulo 256 share a group; for two given springs, the probability of
  // this is about 1/256
  int together = 0;
  for (std::uint32_t tally = 1; tally <= 500; ++tally) {
    const Permutation now = shifted(springs, 1, tally), next = shifted(springs, 1, tally + 1);
    std::vector<std::uint32_t> group(springs);
    for (std::uint32_t i = 0; i < springs; ++i) group[next(i)] = i % groups;
    // the 55 springs of the first group
    const std::uint32_t first = group[now(0)];
    for (std::uint32_t i = groups; i < 55 * groups; i += groups) together += group[now(i)] == first;
  }
  const double expected = 500 * 54.0 / groups;  // 105 +- 10
  EXPECT_NEAR(together, expected, 50);
}

}  // namespace
}  // namespace evodevo::tools::bench::EVODEVO_FILE
