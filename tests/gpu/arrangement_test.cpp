// The arrangement of bodies on the chip.
#include "cuda/layout/arrangement.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "bodies.hpp"
#include "cuda/layout/row_order.hpp"

namespace evodevo::cuda {
namespace {

using testing_gpu::random_body;

/// Checks that every spring is in exactly one slot, which is in the lane of one of its ends and refers to the other
/// end, and that the rows of each warp belong to the groups listed for it.
void expect_sound(const Arrangement& a, const Body& body, unsigned largest_block) {
  ASSERT_LE(a.shape.block, largest_block);
  ASSERT_LE(a.shape.warps, a.shape.block);
  ASSERT_EQ(a.slots.size(), a.shape.slots());
  ASSERT_GE(32 * a.shape.block * a.shape.masses_per_thread, body.masses.size());
  std::vector<int> seen(body.springs.size()), terms(32 * a.groups);
  const std::size_t rows_of_warp = a.shape.chunks * a.shape.rows;
  std::uint32_t group = 0;
  for (std::size_t row = 0; row < a.slots.size() / 32; ++row) {
    if (row % rows_of_warp == 0) group = a.first_group[row / rows_of_warp];
    EXPECT_GE(row, a.first_row[group]);
    EXPECT_LT(row, a.first_row[group + 1]);
    for (std::uint32_t lane = 0; lane < 32; ++lane) {
      const Arrangement::Slot& slot = a.slots[32 * row + lane];
      const std::uint32_t owner = 32 * group + lane;
      ++terms[owner];
      if (slot.spring == Arrangement::none) {
        EXPECT_EQ(slot.other / 32, a.groups);
        continue;
      }
      ++seen[slot.spring];
      --terms[slot.other];
      EXPECT_EQ(a.slot_of[slot.spring], 32 * row + lane);
      const Spring& spring = body.springs[slot.spring];
      const std::set<std::uint32_t> ends{a.index_of[spring.a], a.index_of[spring.b]};
      EXPECT_EQ(ends, (std::set<std::uint32_t>{owner, slot.other}));
    }
    if (a.group_ends[row / a.shape.rows] >> row % a.shape.rows & 1) ++group;
  }
  EXPECT_EQ(seen, std::vector<int>(body.springs.size(), 1));
  for (std::size_t place = 0; place < terms.size(); ++place) EXPECT_EQ(terms[place], a.magic_numbers[place]) << place;
}

void expect_sound(const Body& body, unsigned largest_block) {
  expect_sound(Arrangement(body, largest_block), body, largest_block);
}

/// Removes `masses` random masses and `springs` random springs, and appends the same numbers of new ones, like the host
/// when it applies edits.
void turn_over(Body& body, std::uint32_t masses, std::uint32_t springs, std::mt19937& random) {
  const auto below = [&](std::size_t n) {
    return std::uniform_int_distribution<std::uint32_t>(0, static_cast<std::uint32_t>(n - 1))(random);
  };
  for (; springs > 0; --springs) {
    body.springs.erase(body.springs.begin() + below(body.springs.size()));
    const std::uint32_t a = below(body.masses.size());
    body.springs.push_back(
        {a, (a + 1 + below(body.masses.size() - 1)) % static_cast<std::uint32_t>(body.masses.size()), 0.5, 0});
  }
  for (; masses > 0; --masses) {
    const std::uint32_t gone = below(body.masses.size());
    std::erase_if(body.springs, [&](const Spring& s) { return s.a == gone || s.b == gone; });
    for (Spring& s : body.springs) s.a -= s.a > gone, s.b -= s.b > gone;
    body.masses.erase(body.masses.begin() + gone);
    body.masses.push_back({{random() * 1e-9, 0, 0}, 0.2});
    const auto newest = static_cast<std::uint32_t>(body.masses.size() - 1);
    for (std::uint32_t i = 0; i < 25; ++i) body.springs.push_back({40 * i % newest, newest, 0.5, 0});
  }
}

TEST(Rearrangement, StaysSoundAndKeepsBanksApartThroughALife) {
  Body body = random_body(1000, 25, 5);
  std::mt19937 random(1);
  Arrangement arrangement(body, 32);
  for (int cycle = 0; cycle < 10; ++cycle) {
    const Outline before(body);
    turn_over(body, 5, 125, random);
    arrangement = Arrangement(body, 32, arrangement, before);
    expect_sound(arrangement, body, 32);
  }
  EXPECT_LT(arrangement.wavefronts_per_row(), 1.25);
}

TEST(Rearrangement, KeepsWhatStays) {
  Body body = random_body(1000, 25, 5);
  const Arrangement before(body, 32);
  const Outline outline(body);
  body.springs.erase(body.springs.begin() + 100);
  const Arrangement after(body, 32, before, outline);
  EXPECT_EQ(after.index_of, before.index_of);
  std::size_t moved = 0;
  for (std::uint32_t i = 0; i < body.springs.size(); ++i) moved += after.slot_of[i] != before.slot_of[i + (i >= 100)];
  EXPECT_LT(moved, body.springs.size() / 10);
}

TEST(Rearrangement, HoldsBodiesThatHaveLittleInCommonWithBefore) {
  const Body body = random_body(1000, 25, 5);
  const Arrangement before(body, 32);
  const Outline outline(body);
  for (const Body& other : {random_body(1000, 25, 6), random_body(100, 25, 7), random_body(2000, 25, 8)})
    expect_sound(Arrangement(other, 32, before, outline), other, 32);
  Body larger = body;
  for (int i = 0; i < 100; ++i) larger.masses.push_back({{9, 9, 9.0 + i}, 0.2});
  expect_sound(Arrangement(larger, 32, before, outline), larger, 32);
  Body smaller = body;
  smaller.masses.resize(500);
  std::erase_if(smaller.springs, [](const Spring& s) { return s.a >= 500 || s.b >= 500; });
  expect_sound(Arrangement(smaller, 32, before, outline), smaller, 32);
}

TEST(Arrangement, HoldsEverySpringOnce) {
  for (const std::uint32_t masses : {1u, 2u, 31u, 32u, 33u, 200u, 1000u})
    for (const unsigned block : {16u, 32u}) expect_sound(random_body(masses, 25, masses), block);
}

TEST(Arrangement, HoldsLargeAndUnevenBodies) {
  expect_sound(random_body(3000, 25, 1), 32);
  Body star;
  star.materials = {{5000, 0, 0, 0}};
  for (std::uint32_t i = 0; i < 500; ++i) {
    star.masses.push_back({{}, 0.2});
    if (i > 0) star.springs.push_back({0, i, 1, 0});
  }
  expect_sound(star, 32);
  Body loose;
  loose.masses.resize(100);
  expect_sound(loose, 32);
}

TEST(Arrangement, KeepsBanksApart) {
  EXPECT_LT(Arrangement(random_body(1000, 25, 1), 32).wavefronts_per_row(), 1.05);
  EXPECT_LT(Arrangement(random_body(500, 25, 1), 32).wavefronts_per_row(), 1.2);
}

TEST(RowOrder, ColoursWhatCanBeColoured) {
  // every lane has one spring to every bank, so 32 rows suffice, each a permutation
  std::vector<Link> links;
  for (std::uint8_t lane = 0; lane < 32; ++lane)
    for (std::uint8_t bank = 0; bank < 32; ++bank)
      links.push_back({lane, static_cast<std::uint8_t>((5 * bank + lane) % 32)});
  choose_rows(links, 32);
  std::set<std::pair<std::uint32_t, int>> lanes, banks;
  for (const Link& link : links) {
    EXPECT_LT(link.row, 32u);
    lanes.emplace(link.row, link.lane);
    banks.emplace(link.row, link.bank);
  }
  EXPECT_EQ(lanes.size(), links.size());
  EXPECT_EQ(banks.size(), links.size());
}

}  // namespace
}  // namespace evodevo::cuda
