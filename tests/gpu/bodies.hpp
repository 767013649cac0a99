// Bodies and scenes for the tests of the CUDA simulator.
#pragma once

#include <cstdint>
#include <vector>

#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "analysis/neighbours.hpp"
#include "core/scene.hpp"
#include "core/simulator.hpp"
#include "evodevo/body.hpp"
#include "physics/random_numbers.hpp"

namespace evodevo::testing_gpu {

inline constexpr double pi = 3.14159265358979323846;

using test::Random;

/// The paper's materials (Table I) without air.
inline std::vector<Material> paper_materials() {
  return {{5000, 0.14, 1, 0}, {4000, 0, 0, 0}, {5000, 0.14, 1, pi}, {10000, 0, 0, 0}};
}

/// `masses` random points in a cube of side 2 m with masses from 0.15 kg to 0.25 kg, each joined to its `neighbours`
/// nearest ones; the springs cycle through the materials.
inline Body random_body(std::uint32_t masses, std::uint32_t neighbours, std::uint64_t seed,
                        std::vector<Material> materials = paper_materials()) {
  Random random(seed);
  Body body;
  body.materials = std::move(materials);
  std::vector<Vec3> places;
  for (std::uint32_t i = 0; i < masses; ++i) {
    places.push_back(random.vector(1));
    body.masses.push_back({places.back(), 0.2 + 0.05 * random.between(-1, 1)});
  }
  for (const auto& [a, b] : nearest_pairs(places, neighbours)) {
    const auto material = static_cast<std::uint32_t>(body.springs.size() % body.materials.size());
    body.springs.push_back({a, b, norm(places[b] - places[a]), material});
  }
  return body;
}

/// Two copies of a body that a few springs join, and beside them a third copy that nothing joins.
inline Body body_in_pieces(const Body& piece) {
  Body body = piece;
  const auto masses = static_cast<std::uint32_t>(piece.masses.size());
  for (const std::uint32_t copy : {1u, 2u}) {
    for (const Mass& mass : piece.masses) body.masses.push_back({mass.rest + Vec3{5.0 * copy, 0, 0}, mass.mass});
    for (Spring spring : piece.springs) {
      spring.a += copy * masses;
      spring.b += copy * masses;
      body.springs.push_back(spring);
    }
  }
  for (const std::uint32_t i : {0u, 1u, 2u}) body.springs.push_back({i, i + masses, 5, 0});
  return body;
}

/// A body at birth with random velocities of up to 0.5 m/s along each axis.
inline State moving_state(const Body& body, const Scene& scene, std::uint64_t seed) {
  Random random(seed);
  State state = state_at_birth(body, scene);
  for (Vec3& velocity : state.velocity) velocity = 0.5 * random.vector(1);
  state.start_energy = total_energy(body, state, scene);
  return state;
}

inline Scene walking_scene() { return {Gravity{}, Floor{}, Friction{}, Damping{}, std::nullopt}; }

/// A body with its start state, and the result of its simulation.
struct Robot {
  Robot(const Body& body_, const State& state_) : body(&body_), state(state_) {}
  Task task(std::uint64_t steps) { return {.body = body, .state = &state, .dt = dt, .steps = steps}; }

  const Body* body;
  State state;
  double dt = 0.0005;  ///< time step [s]
  Task answer;
};

/// Simulates all bodies in one batch.
inline void simulate(Simulator& simulator, const std::vector<Robot*>& runs, std::uint64_t steps,
                     Recording recording = {}) {
  std::vector<Task> tasks;
  for (Robot* run : runs) tasks.push_back(run->task(steps));
  simulator.run(tasks, recording);
  for (std::size_t i = 0; i < runs.size(); ++i) runs[i]->answer = tasks[i];
}

inline void simulate(Simulator& simulator, std::vector<Robot>& robots, std::uint64_t steps, Recording recording = {}) {
  std::vector<Robot*> runs;
  for (Robot& robot : robots) runs.push_back(&robot);
  simulate(simulator, runs, steps, recording);
}

/// Returns the largest distance between the positions of any mass in two states, m.
inline double distance(const State& a, const State& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.position.size(); ++i) {
    const double d = norm(a.position[i] - b.position[i]);
    if (!(d <= largest)) largest = d;
  }
  return largest;
}

}  // namespace evodevo::testing_gpu
