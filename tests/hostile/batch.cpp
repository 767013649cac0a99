#include "batch.hpp"

#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "analysis/neighbours.hpp"
#include "physics/random_numbers.hpp"

namespace evodevo::test {
namespace {

std::vector<Material> any_materials(Random& random) {
  std::vector<Material> materials(1 + random.below(random.chance(0.1) ? 3000 : 8));
  const double stiffness = random.of_any_scale(1e-3, 1e8), spread = random.of_any_scale(1, 1e4);
  for (Material& material : materials) {
    material.stiffness = stiffness * random.of_any_scale(1, spread);
    if (random.chance(0.5)) material.amplitude = random.between(0, random.chance(0.2) ? 3 : 0.3);
    material.frequency = random.of_any_scale(1e-2, 1e3);
    material.phase = random.between(-10, 10);
    if (random.chance(0.3)) material.damping = random.between(0, 5);
  }
  return materials;
}

std::vector<Mass> any_masses(Random& random) {
  std::vector<Mass> masses(static_cast<std::size_t>(random.of_any_scale(1, random.chance(0.02) ? 4000 : 500)));
  const double mass = random.of_any_scale(1e-6, 1e3), spread = random.chance(0.3) ? random.of_any_scale(1, 1e4) : 1;
  const double size = random.of_any_scale(1e-3, 1e3), again = random.chance(0.2) ? 0.3 : 0;
  for (std::size_t i = 0; i < masses.size(); ++i) {
    const bool is_again = i > 0 && random.chance(again);
    masses[i].rest = is_again ? masses[i - 1].rest : random.vector(size);
    masses[i].mass = random.chance(0.02) ? 0 : mass * random.of_any_scale(1, spread);
  }
  return masses;
}

Body any_body(Random& random) {
  Body body;
  body.materials = any_materials(random);
  body.masses = any_masses(random);
  std::vector<Vec3> places;
  for (const Mass& mass : body.masses) places.push_back(mass.rest);
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    const double strain = random.chance(0.05) ? 0 : random.of_any_scale(0.5, random.chance(0.02) ? 1e3 : 2);
    Spring spring{a, b, strain * norm(places[b] - places[a]),
                  random.below(static_cast<std::uint32_t>(body.materials.size()))};
    if (random.chance(0.2)) spring.stiffness_factor = random.of_any_scale(0.01, 100);
    body.springs.push_back(spring);
  };
  if (random.chance(0.05)) {
    for (std::uint32_t i = 1; i < places.size(); ++i) join(0, i);
  } else {
    for (const auto& [a, b] : nearest_pairs(places, 1 + random.below(random.chance(0.1) ? 40 : 12))) join(a, b);
  }
  return body;
}

Life any_life(const Scene& scene, std::uint64_t seed) {
  Random random(seed);
  Life life{.seed = seed, .body = any_body(random)};
  life.start = state_at_birth(life.body, scene);
  const Vec3 away = random.chance(0.1) ? random.vector(random.of_any_scale(1e-3, 1e6)) : Vec3{};
  const double speed = random.of_any_scale(1e-3, 1e4);
  for (std::size_t i = 0; i < life.body.masses.size(); ++i) {
    life.start.position[i] = life.start.position[i] + away;
    if (life.body.masses[i].mass > 0) life.start.velocity[i] = random.vector(speed);
  }
  life.start.time = random.chance(0.1) ? random.of_any_scale(1, 1e6) : 0;
  life.start.start_energy = total_energy(life.body, life.start, scene);
  life.dt = random.of_any_scale(1e-6, 0.05);
  life.steps = 1 + random.below(120);
  return life;
}

}  // namespace

Batch batch_of(std::uint64_t number, std::size_t bodies) {
  Random random(number);
  Batch batch{
      .scene = random_scene(number),
      .stepping = {all_methods[number % all_methods.size()],
                   number / 6 % 2 == 0 ? Precision::float32 : Precision::float64,
                   number / 24 % 4 == 3 ? Materials::computed : Materials::table},
      .recording = {random.chance(0.3), random.chance(0.3), random.chance(0.3), random.chance(0.3), random.chance(0.3)},
      .lives = {},
      .is_tame = number / 12 % 2 == 0};
  if (batch.is_tame) {
    batch.lives = random_lives(batch.scene, number, bodies);
  } else {
    for (std::size_t i = 0; i < bodies; ++i) batch.lives.push_back(any_life(batch.scene, 1000003 * number + i));
  }
  return batch;
}

}  // namespace evodevo::test
