// The orders of springs in which the paper's methods are measured.
#include "paper/spring_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "common/bodies.hpp"

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

TEST(SpringOrder, HoldsEachSpringOnce) {
  const Body body = random_ball(100);
  std::vector<std::uint32_t> all(body.springs.size());
  std::iota(all.begin(), all.end(), 0u);
  for (const SpringOrder order : spring_orders) {
    std::vector<std::uint32_t> springs = ordered_springs(body, order);
    EXPECT_EQ(springs == all, order == SpringOrder::as_built || order == SpringOrder::by_first_mass) << name(order);
    std::sort(springs.begin(), springs.end());
    EXPECT_EQ(springs, all) << name(order);
  }
}

TEST(SpringOrder, SortsByTheFirstMass) {
  Body body = random_ball(100);
  std::reverse(body.springs.begin(), body.springs.end());
  const std::vector<std::uint32_t> springs = ordered_springs(body, SpringOrder::by_first_mass);
  EXPECT_TRUE(std::is_sorted(springs.begin(), springs.end(),
                             [&](std::uint32_t i, std::uint32_t j) { return body.springs[i].a < body.springs[j].a; }));
}

TEST(SpringOrder, SpreadsSpringsSoThatThoseOfAWarpShareNoMass) {
  const Body body = random_ball(1000);
  EXPECT_GT(warps_without_conflict(body, ordered_springs(body, SpringOrder::spread)), 0.95);
  EXPECT_LT(warps_without_conflict(body, ordered_springs(body, SpringOrder::shuffled)), 0.5);
}

}  // namespace
}  // namespace evodevo::tools::bench::EVODEVO_FILE
