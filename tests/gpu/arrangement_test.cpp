// The layout of bodies on the chip.
#include "cuda/arrangement.hpp"

#include <gtest/gtest.h>

#include <set>

#include "bodies.hpp"
#include "cuda/row_order.hpp"

namespace evodevo::cuda {
namespace {

using testing_gpu::random_body;

/// Checks that every spring is in one slot, in the lane of one of its ends and leading to the other, and that the rows
/// of each warp belong to the groups that it is told.
void expect_sound(const Body& body, unsigned largest_block) {
  const Arrangement a(body, largest_block);
  ASSERT_LE(a.shape.warps, largest_block);
  ASSERT_EQ(a.slots.size(), a.shape.slots());
  ASSERT_GE(32 * a.shape.warps * a.shape.masses_per_thread, body.masses.size());
  std::vector<int> seen(body.springs.size()), terms(32 * a.groups);
  const std::size_t rows_of_warp = a.shape.chunks * a.shape.rows;
  std::uint32_t group = 0;
  for (std::size_t row = 0; row < a.slots.size() / 32; ++row) {
    if (row % rows_of_warp == 0) group = a.first_group[row / rows_of_warp];
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
      const std::set<std::uint32_t> ends{a.place_of[spring.a], a.place_of[spring.b]};
      EXPECT_EQ(ends, (std::set<std::uint32_t>{owner, slot.other}));
    }
    if (a.turns[row / a.shape.rows] >> row % a.shape.rows & 1) ++group;
  }
  EXPECT_EQ(seen, std::vector<int>(body.springs.size(), 1));
  for (std::size_t place = 0; place < terms.size(); ++place) EXPECT_EQ(terms[place], a.magic_numbers[place]) << place;
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
  EXPECT_LT(Arrangement(random_body(1000, 25, 1), 32).passes_per_row(), 1.05);
  EXPECT_LT(Arrangement(random_body(500, 25, 1), 32).passes_per_row(), 1.2);
}

TEST(RowOrder, ColoursWhatCanBeColoured) {
  // every lane has a spring to every bank: 32 rows, each a permutation
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
