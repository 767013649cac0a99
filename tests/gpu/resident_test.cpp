// The data that the host prepares for a body that stays on the chip.
#include "cuda/layout/resident.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <set>
#include <span>
#include <vector>

#include "analysis/computed_materials.hpp"
#include "analysis/ground.hpp"
#include "bodies.hpp"

namespace evodevo::cuda::EVODEVO_FILE {
namespace {

constexpr std::size_t shared_bytes = 227 << 10;  // shared memory of a block on an H200
const Features features{.gravity = true, .has_floor = true, .elastic_floor = true, .friction = true, .damping = true};

/// A body of 1,000 masses, each joined to 25 neighbours, whose springs cycle through `materials` materials. If
/// `materials` is 0, each spring has a material of its own.
Body body_of(std::size_t materials) {
  Body body = testing_gpu::random_body(1000, 25, 1);
  if (materials == 0) materials = body.springs.size();
  body.materials.clear();
  for (std::size_t i = 0; i < materials; ++i) body.materials.push_back({4000 + static_cast<double>(i), 0.1, 1, 0});
  for (std::size_t i = 0; i < body.springs.size(); ++i)
    body.springs[i].material = static_cast<std::uint32_t>(i % materials);
  return body;
}

const Scene scene = testing_gpu::walking_scene();

/// A task at the start of its simulation, with the state of its body.
template <class T>
struct Born {
  explicit Born(const Body& body) : state(state_at_birth(body, scene)), task{.body = &body, .state = &state} {
    task.course = course_of(task, scene, Precision::float32);
    task.course->forces = force_range<T>(body, state, scene);
  }
  Born(const Born&) = delete;

  State state;
  Task task;
};

double largest_force(const Body& body) { return force_range<float>(body, state_at_birth(body, scene), scene).largest; }

/// What the host gives to the device, in memory of the host.
struct Packed {
  explicit Packed(const Resident<float>& resident)
      : input(resident.sizes().input), motion(resident.sizes().state), sums(64), blocks(resident.blocks()) {
    const Regions regions{input.data(), motion.data(), sums.data()};
    resident.pack(regions, regions, scene, blocks.data());
  }

  std::vector<std::byte> input, motion, sums;
  std::vector<ResidentBody<float>> blocks;
};

TEST(Resident, ForcesHaveRoomForADashpotThatStopsAFall) {
  // a tall, soft body on a short spring, whose own force is small
  Body body;
  body.materials = {{100, 0, 0, 0, 20}, {1, 0, 0, 0}};
  body.masses = {{{0, 0, 0}, 0.2}, {{0, 0, 0.05}, 0.2}, {{0, 0, 2}, 0.2}};
  body.springs = {{0, 1, 0.05, 0}, {1, 2, 1.95, 1}};
  EXPECT_GT(largest_force(body), body.damping(body.springs[0]) * std::sqrt(2 * 9.81 * 2));
}

TEST(Resident, TheRangeOfALargeBodyIsNotThatOfItsWholeWeight) {
  // a chain of soft springs, which its weight would tear; from 1,000 masses on, it is cut off
  const auto chain = [](std::uint32_t masses) {
    Body body;
    body.materials = {{1, 0, 0, 0}};
    for (std::uint32_t i = 0; i < masses; ++i) {
      body.masses.push_back({{0.01 * i, 0, 0}, 0.2});
      if (i > 0) body.springs.push_back({i - 1, i, 0.01, 0});
    }
    return body;
  };
  const double of_thousand = 1000 * 0.2 * 9.81;
  EXPECT_GT(largest_force(chain(1000)), of_thousand);
  EXPECT_GT(largest_force(chain(8000)), of_thousand);
  EXPECT_LT(largest_force(chain(8000)), 2 * of_thousand);
  Body hanging = chain(8000);
  hanging.masses.back().mass = 0;
  EXPECT_GT(largest_force(hanging), 7.9 * of_thousand);
  Body pieces = chain(8000);
  std::erase_if(pieces.springs, [](const Spring& spring) { return spring.b % 100 == 0; });
  EXPECT_GT(largest_force(pieces), of_thousand / 10);
  EXPECT_LT(largest_force(pieces), of_thousand / 2);
}

TEST(Resident, LargeBodiesGetASmallClusterThatHoldsTheirSprings) {
  const auto blocks = [&](std::uint32_t masses, unsigned largest_cluster, unsigned wanted, bool work = false) {
    const Body body = testing_gpu::random_body(masses, 25, 1);
    Born<float> born(body);
    born.task.steps = 20000;
    Features recording = features;
    recording.work = work;
    const auto resident = Resident<float>::arrange(born.task, recording, {shared_bytes, largest_cluster, wanted});
    return resident ? resident->blocks() : 0;
  };
  EXPECT_EQ(blocks(1000, 16, 1), 1u);
  EXPECT_EQ(blocks(3000, 16, 1), 3u);
  EXPECT_EQ(blocks(3000, 1, 1), 1u) << "on a GPU without clusters, springs are in the device's memory";
  EXPECT_EQ(blocks(20000, 16, 1), 16u);
  EXPECT_EQ(blocks(20000, 1, 1), 0u);
  EXPECT_EQ(blocks(1000, 16, 7), 5u) << "clusters of seven would waste multiprocessors";
  EXPECT_EQ(blocks(1000, 16, 7, true), 1u) << "the rounding of work would depend on the number";
  EXPECT_EQ(blocks(300, 16, 16), 4u) << "a block needs enough masses";
  EXPECT_EQ(blocks(290, 16, 16), 1u) << "a small body is faster in one block";
}

TEST(Resident, NoBodyIsDividedIntoMorePartsThanItHasMasses) {
  Body body;
  body.masses = {{{0, 0, 0}, 0.2}, {{1, 0, 0}, 0.2}, {{0, 1, 0}, 0.2}};
  body.springs = {{0, 1, 1, 0}, {1, 2, 1.4, 1}};
  body.materials.assign(3000, {4000, 0.1, 1, 0});  // of which no block has room for the lengths
  const Born<double> of_many_materials(body);
  Features recording = features;
  recording.method = Method::rk4;
  recording.float64 = recording.actuation = recording.dashpots = recording.work = true;
  EXPECT_FALSE(Resident<double>::arrange(of_many_materials.task, recording, {shared_bytes, 16}));
  body.materials.resize(1);
  body.springs.assign(100000, {0, 1, 1, 0});  // for which no block has room
  const Born<float> of_many_springs(body);
  const auto resident = Resident<float>::arrange(of_many_springs.task, features, {shared_bytes, 16});
  ASSERT_TRUE(resident);
  EXPECT_EQ(resident->blocks(), 3u);
}

/// The shared memory of the blocks that simulate a body, with its positions; the halos are filled as the kernel does
/// it.
class Chips {
 public:
  explicit Chips(const std::vector<ResidentBody<float>>& blocks) : blocks_(blocks), chips_(blocks.size()) {
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      chips_[b].resize(shared_bytes / sizeof(float));
      const Motion<float>& motion = blocks[b].motion;
      for (std::uint32_t i = 0; i < lanes * blocks[b].groups; ++i)
        set(b, offset_of(i), {motion.x[i], motion.y[i], motion.z[i]});
    }
    for (std::size_t b = 0; b < blocks.size(); ++b)
      for (const HaloCopy& copy : std::span(blocks[b].halo_copies, blocks[b].copies))
        set(copy.to >> halo_rank_shift, copy.to & ((1u << halo_rank_shift) - 1), at(b, copy.from));
  }

  static std::uint32_t offset_of(std::uint32_t index) {
    return index / lanes * group_bytes<float, false> + index % lanes * sizeof(float);
  }

  Vec3 at(std::size_t block, std::uint32_t offset) const {
    const float* const x = &chips_[block].at(offset / sizeof(float));
    return {x[0], x[lanes], x[2 * lanes]};
  }

  /// Calls function(block, row, lane, index of the owner, is cut) for all slots, in the order of the kernel.
  template <class Function>
  void for_each_slot(const Shape& shape, const Function& function) const {
    for (std::size_t b = 0; b < blocks_.size(); ++b)
      for (std::uint32_t warp = 0, row = 0; warp < shape.warps + shape.cut_warps; ++warp) {
        std::uint32_t group = blocks_[b].first_group[warp];
        const bool cut = warp >= shape.warps;
        for (unsigned r = 0; r < (cut ? shape.cut_rows : shape.rows); ++r, ++row) {
          for (std::uint32_t lane = 0; lane < lanes; ++lane) function(b, row, lane, lanes * group + lane, cut);
          group += blocks_[b].group_ends[warp] >> r & 1;
        }
      }
  }

 private:
  void set(std::size_t block, std::uint32_t offset, const Vec3& position) {
    const double numbers[] = {position.x, position.y, position.z};
    for (std::size_t c = 0; c < 3; ++c)
      chips_[block].at(offset / sizeof(float) + c * lanes) = static_cast<float>(numbers[c]);
  }

  const std::vector<ResidentBody<float>>& blocks_;
  std::vector<std::vector<float>> chips_;
};

TEST(Resident, TheBlocksOfABodyComputeTheForcesOfAllItsSprings) {
  const Body body = testing_gpu::random_body(900, 20, 1);
  Born<float> born(body);
  State& state = born.state;
  for (Vec3& place : state.position) place.x *= 1.1;  // strains the springs
  born.task.course->forces = force_range<float>(body, state, scene);
  born.task.steps = 20000;
  const auto resident = Resident<float>::arrange(born.task, features, {shared_bytes, 16, 5});
  ASSERT_TRUE(resident);
  ASSERT_EQ(resident->blocks(), 5u);
  const Packed packed(*resident);
  const std::vector<ResidentBody<float>>& blocks = packed.blocks;
  for (std::size_t i = 0; i < slots_read_ahead; ++i) {
    const Record<float>& empty = blocks.front().records[resident->slots() + i];
    EXPECT_EQ(empty.rest_length, 0);
    EXPECT_EQ(empty.packed, 0u) << "a warp reads it, so it must lead to a mass and a material";
  }
  const Chips chips(blocks);
  const Shape& shape = resident->arranged()->blocks().front().arrangement.shape;

  std::vector<std::vector<Vec3>> force;
  for (const auto& block : blocks) force.emplace_back(lanes * (block.groups + 1));
  std::size_t counted = 0, copies = 0;
  chips.for_each_slot(shape, [&](std::size_t b, std::uint32_t row, std::uint32_t lane, std::uint32_t owner, bool cut) {
    const Record<float>& record = blocks[b].records[lanes * row + lane];
    const std::size_t entry = (record.packed >> 16) / sizeof(Entry<float>);
    if (entry == 0) return;
    (record.rest_length > 0 ? counted : copies) += 1;
    EXPECT_TRUE(cut || record.rest_length > 0);
    const std::uint32_t other = record.packed & 0xffff;
    const Vec3 d = chips.at(b, other) - chips.at(b, Chips::offset_of(owner));
    const double stiffness = blocks[b].actuators[entry].stiffness * blocks[b].resolution;
    const Vec3 pull = (stiffness * (1 - std::abs(record.rest_length) / norm(d))) * d;
    force[b][owner] = force[b][owner] + pull;
    if (cut) return;
    std::vector<Vec3>& forces = force[b];
    const std::uint32_t index = other / group_bytes<float, false> * lanes + other % plane_bytes<float> / sizeof(float);
    forces[index] = forces[index] - pull;
  });
  EXPECT_EQ(counted, body.springs.size());
  EXPECT_GT(copies, 0u);

  std::vector<Vec3> expected(body.masses.size());
  for (const Spring& spring : body.springs) {
    const Vec3 d = state.position[spring.b] - state.position[spring.a];
    const Vec3 pull = (body.stiffness(spring) * (1 - spring.rest_length / norm(d))) * d;
    expected[spring.a] = expected[spring.a] + pull;
    expected[spring.b] = expected[spring.b] - pull;
  }
  std::vector<Vec3> found;
  for (const auto& of_block : force) found.insert(found.end(), of_block.begin(), of_block.end() - lanes);
  const auto index_of = resident->arranged()->index_of();
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_LT(norm(found[index_of[i]] - expected[i]), 1e-3 * (1 + norm(expected[i]))) << i;
}

TEST(Resident, RecordsLeadToTheirMaterials) {
  for (const std::size_t materials : {15, 200, 5000, 9000, 0}) {
    const Body body = body_of(materials);
    const Born<float> born(body);
    const auto resident = Resident<float>::arrange(born.task, features, {shared_bytes});
    ASSERT_TRUE(resident) << materials;
    const bool wide = body.materials.size() > 8190;  // 16-bit offsets reach 8,191 entries; one is for empty slots
    EXPECT_EQ(resident->form().wide_table, wide) << materials;
    const Packed memory(*resident);
    const ResidentBody<float>& packed = memory.blocks.front();
    std::size_t springs = 0;
    for (std::size_t i = 0; i < resident->slots(); ++i) {
      const std::size_t entry = (packed.records[i].packed >> 16) * (wide ? sizeof(float) : 1) / sizeof(Entry<float>);
      if (entry == 0) continue;
      ++springs;
      if (materials > 0) continue;
      EXPECT_EQ(packed.records[i].rest_length, static_cast<float>(body.springs[entry - 1].rest_length));
    }
    EXPECT_EQ(springs, body.springs.size());
  }
}

TEST(Resident, SpringsCarryTheCodesOfTheirMaterials) {
  for (const std::size_t materials : {15, 1000, 0}) {
    const Body body = body_of(materials);
    const Born<float> born(body);
    Features computed = features;
    computed.materials = Materials::computed;
    computed.actuation = true;
    const auto resident = Resident<float>::arrange(born.task, computed, {shared_bytes});
    ASSERT_TRUE(resident) << materials;
    EXPECT_TRUE(resident->form().records_on_chip) << "whatever the materials";
    EXPECT_FALSE(resident->form().wide_table);
    const Packed memory(*resident);
    const ResidentBody<float>& packed = memory.blocks.front();
    const MaterialUnits units = material_units(body);
    EXPECT_FLOAT_EQ(packed.units.stiffness * static_cast<float>(packed.resolution),
                    static_cast<float>(units.stiffness));
    EXPECT_FLOAT_EQ(packed.units.amplitude * amplitude_mask, static_cast<float>(1023 * units.amplitude));
    std::multiset<std::array<std::uint32_t, 3>> expected, found;
    const auto bits = [](double length) { return std::bit_cast<std::uint32_t>(static_cast<float>(length)); };
    for (const Spring& spring : body.springs) {
      const MaterialCode code = code_of(body.materials[spring.material], units);
      expected.insert({bits(spring.rest_length), code.stiffness, code.wave});
    }
    for (std::size_t i = 0; i < resident->slots(); ++i) {
      const Record<float>& record = packed.records[i];
      if (record.packed >> 16 > 0) found.insert({bits(record.rest_length), record.packed >> 16, packed.waves[i]});
    }
    EXPECT_EQ(found, expected);
  }
}

TEST(Resident, LeavesToTheDevicesMemoryWhatTheChipCannotHold) {
  const Body body = body_of(0);  // in float64, its table alone is as large as the chip's memory
  const Born<double> born(body);
  EXPECT_FALSE(Resident<double>::arrange(born.task, features, {shared_bytes}));
  EXPECT_FALSE(Resident<float>::arrange(born.task, features, {shared_bytes / 2}));
}

TEST(Resident, WhatIsRecordedOrSampledDoesNotDecideHowManyStepsATableHas) {
  for (const std::size_t materials : {4, 15, 200, 5000}) {
    const Body body = body_of(materials);
    Born<float> born(body);
    Task& task = born.task;
    task.steps = 1000;
    task.sampled_at = {{10, {.work = true, .positions = true, .contacts = true}}};
    const auto table_steps = [&](Recording recording, const Channels& channels) {
      const Features all = features_of(scene, {}, recording, {.actuation = true}, channels);
      const auto resident = Resident<float>::arrange(task, all, {shared_bytes});
      return Packed(*resident).blocks.front().table_steps;
    };
    const std::uint32_t plain = table_steps({}, {});
    EXPECT_EQ(plain, table_steps({true, true, true, true, true}, {})) << materials;
    EXPECT_EQ(plain, table_steps({}, task.sampled_at.front().channels)) << materials;
  }
}

TEST(Resident, WhatIsRecordedDoesNotDecideWhereABodyLies) {
  Features recording = features;
  recording.work = true;
  int on_chip = 0;
  for (std::size_t materials = 14000; materials < 26000; materials += 1000) {
    Body body = testing_gpu::random_body(200, 10, 1);
    body.materials.resize(materials, {4000, 0, 0, 0});
    const Born<float> born(body);
    const bool plain = Resident<float>::arrange(born.task, features, {shared_bytes}).has_value();
    EXPECT_EQ(plain, Resident<float>::arrange(born.task, recording, {shared_bytes}).has_value()) << materials;
    on_chip += plain;
  }
  EXPECT_GT(on_chip, 0);
  EXPECT_LT(on_chip, 12);
}

}  // namespace
}  // namespace evodevo::cuda::EVODEVO_FILE
