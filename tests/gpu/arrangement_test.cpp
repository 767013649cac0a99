// The arrangement of bodies on the chip.
#include "cuda/layout/arrangement/arrangement.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <random>
#include <set>

#include "bodies.hpp"
#include "cuda/layout/arrangement/partition.hpp"
#include "cuda/layout/arrangement/row_order.hpp"

namespace evodevo::cuda::EVODEVO_FILE {
namespace {

using testing_gpu::random_body;

/// Checks that every spring is in exactly one slot, which is in the lane of one of its ends and refers to the other
/// end, and that the rows of each warp belong to the groups listed for it.
void expect_sound(const Arrangement& a, const Outline& outline, unsigned largest_block) {
  const std::size_t inside = outline.ends.size(), springs = inside + outline.cut.size();
  ASSERT_LE(a.shape.block, largest_block);
  ASSERT_LE(a.shape.warps + a.shape.cut_warps, a.shape.block);
  ASSERT_EQ(a.slots.size(), a.shape.slots());
  ASSERT_GE(32 * a.shape.block * a.shape.masses_per_thread, outline.rest.size());
  std::vector<int> seen(springs), terms(32 * a.groups);
  std::uint32_t group = 0;
  for (std::size_t row = 0; row < a.slots.size() / 32; ++row) {
    const bool cut = row >= a.shape.rows_inside();
    const std::size_t rows = cut ? a.shape.cut_rows : a.shape.rows, of_kind = row - (cut ? a.shape.rows_inside() : 0);
    const std::size_t rows_of_warp = a.shape.chunks * rows, first_warp = cut ? a.shape.warps : 0;
    if (of_kind % rows_of_warp == 0) group = a.first_group[first_warp + of_kind / rows_of_warp];
    ASSERT_LT(group, a.groups);
    for (std::uint32_t lane = 0; lane < 32; ++lane) {
      const Arrangement::Slot& slot = a.slots[32 * row + lane];
      const std::uint32_t owner = 32 * group + lane;
      ++terms[owner];
      if (slot.spring == Arrangement::none) {
        EXPECT_EQ(slot.other / 32, cut ? a.first_of_halo() / 32 : a.groups);
        EXPECT_TRUE(!cut || a.halo_groups > 0) << "it is read";
        continue;
      }
      ASSERT_LT(slot.spring, springs);
      ++seen[slot.spring];
      EXPECT_EQ(a.slot_of[slot.spring], 32 * row + lane);
      EXPECT_EQ(cut, slot.spring >= inside);
      if (cut) {
        const auto& [mass, other] = outline.cut[slot.spring - inside];
        EXPECT_EQ(a.index_of[mass], owner);
        EXPECT_EQ(a.index_of[outline.rest.size() + other], slot.other);
        EXPECT_GE(slot.other, a.first_of_halo());
        EXPECT_LT(slot.other, a.first_of_halo() + 32 * a.halo_groups);
      } else {
        --terms[slot.other];
        const auto& [first, second] = outline.ends[slot.spring];
        const std::set<std::uint32_t> ends{a.index_of[first], a.index_of[second]};
        EXPECT_EQ(ends, (std::set<std::uint32_t>{owner, slot.other}));
      }
    }
    if (a.group_ends[first_warp * a.shape.chunks + of_kind / rows] >> of_kind % rows & 1) ++group;
  }
  // the kernel ends a warp's work with the last mark
  for (unsigned warp = 0; a.shape.chunks == 1 && warp < a.shape.warps + a.shape.cut_warps; ++warp) {
    const unsigned rows = warp < a.shape.warps ? a.shape.rows : a.shape.cut_rows;
    EXPECT_EQ(static_cast<unsigned>(std::bit_width(a.group_ends[warp])), rows) << warp;
  }
  EXPECT_EQ(seen, std::vector<int>(springs, 1));
  for (std::size_t place = 0; place < terms.size(); ++place) EXPECT_EQ(terms[place], a.magic_numbers[place]) << place;
  EXPECT_EQ(std::set(a.index_of.begin(), a.index_of.end()).size(), outline.rest.size() + outline.halo);
}

void expect_sound(const Body& body, unsigned largest_block) {
  expect_sound(Arrangement(Outline(body), largest_block), Outline(body), largest_block);
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
  Arrangement arrangement(Outline(body), 32);
  for (int cycle = 0; cycle < 10; ++cycle) {
    const Outline before(body);
    turn_over(body, 5, 125, random);
    arrangement = Arrangement(Outline(body), 32, arrangement, before);
    expect_sound(arrangement, Outline(body), 32);
  }
  EXPECT_LT(arrangement.wavefronts_per_row(), 1.25);
}

TEST(Rearrangement, KeepsWhatStays) {
  Body body = random_body(1000, 25, 5);
  const Outline outline(body);
  const Arrangement before(outline, 32);
  body.springs.erase(body.springs.begin() + 100);
  const Arrangement after(Outline(body), 32, before, outline);
  EXPECT_EQ(after.index_of, before.index_of);
  std::size_t moved = 0;
  for (std::uint32_t i = 0; i < body.springs.size(); ++i) moved += after.slot_of[i] != before.slot_of[i + (i >= 100)];
  EXPECT_LT(moved, body.springs.size() / 10);
}

TEST(Rearrangement, HoldsBodiesThatHaveLittleInCommonWithBefore) {
  const Body body = random_body(1000, 25, 5);
  const Outline outline(body);
  const Arrangement before(outline, 32);
  Body larger = body, smaller = body;
  for (int i = 0; i < 100; ++i) larger.masses.push_back({{9, 9, 9.0 + i}, 0.2});
  smaller.masses.resize(500);
  std::erase_if(smaller.springs, [](const Spring& s) { return s.a >= 500 || s.b >= 500; });
  for (const Body& other :
       {random_body(1000, 25, 6), random_body(100, 25, 7), random_body(2000, 25, 8), larger, smaller})
    expect_sound(Arrangement(Outline(other), 32, before, outline), Outline(other), 32);
}

TEST(Arrangement, HoldsEverySpringOnce) {
  for (const std::uint32_t masses : {1u, 2u, 31u, 32u, 33u, 64u, 200u, 1000u}) {
    const Body body = random_body(masses, 25, masses);
    for (const unsigned block : {16u, 32u}) expect_sound(body, block);
    for (const unsigned at_once : {1u, 3u})
      expect_sound(Arrangement(Outline(body), {32, at_once, 200}), Outline(body), 32);
  }
}

TEST(Arrangement, SpreadsASmallBodyOverMoreWarpsTheFewerBodiesThereAre) {
  const Outline outline(random_body(64, 25, 1));
  const auto warps = [&](unsigned at_once) { return Arrangement(outline, {32, at_once}).shape.warps; };
  EXPECT_GT(warps(1), warps(4));
  EXPECT_GT(warps(4), warps(Target::many));
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

/// Checks the parts of a body, and returns how many of them have no cut springs.
std::size_t expect_sound_parts(const Body& body, unsigned count) {
  const std::vector<Part> parts = partition(Outline(body), count);
  std::vector<const Outline*> outlines;
  for (const Part& part : parts) outlines.push_back(&part.outline);
  const std::vector<Arrangement> arrangements = Arrangement::of_parts(outlines, 32);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    EXPECT_EQ(arrangements[p].shape, arrangements[0].shape) << "one kernel simulates all parts";
    expect_sound(arrangements[p], parts[p].outline, 32);
  }
  return std::ranges::count_if(parts, [](const Part& part) { return part.outline.cut.empty(); });
}

TEST(Arrangement, HoldsTheCutSpringsOfParts) {
  for (const std::uint32_t masses : {100u, 1000u, 9000u})
    EXPECT_EQ(expect_sound_parts(random_body(masses, 25, 2), masses < 1000 ? 2 : 4), 0u);
  EXPECT_EQ(expect_sound_parts(testing_gpu::body_in_pieces(random_body(200, 10, 3)), 3), 1u) << "one beside others";
}

TEST(Arrangement, SkipsGroupsWithoutSprings) {
  // the masses of the middle group lose their springs, but keep their indices
  Body body = random_body(96, 10, 2);
  const Outline before(body);
  const Arrangement earlier(before, 32);
  std::erase_if(body.springs, [&](const Spring& spring) {
    return earlier.index_of[spring.a] / 32 == 1 || earlier.index_of[spring.b] / 32 == 1;
  });
  expect_sound(Arrangement(Outline(body), 32, earlier, before), Outline(body), 32);
}

TEST(Arrangement, KeepsBanksApart) {
  EXPECT_LT(Arrangement(Outline(random_body(1000, 25, 1)), 32).wavefronts_per_row(), 1.05);
  EXPECT_LT(Arrangement(Outline(random_body(500, 25, 1)), 32).wavefronts_per_row(), 1.2);
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
}  // namespace evodevo::cuda::EVODEVO_FILE
