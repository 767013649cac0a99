#include "pieces.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "analysis/stability.hpp"
#include "core/skip_shift.hpp"
#include "evodevo/rng.hpp"

namespace evodevo::test {
namespace {

constexpr double dt = 0.0007;     // time step, s
constexpr double birthday = 3.1;  // start time of the simulation, s
const std::vector<std::uint64_t> uneven{1, 7, 100, 0, 137, 255};

Scene rough_slope() { return {Gravity{9.81, 12}, Floor{1e5, 0.05}, Friction{}, Damping{}, Drag{0.05}}; }

Scene rigid_slope() {
  return {Gravity{9.81, 12}, Floor{.roughness = 0.05, .restitution = 0.4}, Friction{0.5, 0.7}, Damping{}, Drag{0.05}};
}

State late(const Body& body, const Scene& scene) {
  State state = state_at_birth(body, scene);
  state.time = birthday;
  state.start_energy = total_energy(body, state, scene);
  return state;
}

/// A body, its state, and the task of its run.
struct Run {
  const Body* body;
  State state;
  double dt = test::dt;
  Task task = {};

  /// Simulates all steps in pieces of the given numbers of steps.
  void make(Simulator& simulator, const std::vector<std::uint64_t>& pieces, Recording recording = {}) {
    std::uint64_t later = std::accumulate(pieces.begin(), pieces.end(), std::uint64_t{0});
    task = {.body = body, .state = &state, .dt = dt};
    for (const std::uint64_t steps : pieces) {
      if (task.status != Status::ok) return;
      later -= steps;
      task.steps = steps;
      task.later_steps = later;
      simulator.run({&task, 1}, recording);
    }
  }
};

void expect_same(const Run& whole, const Run& pieces) {
  EXPECT_TRUE(same_bits(whole.state, pieces.state));
  EXPECT_EQ(whole.state.time, pieces.state.time);
  EXPECT_EQ(whole.state.start_energy, pieces.state.start_energy);
  EXPECT_EQ(whole.task.status, pieces.task.status);
  EXPECT_EQ(whole.task.reason, pieces.task.reason);
  EXPECT_EQ(whole.task.ended_at, pieces.task.ended_at);
  EXPECT_FALSE(whole.task.course) << "nothing follows";
  EXPECT_FALSE(pieces.task.course) << "nothing follows";
}

void expect_one_verdict_on(const Body& body, const State& start, double step, const SimulatorFactory& simulator_for,
                           const Scene& scene) {
  const auto simulator = simulator_for(scene);
  Run whole{&body, start, step}, pieces = whole, recorded = whole;
  whole.make(*simulator, {1000});
  pieces.make(*simulator, std::vector<std::uint64_t>(40, 25));
  recorded.make(*simulator, {63, 937}, {true, true, true, true, true});
  EXPECT_EQ(whole.task.status, Status::diverged);
  expect_same(whole, pieces);
  expect_same(whole, recorded);
}

}  // namespace

void expect_pieces_to_be_the_whole(const SimulatorFactory& simulator_for, const std::vector<Body>& bodies) {
  for (const Scene& scene : {rough_slope(), rigid_slope()})
    for (const Body& body : bodies) {
      SCOPED_TRACE(std::to_string(body.masses.size()) + " masses, " + (scene.floor->rigid() ? "rigid" : "elastic"));
      const auto simulator = simulator_for(scene);
      Run whole{&body, late(body, scene)}, pieces = whole, recorded = whole;
      whole.make(*simulator, {500});
      pieces.make(*simulator, uneven);
      recorded.make(*simulator, {333, 167}, {true, true, true, true, true});
      EXPECT_EQ(whole.task.status, Status::ok) << whole.task.reason;
      EXPECT_EQ(whole.state.time, birthday + 500 * dt);
      expect_same(whole, pieces);
      expect_same(whole, recorded);
    }
}

void expect_tallies_to_leave_the_motion_alone(const SimulatorFactory& simulator_for, const Body& body) {
  const Scene scene = rough_slope();
  const auto simulator = simulator_for(scene);
  Run whole{&body, late(body, scene)}, tallied = whole;
  whole.make(*simulator, {500});
  const auto counting = [](const std::uint32_t* counter, const std::uint32_t* key, std::uint32_t* out) {
    for (std::uint32_t i = 0; i < 4; ++i) out[i] = 2654435769u * (4 * counter[0] + i + key[0]);
  };
  Rng random(counting, {});
  tallied.task = {.body = &body, .state = &tallied.state, .dt = dt, .steps = 500};
  run_with_tallies(*simulator, {&tallied.task, 1}, 37, {&random, 1});
  expect_same(whole, tallied);
}

void expect_one_verdict(const SimulatorFactory& simulator_for, Method method) {
  const Body stiff = random_body(40, 8, 5, 3), sound = random_body(50, 10, 5, 2);
  Body unstable = stiff;
  for (Material& material : unstable.materials) material.stiffness *= 4000;
  const Scene scene = walking_scene();
  expect_one_verdict_on(unstable, late(unstable, scene), 0.0005, simulator_for, scene);
  // the initial energy switches the guard off, so that on the GPU only the range of forces can stop the body
  State start = late(sound, {});
  for (std::size_t i = 0; i < start.velocity.size(); ++i) start.velocity[i].x = 0.001 * static_cast<double>(i % 7);
  start.start_energy = 1e300;
  expect_one_verdict_on(sound, start, 1.3 * largest_dt(sound, start.position, method), simulator_for, {});
}

void expect_no_check_between_pieces(const SimulatorFactory& simulator_for) {
  // Energy falls from 1 J to 0.35 J at step 37, and below the bound of 0.2 J before step 100.
  const Scene scene{{}, {}, {}, Damping{20}, {}};
  const Body body = single_mass(0.2);
  State start = resting(body, scene);
  start.velocity[0] = {std::sqrt(10.0), 0, 0};
  start.start_energy = 0.02;
  const auto simulator = simulator_for(scene);
  Run whole{&body, start}, pieces = whole, short_run = whole;
  whole.make(*simulator, {150});
  pieces.make(*simulator, {37, 60, 53});
  short_run.make(*simulator, {37});
  EXPECT_EQ(whole.task.status, Status::ok) << whole.task.reason;
  expect_same(whole, pieces);
  EXPECT_EQ(short_run.task.status, Status::diverged) << "the end of a run is checked";
}

}  // namespace evodevo::test
