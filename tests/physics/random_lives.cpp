#include "random_lives.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "analysis/neighbours.hpp"
#include "analysis/stability.hpp"
#include "cpu/simulator.hpp"
#include "random_numbers.hpp"

namespace evodevo::test {
namespace {

Body random_small_body(Random& random) {
  Body body;
  for (std::uint32_t i = 1 + random.below(8); i > 0; --i)
    body.materials.push_back({random.of_any_scale(100, 20000), random.chance(0.3) ? 0 : random.between(0, 0.2),
                              random.between(0, 4), random.between(0, 2 * pi)});
  std::vector<Vec3> places;
  for (std::uint32_t i = 1 + random.below(16); i > 0; --i) {
    const bool again = !places.empty() && random.chance(0.03);
    places.push_back(again ? places.back() : random.vector(0.5));
    body.masses.push_back({places.back(), random.chance(0.05) ? 0 : random.between(0.05, 0.5)});
  }
  for (const auto& [a, b] : nearest_pairs(places, 1 + random.below(6))) {
    if (random.chance(0.1)) continue;
    const double strain = random.chance(0.02) ? 0 : random.between(0.8, 1.2);
    body.springs.push_back(
        {a, b, strain * norm(places[b] - places[a]), random.below(static_cast<std::uint32_t>(body.materials.size()))});
  }
  return body;
}

State random_start(const Body& body, const Scene& scene, Random& random) {
  State state = state_at_birth(body, scene);
  const double height = random.between(-0.001, 0.05);
  const Vec3 velocity = random.vector(1);
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    state.position[i].z += height;
    if (body.masses[i].mass > 0) state.velocity[i] = velocity + random.vector(1);
  }
  state.time = random.between(0, 10);
  state.start_energy = 1 + total_energy(body, state, scene);  // the energy itself may be almost 0
  return state;
}

}  // namespace

Scene random_scene(std::uint64_t seed) {
  Random random(seed);
  Scene scene;
  if (random.chance(0.7)) scene.gravity = Gravity{random.between(0, 20)};
  if (random.chance(0.5)) scene.floor = Floor{random.of_any_scale(1e4, 1e6)};
  if (random.chance(0.5)) scene.friction = Friction{random.between(0, 1)};
  if (random.chance(0.4)) scene.damping = Damping{random.between(0, 50)};
  if (random.chance(0.4)) scene.drag = Drag{random.between(0, 2)};
  if (scene.gravity && random.chance(0.5)) scene.gravity->slope = random.between(-40, 40);
  if (scene.floor && random.chance(0.4)) scene.floor->restitution = random.between(0, 1);
  if (scene.friction && random.chance(0.4))
    scene.friction->static_coefficient = scene.friction->coefficient + random.between(0, 0.5);
  return scene;
}

std::vector<Life> random_lives(const Scene& scene, std::uint64_t seed, std::size_t count) {
  std::vector<Life> lives(count);
  for (std::size_t i = 0; i < count; ++i) {
    Life& life = lives[i];
    life.seed = 1000003 * seed + i;
    Random random(life.seed);
    life.body = random_small_body(random);
    life.start = random_start(life.body, scene, random);
    const double longest =
        std::min(safe_dt(life.body, scene, Method::paper_euler), safe_dt(life.body, scene, Method::rk4));
    life.dt = random.between(0.02, 0.5) * longest;
  }
  return lives;
}

State mirrored(State state) {
  for (Vec3& x : state.position) x.x = -x.x;
  for (Vec3& v : state.velocity) v.x = -v.x;
  return state;
}

Scene mirrored(Scene scene) {
  if (scene.gravity) scene.gravity->slope = -scene.gravity->slope;
  return scene;
}

std::vector<Answer> simulate(Simulator& simulator, const std::vector<Life>& lives, Recording recording) {
  std::vector<Answer> answers(lives.size());
  std::vector<Task> tasks(lives.size());
  for (std::size_t i = 0; i < lives.size(); ++i) {
    answers[i].state = lives[i].start;
    tasks[i] = {.body = &lives[i].body,
                .state = &answers[i].state,
                .dt = lives[i].dt,
                .steps = lives[i].steps,
                .sampled_at = lives[i].sampled_at};
  }
  simulator.run(tasks, recording);
  for (std::size_t i = 0; i < lives.size(); ++i) {
    answers[i].task = std::move(tasks[i]);
    answers[i].task.state = nullptr;  // this pointer would dangle if the answer were moved
  }
  return answers;
}

double sensitivity(const Life& life, const Scene& scene, const Stepping& stepping, double moved) {
  Random random(life.seed);
  std::vector<Life> lives(65, life);
  for (std::size_t i = 1; i < lives.size(); ++i)
    for (Vec3& x : lives[i].start.position) x = x + random.vector(moved);
  const std::vector<Answer> answers = simulate(*make_cpu_simulator(scene, stepping, 0), lives);
  double largest = 0;
  for (const Answer& answer : answers) largest = std::max(largest, largest_difference(answers[0].state, answer.state));
  return largest;
}

}  // namespace evodevo::test
