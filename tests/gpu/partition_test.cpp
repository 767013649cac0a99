// The parts into which a body is divided for the blocks of a cluster.
#include "cuda/layout/arrangement/partition.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "bodies.hpp"
#include "cuda/layout/arrangement/arranged_body.hpp"

namespace evodevo::cuda::EVODEVO_FILE {
namespace {

using testing_gpu::random_body;
constexpr auto keep = ArrangedBody::Keep::all;

TEST(Partition, HoldsEveryMassOnceAndEverySpringOnceOrCut) {
  const Outline body(random_body(500, 20, 3));
  for (const unsigned count : {1u, 2u, 3u, 5u, 16u}) {
    const std::vector<Part> parts = partition(body, count);
    ASSERT_EQ(parts.size(), count);
    std::vector<int> masses(500);
    std::map<std::uint32_t, std::vector<std::set<std::uint32_t>>> springs;  // the ends that each part knows
    for (const Part& part : parts) {
      const Outline& outline = part.outline;
      ASSERT_EQ(part.masses.size(), outline.rest.size() + outline.halo);
      ASSERT_EQ(part.springs.size(), outline.ends.size() + outline.cut.size());
      for (std::size_t i = 0; i < outline.rest.size(); ++i) {
        ++masses[part.masses[i]];
        EXPECT_EQ(outline.rest[i], body.rest[part.masses[i]]);
      }
      for (std::size_t i = 0; i < part.springs.size(); ++i) {
        const bool cut = i >= outline.ends.size();
        const auto [a, b] = cut ? outline.cut[i - outline.ends.size()] : outline.ends[i];
        const std::size_t at = cut ? outline.rest.size() + b : b;
        springs[part.springs[i]].push_back({part.masses[a], part.masses[at]});
        if (cut) springs[part.springs[i]].push_back({});  // one half
      }
    }
    EXPECT_EQ(masses, std::vector<int>(500, 1));
    ASSERT_EQ(springs.size(), body.ends.size());
    for (const auto& [spring, ends] : springs) {
      const std::set<std::uint32_t> expected{body.ends[spring].first, body.ends[spring].second};
      const auto found = static_cast<std::size_t>(std::ranges::count(ends, expected));
      EXPECT_TRUE(ends.size() == 1 ? found == 1 : ends.size() == 4 && found == 2) << spring;
    }
  }
}

TEST(Partition, CutsFewSpringsAndSharesThemEvenly) {
  const Outline body(random_body(4000, 25, 3));
  const std::vector<Part> parts = partition(body, 4);
  for (const Part& part : parts) {
    const std::size_t inside = part.outline.ends.size(), cut = part.outline.cut.size();
    EXPECT_LT(cut, inside / 2);
    EXPECT_NEAR(static_cast<double>(2 * inside + cut), static_cast<double>(2 * body.ends.size()) / 4,
                0.02 * static_cast<double>(body.ends.size()));
  }
}

TEST(Partition, LeavesAMassForEveryPart) {
  Body body;
  body.masses.resize(40);  // all in one place, and one of them has half of the load
  for (std::uint32_t i = 1; i < 40; ++i) body.springs.push_back({0, i, 1, 0});
  for (const unsigned count : {5u, 16u, 40u}) {
    std::size_t masses = 0;
    for (const Part& part : partition(Outline(body), count)) {
      EXPECT_GT(part.outline.rest.size(), 0u) << count;
      masses += part.outline.rest.size();
    }
    EXPECT_EQ(masses, 40u);
  }
}

TEST(ArrangedBody, CopiesEveryMassToTheHalosThatHaveIt) {
  const Body body = random_body(600, 20, 4);
  const auto arranged = ArrangedBody::of(body, 3, 32, nullptr, keep);
  const std::vector<Part> parts = partition(Outline(body), 3);
  std::set<std::tuple<std::size_t, std::uint32_t, std::uint32_t>> expected, found;  // mass, block, index there
  for (std::uint32_t p = 0; p < 3; ++p)
    for (std::size_t i = parts[p].outline.rest.size(); i < parts[p].masses.size(); ++i)
      expected.emplace(parts[p].masses[i], p, arranged->blocks()[p].arrangement.index_of[i]);
  for (const ArrangedBody::Block& block : arranged->blocks())
    for (const ArrangedBody::Copy& copy : block.copies) {
      const auto mass = std::ranges::find(arranged->index_of(), block.first_mass + copy.from);
      found.emplace(mass - arranged->index_of().begin(), copy.block, copy.to);
    }
  EXPECT_EQ(found, expected);
  EXPECT_GT(found.size(), 0u);
}

TEST(ArrangedBody, GivesEverySpringASlotOfItsOwn) {
  const Body body = random_body(600, 20, 4);
  const auto arranged = ArrangedBody::of(body, 5, 32, nullptr, keep);
  const auto slots = arranged->slot_of();
  EXPECT_EQ(std::set(slots.begin(), slots.end()).size(), body.springs.size());
  const auto masses = arranged->index_of();
  EXPECT_EQ(std::set(masses.begin(), masses.end()).size(), body.masses.size());
  EXPECT_EQ(ArrangedBody::of(body, 5, 32, arranged, keep), arranged) << "the same body is not arranged again";
  EXPECT_NE(ArrangedBody::of(body, 4, 32, arranged, keep), arranged);
}

TEST(ArrangedBody, DependsOnTheBodyAloneIfAsked) {
  Body body = random_body(300, 20, 4);
  const auto before = ArrangedBody::of(body, 1, 32, nullptr, keep);
  body.springs.erase(body.springs.begin() + 7);
  const auto alone = ArrangedBody::of(body, 1, 32, nullptr, keep),
             patched = ArrangedBody::of(body, 1, 32, before, keep);
  const auto nothing = ArrangedBody::Keep::nothing;
  const auto slots = [](const auto& arranged) {
    return std::vector(arranged->slot_of().begin(), arranged->slot_of().end());
  };
  EXPECT_NE(slots(patched), slots(alone));
  EXPECT_EQ(slots(ArrangedBody::of(body, 1, 32, before, nothing)), slots(alone));
  EXPECT_EQ(slots(ArrangedBody::of(body, 1, 32, patched, nothing)), slots(alone)) << "the same body, but patched";
  EXPECT_EQ(ArrangedBody::of(body, 1, 32, alone, nothing), alone);
  body = random_body(64, 20, 4);
  const auto of_many = ArrangedBody::of(body, 1, 32, nullptr, keep),
             of_few = ArrangedBody::of(body, 1, {32, 1}, nullptr, keep);
  const auto warps = [](const auto& arranged) { return arranged->blocks().front().arrangement.shape.warps; };
  EXPECT_GT(warps(of_few), warps(of_many));
  EXPECT_EQ(ArrangedBody::of(body, 1, 32, of_few, keep), of_few);
  EXPECT_EQ(warps(ArrangedBody::of(body, 1, 32, of_few, nothing)), warps(of_many));
}

}  // namespace
}  // namespace evodevo::cuda::EVODEVO_FILE
