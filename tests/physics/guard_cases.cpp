#include "guard_cases.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "analysis/energy.hpp"
#include "analysis/ground.hpp"

namespace evodevo::test {
namespace {

/// Two masses of 0.2 kg joined by a muscle that is `length` m long, has the amplitude `amplitude`, and is driven at
/// resonance.
Body resonant_pair(double length, double amplitude) {
  Body body = pair_of_masses(0.2, {5000, amplitude, std::sqrt(2 * 5000 / 0.2) / (2 * pi), 0}, length);
  body.springs[0].rest_length = length;
  return body;
}

struct Ending {
  Task task;
  State state;
};

Ending end_of(Simulator& simulator, const Body& body, const State& start, double dt, std::uint64_t steps,
              Recording recording = {}) {
  Ending ending{{}, start};
  ending.task = {.body = &body, .state = &ending.state, .dt = dt, .steps = steps};
  simulator.run({&ending.task, 1}, recording);
  return ending;
}

/// Kinetic and elastic energy of resonant_pair(), which starts at rest at t = 0. It holds as long as the stretch is
/// less than the length; the distance of the masses is length (1 + amplitude/2 (sin wt - wt cos wt)).
double energy_at_resonance(double length, double amplitude, double t) {
  const double w = std::sqrt(2 * 5000 / 0.2), angle = w * t;
  const double distance = length * amplitude / 2 * (std::sin(angle) - angle * std::cos(angle));
  const double speed = length * amplitude / 2 * w * angle * std::sin(angle);
  const double stretch = distance - length * amplitude * std::sin(angle);
  return 0.5 * 0.1 * speed * speed + 0.5 * 5000 * stretch * stretch;
}

}  // namespace

void expect_resonance_to_live(const SimulatorFactory& simulator_for, Method method) {
  const auto simulator = simulator_for({});
  const double truth = energy_at_resonance(1, 0.05, 0.1), strain = 0.5 * 5000 * 0.1 * 0.1;
  ASSERT_GT(truth, 10 * strain);
  const Body linear = resonant_pair(1, 0.05);
  const Ending early = end_of(*simulator, linear, resting(linear, {}), 0.0001, 1000);
  EXPECT_EQ(early.task.status, Status::ok) << early.task.reason;
  if (is_explicit(method)) {
    EXPECT_NEAR(total_energy(linear, early.state, {}), truth, 0.05 * truth);
  }
  // long enough for the masses to fly through each other repeatedly
  const Body wild = resonant_pair(0.5, 0.14);
  for (const Recording recording : {Recording{}, Recording{.stress = true, .work = true}}) {
    const Ending late = end_of(*simulator, wild, resting(wild, {}), 0.0005, 4000, recording);
    EXPECT_EQ(late.task.status, Status::ok) << late.task.reason;
  }
}

void expect_pumped_bodies_to_end(const SimulatorFactory& simulator_for) {
  const auto simulator = simulator_for(walking_scene());
  int ended = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Body body = random_body(150, 40, 5, seed);
    for (Mass& mass : body.masses) mass.mass = 0.05;
    const State birth = state_at_birth(body, walking_scene());
    ended += end_of(*simulator, body, birth, 0.0005, 10000).task.status == Status::diverged;
    const Ending healthy = end_of(*simulator, body, birth, 0.0001, 10000);
    EXPECT_EQ(healthy.task.status, Status::ok) << seed << ": " << healthy.task.reason;
  }
  EXPECT_GE(ended, 1);
}

void expect_one_bound(const SimulatorFactory& simulator_for) {
  const auto simulator = simulator_for({});
  const Body body = random_body(30, 6, 5, 4);
  const State start = resting(body, {});
  double sum = 0;
  for (const Spring& spring : body.springs) {
    const Material& m = body.materials[spring.material];
    sum += m.stiffness * std::pow(2 * pi * m.frequency * m.amplitude * spring.rest_length, 2);
  }
  const Ending once = end_of(*simulator, body, start, 0.0003, 900);
  State state = start;
  for (const std::uint64_t steps : {250u, 0u, 50u, 600u}) state = end_of(*simulator, body, state, 0.0003, steps).state;
  const double expected = std::pow(std::sqrt(start.start_energy) + 900 * 0.0003 * std::sqrt(sum / 2), 2);
  EXPECT_NEAR(once.state.start_energy, expected, 1e-9 * expected);
  EXPECT_NEAR(state.start_energy, expected, 1e-9 * expected);

  Body passive = body;
  for (Material& material : passive.materials) material.amplitude = 0;
  State shaken = start;
  shaken.start_energy = 0.3;
  EXPECT_EQ(end_of(*simulator, passive, shaken, 0.0003, 900).state.start_energy, 0.3);
}

}  // namespace evodevo::test
