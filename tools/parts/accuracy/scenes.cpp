#include "scenes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/ground.hpp"
#include "common/bodies.hpp"
#include "evodevo/lattice.hpp"
#include "perturbation.hpp"
#include "reference.hpp"
#include "simulation.hpp"

namespace evodevo::tools::accuracy {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double mass_of_each = 0.2;  // each point mass, kg

/// A lattice of n x n x n voxels with edges of 0.1 m.
Body block(std::uint32_t n, const Material& material) {
  const Lattice lattice = make_lattice({n, n, n}, 0.1);
  Body body;
  body.materials = {material};
  for (const Vec3& corner : lattice.corners) body.masses.push_back({corner, mass_of_each});
  for (const LatticeSpring& s : lattice.springs)
    body.springs.push_back({s.a, s.b, norm(lattice.corners[s.b] - lattice.corners[s.a]), 0});
  return body;
}

/// n x n masses in a plane, joined along the sides and diagonals of its squares.
Body slab(std::uint32_t n, double z, const Material& material) {
  Body body;
  body.materials = {material};
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) body.masses.push_back({{0.1 * x, 0.1 * y, z}, mass_of_each});
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    body.springs.push_back({a, b, norm(body.masses[b].rest - body.masses[a].rest), 0});
  };
  for (std::uint32_t i = 0; i < n * n; ++i) {
    const bool right = i % n + 1 < n, above = i + n < n * n;
    if (right) join(i, i + 1);
    if (above) join(i, i + n);
    if (right && above) join(i, i + n + 1), join(i + 1, i + n);
  }
  return body;
}

/// Gives the body in `state` a rotation about the vertical axis at 2 rad/s, and a vertical velocity that grows with x.
State turning(const Body& body, State state, const Scene& scene) {
  for (std::size_t i = 0; i < state.velocity.size(); ++i)
    state.velocity[i] = {-2 * state.position[i].y, 2 * state.position[i].x, state.position[i].x};
  return with_energy(body, std::move(state), scene);
}

/// Solves a trial by simulation with steps of `dt` s, and measures how far a start moved by 1e-9 m leads from this
/// solution.
Trial simulated(Trial trial, double dt) {
  const Setting finest{Method::velocity_verlet, Precision::float64, dt};
  trial.truth = simulate(trial.body, trial.start, trial.scene, finest, trial.duration).state;
  trial.truth_by = "double, dt / 16";
  const State moved = perturbed(trial.start, 1e-9);
  trial.ceiling = trial.error(simulate(trial.body, moved, trial.scene, finest, trial.duration).state);
  return trial;
}

Trial integrated(Trial trial) {
  trial.truth = solution(trial.body, trial.start, trial.scene, trial.duration);
  trial.truth_by = "Odeint";
  return trial;
}

/// A lattice above the floor.
Trial drop(const std::string& name, const Floor& floor) {
  const Body body = block(2, {5000, 0, 0, 0});
  const Scene scene{Gravity{}, floor, {}, Damping{}, {}};
  State start = state_at_birth(body, scene);
  for (Vec3& position : start.position) position.z += 0.05;
  return {name, {}, false, body, scene, with_energy(body, start, scene), 0.4, {}};
}

/// A slab that slides at `depth` m below the ground, where the floor bears its weight.
Trial slide(const std::string& name, const Floor& floor, double depth) {
  const Scene scene{Gravity{}, floor, Friction{}, {}, {}};
  const double g = scene.gravity->acceleration, speed = 1.5;
  const Body body = slab(4, -depth, {5000, 0, 0, 0});
  State start = resting(body, scene);
  for (Vec3& v : start.velocity) v = {speed, 0, 0};
  start = with_energy(body, std::move(start), scene);
  State truth = resting(body, scene);
  for (Vec3& position : truth.position) position.x += speed * speed / (2 * scene.friction->coefficient * g);
  return {name, "closed form", false, body, scene, start, 0.4, truth};
}

Trial walker(const std::string& name, const Floor& floor) {
  const Body body = random_ball(40);
  Scene scene = walking_scene();
  scene.floor = floor;
  return {name, {}, false, body, scene, state_at_birth(body, scene), 1, {}};
}

}  // namespace

double Trial::error(const State& state) const {
  return largest_distance(state, truth) / largest_distance(start, truth);
}

Trial spring_trial() {
  Body body;
  body.materials = {{500, 0.1, 2, 0.7}};
  body.masses = {{{0, 0, 0}, mass_of_each}, {{1.05, 0, 0}, mass_of_each}};
  body.springs = {{0, 1, 1.0, 0}};
  const Scene scene{{}, {}, {}, Damping{3}, Drag{0.2}};
  return integrated({"one spring", {}, true, body, scene, turning(body, resting(body, scene), scene), 0.4, {}});
}

Trial beam_trial() {
  const Body body = cantilever(10, 0.1, mass_of_each, 5000);
  const Scene scene{Gravity{0.5}, {}, {}, {}, {}};
  return integrated({"beam held at one end", {}, true, body, scene, resting(body, scene), 1, {}});
}

Trial lattice_trial() {
  Body body = block(2, {800, 0.1, 3, 0});
  body.materials.push_back({1000, 0.1, 2, 1});
  for (std::size_t i = 0; i < body.springs.size(); i += 3) body.springs[i].material = 1;
  const Scene scene{Gravity{}, {}, {}, Damping{2}, Drag{0.1}};
  State start = turning(body, resting(body, scene), scene);
  start.start_energy += 100;  // lets the divergence guard allow for the energy that the falling body gains
  return integrated({"turning lattice", {}, true, body, scene, std::move(start), 0.2, {}});
}

Trial swimmer_trial() {
  const Body body = random_ball(40);
  const Scene scene{{}, {}, {}, {}, Drag{}};
  return integrated({"swimmer", {}, true, body, scene, resting(body, scene), 0.4, {}});
}

Trial drop_trial() { return integrated(drop("lattice dropped on the floor", {})); }

Trial slide_trial() {
  const Floor floor;
  return slide("slab sliding to rest", floor, mass_of_each * Gravity{}.acceleration / floor.stiffness);
}

Trial walker_trial(double dt) { return simulated(walker("walker", {}), dt); }

Trial rigid_drop_trial(double dt) { return simulated(drop("lattice dropped, rigid floor", rigid_floor), dt); }
Trial rigid_slide_trial() { return slide("slab sliding, rigid floor", rigid_floor, 0); }
Trial rigid_walker_trial(double dt) { return simulated(walker("walker, rigid floor", rigid_floor), dt); }

Body cantilever(std::uint32_t voxels, double edge, double mass, double stiffness) {
  const Lattice lattice = make_lattice({voxels, 1, 1}, edge);
  Body body;
  body.materials = {{stiffness, 0, 0, 0}};
  for (std::size_t i = 0; i < lattice.corners.size(); ++i) {
    const std::size_t station = i % (voxels + 1);
    body.masses.push_back({lattice.corners[i], station == 0 ? 0 : station == voxels ? mass / 2 : mass});
  }
  for (const LatticeSpring& s : lattice.springs)
    body.springs.push_back({s.a, s.b, norm(lattice.corners[s.b] - lattice.corners[s.a]), 0});
  return body;
}

EulerBernoulli euler_bernoulli(std::uint32_t voxels, double edge, double mass, double stiffness) {
  return {1.25 * stiffness * edge * edge * edge, 4 * mass / edge, voxels * edge};
}

double EulerBernoulli::end_deflection(double acceleration) const {
  return mass_per_length * acceleration * std::pow(length, 4) / (8 * bending_stiffness);
}

double EulerBernoulli::first_frequency() const {
  constexpr double root = 1.8751040687119611;  // the first root of cos x cosh x = -1
  return root * root / (2 * pi) * std::sqrt(bending_stiffness / (mass_per_length * std::pow(length, 4)));
}

}  // namespace evodevo::tools::accuracy
