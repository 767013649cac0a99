#include "support.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "analysis/neighbours.hpp"
#include "evodevo/lattice.hpp"
#include "random_numbers.hpp"

namespace evodevo::test {

std::string name_of(Method method) {
  std::string text(name(method));
  std::replace(text.begin(), text.end(), '-', '_');
  return text;
}

std::string name_of(const Arithmetic& arithmetic) {
  return name_of(std::get<Method>(arithmetic)) + "_" + name_of(std::get<Precision>(arithmetic));
}

Body single_mass(double mass, Vec3 place) {
  Body body;
  body.masses.push_back({place, mass});
  return body;
}

Body pair_of_masses(double mass, const Material& material, double distance) {
  Body body;
  body.materials = {material};
  body.masses = {{{0, 0, 0}, mass}, {{distance, 0, 0}, mass}};
  body.springs = {{0, 1, 1.0, 0}};
  return body;
}

Body random_body(std::uint32_t masses, std::uint32_t neighbours, std::uint32_t materials, std::uint64_t seed) {
  Random random(seed);
  const auto unit = [&] { return random.between(0, 1); };
  const Material muscle{5000, 0.14, 1, 0}, tissue{4000, 0, 0, 0};
  Body body;
  body.materials = {muscle, tissue, {5000, 0.14, 1, pi}, {10000, 0, 0, 0}, mean(muscle, tissue)};
  while (body.materials.size() < materials)
    body.materials.push_back({3000 + 5000 * unit(), 0.2 * unit(), 3 * unit(), 7 * unit()});
  body.materials.resize(materials);
  std::vector<Vec3> places;
  while (places.size() < masses) {
    const double x = 2 * unit() - 1, y = 2 * unit() - 1, z = 2 * unit() - 1;
    if (x * x + y * y + z * z <= 1) places.push_back({x, y, z});
  }
  for (const Vec3& place : places) body.masses.push_back({place, 0.1 + 0.2 * unit()});
  for (const auto& [a, b] : nearest_pairs(places, neighbours))
    body.springs.push_back(
        {a, b, norm(places[b] - places[a]), static_cast<std::uint32_t>(body.springs.size() % materials)});
  return body;
}

Body with_dashpots(Body body) {
  for (std::size_t i = 0; i < body.materials.size(); ++i)
    body.materials[i].damping = 0.05 + 0.1 * static_cast<double>(i % 3);
  for (Mass& mass : body.masses) mass.mass = 0.2;
  return body;
}

Body block(std::uint32_t n, const Material& material) {
  const Lattice lattice = make_lattice({n, n, n}, 0.1);
  Body body;
  body.materials = {material};
  for (const Vec3& corner : lattice.corners) body.masses.push_back({corner, 0.2});
  for (const LatticeSpring& s : lattice.springs)
    body.springs.push_back({s.a, s.b, norm(lattice.corners[s.b] - lattice.corners[s.a]), 0});
  return body;
}

Body passive(Body body) {
  for (Material& material : body.materials) material.amplitude = 0;
  return body;
}

void relax(Body& body) {
  for (Spring& s : body.springs) s.rest_length = norm(body.masses[s.b].rest - body.masses[s.a].rest);
}

std::vector<Vec3> rest_positions(const Body& body) {
  std::vector<Vec3> places;
  for (const Mass& mass : body.masses) places.push_back(mass.rest);
  return places;
}

Scene full_scene() { return {Gravity{}, Floor{}, Friction{}, Damping{}, Drag{0.05}}; }
Scene walking_scene() { return {Gravity{}, Floor{}, Friction{}, Damping{}, std::nullopt}; }

State resting(const Body& body, const Scene& scene) {
  State state{.position = rest_positions(body)};
  state.velocity.resize(body.masses.size());
  state.start_energy = total_energy(body, state, scene);
  return state;
}

State moving(const Body& body, const Scene& scene, Vec3 velocity) {
  State state = resting(body, scene);
  for (Vec3& v : state.velocity) v = velocity;
  state.start_energy = total_energy(body, state, scene);
  return state;
}

State thrown(const Body& body, const Scene& scene, Vec3 shift, Vec3 velocity) {
  State state = state_at_birth(body, scene);
  for (Vec3& place : state.position) place = place + shift;
  for (Vec3& v : state.velocity) v = velocity;
  state.start_energy = total_energy(body, state, scene);
  return state;
}

State shaken(const Body& body, double speed) {
  State state = resting(body, {});
  for (std::size_t i = 0; i < state.velocity.size(); ++i) {
    const double angle = 1 + 12.9898 * static_cast<double>(i);
    state.velocity[i] = {speed * std::sin(angle), speed * std::sin(2 * angle), speed * std::sin(3 * angle)};
  }
  state.start_energy = total_energy(body, state, {});
  return state;
}

Answer simulate(Simulator& simulator, const Body& body, const State& state, double dt, std::uint64_t steps,
                Recording recording) {
  Answer answer{{}, state};
  answer.task = {.body = &body, .state = &answer.state, .dt = dt, .steps = steps};
  simulator.run({&answer.task, 1}, recording);
  answer.task.state = nullptr;  // this pointer would dangle if the answer were moved
  return answer;
}

Answer simulate(const Body& body, const State& state, const Scene& scene, const Steps& stepping, std::uint64_t steps,
                Recording recording) {
  return simulate(*make_cpu_simulator(scene, stepping, 1), body, state, stepping.dt, steps, recording);
}

Reference reference(const Body& body, State state, const Scene& scene, double dt, std::uint64_t steps) {
  Reference result;
  result.stress.resize(body.springs.size());
  const double start = state.time;
  for (std::uint64_t step = 0; step < steps; ++step) {
    const double t = start + static_cast<double>(step) * dt;
    std::vector<Vec3> force(body.masses.size());
    for (std::size_t i = 0; i < body.springs.size(); ++i) {
      const Spring& s = body.springs[i];
      const Material& m = body.materials[s.material];
      const Vec3 d = state.position[s.b] - state.position[s.a];
      const double angle = 2 * pi * m.frequency * t + m.phase;
      const double pull = m.stiffness * (norm(d) - s.rest_length * (1 + m.amplitude * std::sin(angle)));
      const double rate = s.rest_length * m.amplitude * 2 * pi * m.frequency * std::cos(angle);
      if (norm(d) == 0) continue;
      force[s.a] = force[s.a] + (pull / norm(d)) * d;
      force[s.b] = force[s.b] - (pull / norm(d)) * d;
      result.stress[i] += std::abs(pull) / static_cast<double>(steps);
      result.work += std::max(0.0, -pull * rate) * dt;
    }
    for (std::size_t i = 0; i < body.masses.size(); ++i) {
      const double mass = body.masses[i].mass;
      Vec3& x = state.position[i];
      Vec3& v = state.velocity[i];
      double floor = 0;
      if (scene.gravity) {
        const double angle = pi / 180 * scene.gravity->slope, weight = mass * scene.gravity->acceleration;
        force[i] = force[i] + Vec3{weight * std::sin(angle), 0, -weight * std::cos(angle)};
      }
      if (scene.floor && x.z < 0) floor = -scene.floor->stiffness * x.z;
      force[i].z += floor;
      const double kept = scene.drag ? 1 / (1 + dt * scene.drag->coefficient * norm(v) / mass) : 1;
      v = kept * (v + (dt / mass) * force[i]);
      if (scene.damping) v = std::exp(-scene.damping->rate * dt) * v;
      const double speed = std::hypot(v.x, v.y);
      if (scene.friction && speed > 0) {
        const double left = std::max(0.0, speed - scene.friction->coefficient * floor * dt / mass) / speed;
        v = {left * v.x, left * v.y, v.z};
      }
      x = x + dt * v;
    }
  }
  state.time = start + static_cast<double>(steps) * dt;
  result.state = std::move(state);
  return result;
}

Momentum momentum(const Body& body, const State& state) {
  Momentum sum;
  for (std::size_t i = 0; i < body.masses.size(); ++i) {
    const Vec3 p = body.masses[i].mass * state.velocity[i];
    sum.linear = sum.linear + p;
    sum.angular = sum.angular + cross(state.position[i], p);
    sum.scale += norm(p);
  }
  return sum;
}

bool is_finite(const Task& task, const State& state) {
  double sum = task.work;
  for (const double stress : task.stress) sum += stress;
  for (const Vec3& x : state.position) sum += norm(x);
  for (const Vec3& v : state.velocity) sum += norm(v);
  return std::isfinite(sum);
}

double largest_difference(const State& a, const State& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.position.size(); ++i) largest = std::max(largest, norm(a.position[i] - b.position[i]));
  return largest;
}

bool same_bits(const State& a, const State& b) {
  const auto same = [](const std::vector<Vec3>& u, const std::vector<Vec3>& v) {
    return u.size() == v.size() && (u.empty() || std::memcmp(u.data(), v.data(), u.size() * sizeof(Vec3)) == 0);
  };
  return a.time == b.time && same(a.position, b.position) && same(a.velocity, b.velocity);
}

}  // namespace evodevo::test
