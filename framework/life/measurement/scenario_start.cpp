#include "life/measurement/scenario_start.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "base/philox.hpp"
#include "life/birth.hpp"
#include "life/body_building.hpp"

namespace evodevo {
namespace {

/// Replaces the payload of a body. The masses in the upper part of the body, as it is now, carry the new one; held
/// masses (0 kg) carry nothing.
void change_payload(const std::optional<Payload>& payload, LivingBody& living) {
  const std::vector<Vec3>& positions = living.state.position;
  const Box box = bounding_box(positions);
  double weight = 0;
  std::vector<Mass*> carriers;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    Mass& mass = living.body.masses[i];
    mass.mass -= mass.payload;
    mass.payload = 0;
    weight += mass.mass;
    if (payload && mass.mass > 0 && positions[i].z >= box.high.z - payload->top * (box.high.z - box.low.z))
      carriers.push_back(&mass);
  }
  for (Mass* mass : carriers) {
    mass->payload = payload->share * weight / static_cast<double>(carriers.size());
    mass->mass += mass->payload;
  }
}

/// Removes the share of the springs whose middles are nearest to a place drawn in the body's bounding box, and then the
/// pieces that this tears off.
void do_damage(double share, Rng& random, LivingBody& living) {
  const std::vector<Vec3>& positions = living.state.position;
  const Box box = bounding_box(positions);
  const double x = random.uniform(), y = random.uniform(), z = random.uniform();
  const Vec3 side = box.high - box.low, place = box.low + Vec3{x * side.x, y * side.y, z * side.z};
  const std::vector<Spring>& springs = living.body.springs;
  const auto distance = [&](std::uint32_t spring) {
    return norm(0.5 * (positions[springs[spring].a] + positions[springs[spring].b]) - place);
  };
  std::vector<std::uint32_t> order(springs.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return distance(a) < distance(b); });
  order.resize(static_cast<std::size_t>(std::round(share * static_cast<double>(springs.size()))));
  std::sort(order.begin(), order.end());
  Edits damage, loss;
  for (const std::uint32_t spring : order) damage.remove_spring(spring);
  apply(damage, living);
  for (const std::uint32_t mass : loose_masses(living.body)) loss.remove_mass(mass);
  apply(loss, living);
}

/// Returns the stream of a test in the lives with this number, which is the same for all individuals.
Rng stream(const Test& test, std::uint32_t life, const Experiment& experiment) {
  return Rng(philox, {seed_of(experiment.seed, life), static_cast<std::uint32_t>(test.scenario),
                      static_cast<std::uint32_t>(test.repeat), rng_stream::scenario});
}

}  // namespace

std::vector<Test> tests_of(const Experiment& experiment) {
  std::vector<Test> tests;
  for (std::size_t i = 0; i < experiment.scenarios.size(); ++i)
    for (std::int64_t repeat = 0; repeat < experiment.scenarios[i].repeat; ++repeat) tests.push_back({i, repeat});
  return tests;
}

std::vector<std::size_t> scenarios_that_develop(const Experiment& experiment) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < experiment.scenarios.size(); ++i)
    if (experiment.scenarios[i].develops) indices.push_back(i);
  return indices;
}

void start_scenario(const Test& test, const Experiment& experiment, const LifeSimulation& simulation, Life& life) {
  const Scenario& scenario = experiment.scenarios[test.scenario];
  LivingBody& living = life.living;
  const Draws draws =
      draws_of_life(experiment, life.newborn, "scenario " + scenario.name, static_cast<std::uint64_t>(test.repeat));
  Rng random = draws.inherited() ? draws.stream("damage") : stream(test, life.newborn.life, experiment);
  const Scene& before = *std::exchange(life.scene, &scenario.scene);
  const bool was_here = &before == &scenario.scene;
  if (!was_here && scenario.payload != experiment.payload) change_payload(scenario.payload, living);
  if (!scenario.muscles)
    for (Material& material : living.body.materials) material.amplitude = 0;
  if (scenario.damage > 0) do_damage(scenario.damage, random, living);
  if (living.body.springs.empty()) return life.end(Status::invalid, "no springs");
  if (scenario.start_noise > 0)
    move_at_random(scenario.start_noise * bounding_box(living.state.position).longest_side(), draws, random, living);
  const bool is_moved = scenario.start_noise > 0 || scenario.scene.floor != before.floor;
  if (is_moved && scenario.scene.floor) put_on_ground(living.state.position, scenario.scene);
  living.version = nullptr;
  living.state.start_energy =
      std::max(living.state.start_energy, total_energy(living.body, living.state, scenario.scene));
  simulation.choose_step(life);
}

}  // namespace evodevo
