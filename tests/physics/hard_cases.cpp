#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "analysis/stability.hpp"
#include "cases.hpp"

namespace evodevo::test {
namespace {

constexpr double g = 9.81;  // gravitational acceleration, m/s^2

/// The largest stable dt of the method, s; that of paper-euler if the method has no limit.
double limit_of(const Body& body, Method method) {
  return largest_dt(body, rest_positions(body), is_explicit(method) ? method : Method::paper_euler);
}

HardCase from(std::string name, Body body, State start, const Scene& scene, double dt, std::uint64_t steps,
              Outcome outcome = Outcome::right) {
  start.start_energy = total_energy(body, start, scene);
  return {std::move(name), std::move(body), std::move(start), scene, dt, steps, outcome};
}

HardCase from_birth(std::string name, Body body, const Scene& scene, double dt, std::uint64_t steps,
                    Outcome outcome = Outcome::right) {
  State start = state_at_birth(body, scene);
  return from(std::move(name), std::move(body), std::move(start), scene, dt, steps, outcome);
}

Outcome flagged_if(bool so) { return so ? Outcome::flagged : Outcome::right; }

Body with_stiffnesses(double a, double b) {
  Body body = random_body(40, 8, 2, 6);
  body.materials = {{a, 0, 0, 0}, {b, 0, 0, 0}};
  return body;
}

/// Springs of 5,000 and 5e9 N/m, at some thousand times their largest stable step. One pass of xpbd leaves so large a
/// residual that energy grows, but it stays below the guard's bound.
HardCase very_stiff_springs(Method method, Outcome outcome) {
  HardCase c = from_birth("stiffness_ratio_1e6", with_stiffnesses(5000, 5e9), walking_scene(), 0.0005, 4000, outcome);
  if (method == Method::xpbd) c.most_gain = 10;
  return c;
}

HardCase near_the_limit(std::string name, double part, Method method) {
  const Body body = passive(random_body(60, 10, 5, 4));
  HardCase c = from(std::move(name), body, shaken(body, 1e-3), {}, part * limit_of(body, method), 10000,
                    flagged_if(part > 1 && is_explicit(method)));
  // near the limit, energy oscillates around the conserved, modified energy by a factor of (1 + h/2)/(1 - h/2), which
  // is 39 at h = 1.9
  c.most_gain = 40;
  c.start.start_energy *= 100;
  return c;
}

Body with_masses(double a, double b) {
  Body body = passive(random_body(40, 8, 2, 6));
  for (std::size_t i = 0; i < body.masses.size(); ++i) body.masses[i].mass = i % 2 == 0 ? a : b;
  return body;
}

/// Masses of 0.2 kg, all pairs of which are joined by muscles with two phases in turn.
Body joined(const std::array<Vec3, 4>& places) {
  Body body;
  body.materials = {{5000, 0.14, 1, 0}, {5000, 0.14, 1, pi}};
  for (const Vec3& place : places) body.masses.push_back({place, 0.2});
  for (std::uint32_t a = 0; a < 4; ++a)
    for (std::uint32_t b = a + 1; b < 4; ++b) body.springs.push_back({a, b, 0, (a + b) % 2});
  relax(body);
  return body;
}

/// Two positions with two masses each; all pairs of masses are joined by muscles of one phase.
Body coincident_springs() {
  Body body = joined({{{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0, 0}}});
  body.materials[1].phase = 0;
  return body;
}

Body springs_of_no_length() {
  Body body = random_body(20, 6, 5, 1);
  for (Spring& s : body.springs) s.rest_length = 0;
  return body;
}

/// A voxel with one corner pushed through the opposite one.
HardCase inverted_voxel() {
  const Body body = block(1, {5000, 0, 0, 0});
  State start = state_at_birth(body, walking_scene());
  start.position[7] = start.position[0] - Vec3{0.02, 0.02, -0.01};
  return from("inverted_voxel", body, start, walking_scene(), 0.0005, 2000);
}

/// A mirrored block, in which no spring is strained.
HardCase mirrored_block() {
  const Body body = block(2, {5000, 0, 0, 0});
  State start = resting(body, {});
  for (Vec3& x : start.position) x.z = -x.z;
  HardCase c = from("mirrored_block", body, start, {}, 0.0005, 2000);
  c.check = [start](const State& end) { EXPECT_LT(largest_difference(start, end), 1e-4); };
  return c;
}

Body flat_body() {
  Body body = random_body(40, 8, 5, 5);
  for (Mass& mass : body.masses) mass.rest.z = 0, mass.mass = 0.2;
  relax(body);
  return body;
}

/// A row of muscles along `direction`, a unit vector.
Body collinear_body(Vec3 direction) {
  Body body;
  body.materials = {{5000, 0.14, 1, 0}, {5000, 0.14, 1, pi}};
  for (std::uint32_t i = 0; i < 10; ++i) body.masses.push_back({(0.1 * i) * direction, 0.2});
  for (std::uint32_t i = 0; i < 9; ++i) body.springs.push_back({i, i + 1, 0.1, i % 2});
  return body;
}

HardCase lonely_mass() {
  const Scene scene{Gravity{}, {}, {}, {}, {}};
  Body body = random_body(20, 6, 5, 1);
  body.masses.push_back({{0.3, 0.2, 5}, 0.2});
  HardCase c = from("mass_without_springs", body, resting(body, scene), scene, 0.0005, 1000);
  c.check = [](const State& end) {
    EXPECT_NEAR(end.position.back().z, 5 - g * 0.25 / 2, g * 0.5 * 0.0005);
    EXPECT_NEAR(end.position.back().x, 0.3, 1e-6);
  };
  return c;
}

/// A mass pulled along the floor with exactly the largest force of static friction. The other end of the spring is held
/// by a mass of 0 kg.
HardCase at_the_edge_of_sliding() {
  const double k = 100, m = 0.2, stretch = 0.5 * m * g / k;
  Body body = pair_of_masses(m, {k, 0, 0, 0}, 1 + stretch);
  for (Mass& mass : body.masses) mass.rest.z = -m * g / 1e6;
  body.masses[1].mass = 0;
  const Scene scene{Gravity{}, Floor{}, Friction{0.5}, {}, {}};
  HardCase c = from("edge_of_sticking_and_sliding", body, resting(body, scene), scene, 0.0005, 2000);
  c.check = [](const State& end) { EXPECT_NEAR(end.position[0].x, 0, 1e-4); };
  return c;
}

HardCase thrown_down(std::string name, const Scene& scene, double dt, double most_gain, Outcome outcome) {
  const Body body = block(2, {5000, 0, 0, 0});
  const State start = thrown(body, scene, {0, 0, 0.5}, {0, 0, -100});
  HardCase c = from(std::move(name), body, start, scene, dt, static_cast<std::uint64_t>(0.5 / dt), outcome);
  c.most_gain = most_gain;
  return c;
}

Scene on_rigid_floor(double restitution) {
  Scene scene = walking_scene();
  scene.floor->restitution = restitution;
  return scene;
}

/// A mass that bounces on a rigid floor without loss, at a step that is much longer than any elastic floor bears.
HardCase bounces_in_long_steps() {
  const Scene scene{Gravity{}, on_rigid_floor(1).floor, {}, {}, {}};
  const Body body = single_mass(0.1, {0, 0, 0.1});
  return from("rigid_floor_in_long_steps", body, resting(body, scene), scene, 0.009, 60000);
}

HardCase on_a_hard_floor(std::string name, double dt, std::uint64_t steps, Outcome outcome, double most_gain) {
  Scene scene = walking_scene();
  scene.floor = Floor{1e8};
  HardCase c = from_birth(std::move(name), random_body(40, 8, 5, 7), scene, dt, steps, outcome);
  c.most_gain = most_gain;
  return c;
}

/// A foot at rest on a rigid floor, which a spring pushes down with 50 N and its dashpot pulls up with 60 N. Their sum
/// (10 + 2000 t) e^(-100 t) N never pushes down again, so that the body takes off at once, with its whole momentum.
HardCase pulled_up() {
  const double m = 0.2, time = 0.05, dt = 0.0005;
  Body body;
  body.materials = {{1000, 0, 0, 0, 1}};
  body.masses = {{{0, 0, 0}, m}, {{0, 0, 0.45}, m}};
  body.springs = {{0, 1, 0.5, 0}};
  const Scene scene{Gravity{}, on_rigid_floor(0).floor, {}, {}, {}};
  State start = resting(body, scene);
  start.velocity[1].z = 3;
  HardCase c = from("foot_pulled_up_by_a_dashpot", body, start, scene, dt, static_cast<std::uint64_t>(time / dt));
  c.check = [body, m, time](const State& end) {
    EXPECT_NEAR(momentum(body, end).linear.z, 3 * m - 2 * m * g * time, 0.003) << "kg m/s";
  };
  return c;
}

/// A mass that hits a rigid floor while it slides, without gravity. Coulomb's law of impact: the floor's impulse (1 +
/// e) m v slows the mass down by the coefficient of sliding, however high that of a mass at rest is.
HardCase sliding_impact(double restitution) {
  const Scene scene{{}, on_rigid_floor(restitution).floor, Friction{0.3, 0.9}, {}, {}};
  const Body body = single_mass(0.2, {0, 0, 0.3});
  const State start = moving(body, scene, {1.2, -1.6, -3});
  HardCase c = from("sliding_impact", body, start, scene, 0.0005, 400);
  c.check = [restitution](const State& end) {
    const double left = (2 - 0.3 * (1 + restitution) * 3) / 2;
    EXPECT_NEAR(end.velocity[0].x, left * 1.2, 1e-3) << restitution;
    EXPECT_NEAR(end.velocity[0].y, left * -1.6, 1e-3) << restitution;
    EXPECT_NEAR(end.velocity[0].z, restitution * 3, 1e-3) << restitution;
  };
  return c;
}

/// A light mass between six short springs along the axes, which muscles stretch to many times their length. At rest,
/// each spring is stiff in its own direction; stretched, in all directions, which raises the highest frequency by
/// sqrt(3).
HardCase stretched_star(Method method) {
  constexpr double rest = 0.001;  // m
  Body body;
  body.materials = {{4000, 0, 0, 0}, {5000, 0.14, 1, pi}};
  body.masses = {{{}, 0.05}};
  for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
    for (const double side : {-1.0, 1.0}) {
      const auto n = static_cast<std::uint32_t>(body.masses.size());
      body.masses.push_back({side * rest * axis, 0.2});
      body.masses.push_back({side * (1 + rest) * axis, 5});
      body.springs.push_back({0, n, rest, 0});
      body.springs.push_back({n, n + 1, 1, 1});
    }
  const double dt = safe_dt(body, {}, is_explicit(method) ? method : Method::paper_euler);
  return from_birth("stretched_star", body, {}, dt, static_cast<std::uint64_t>(10 / dt));
}

HardCase fast_muscles(std::string name, double frequency) {
  Body body = random_body(40, 8, 5, 7);
  for (Material& material : body.materials) material.frequency = frequency;
  return from_birth(std::move(name), body, walking_scene(), 0.0005, 4000, Outcome::right_or_flagged);
}

/// Four masses joined by muscles, which walk for ten minutes.
HardCase ten_minutes() {
  const Body body = joined({{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}}});
  Scene scene = walking_scene();
  scene.floor = Floor{1e5};
  HardCase c = from_birth("ten_minutes", body, scene, 0.001, 600000);
  c.check = [](const State& end) { EXPECT_GT(bounding_box(end.position).low.z, -0.01) << "it lies on the floor"; };
  return c;
}

/// A mass that gains speed in each bounce on the floor, because the time step is too long for that floor.
HardCase pumped_by_the_floor(Method method) {
  const Scene scene{Gravity{}, Floor{}, {}, {}, {}};
  const Body body = single_mass(0.1, {0, 0, 0.1});
  const double dt = (method == Method::rk4 ? 2.6 : 1.9) * std::sqrt(0.1 / 1e6);
  return from("energy_from_the_floor", body, resting(body, scene), scene, dt, 60000, flagged_if(is_explicit(method)));
}

HardCase not_a_number(std::string name, double number) {
  const Body body = random_body(20, 6, 5, 1);
  HardCase c = from_birth(std::move(name), body, walking_scene(), 0.0005, 300, Outcome::flagged);
  c.start.velocity[7].y = number;
  return c;
}

void expect_right(const HardCase& c, const Task& task, const State& end, double rounding) {
  EXPECT_DOUBLE_EQ(end.time, c.dt * static_cast<double>(c.steps));
  EXPECT_EQ(task.stress.size(), c.body.springs.size());
  EXPECT_GE(task.work, 0);
  EXPECT_TRUE(is_finite(task, end));
  const double given = total_energy(c.body, c.start, c.scene) + task.work;
  EXPECT_LE(total_energy(c.body, end, c.scene), c.most_gain * given + rounding) << "of " << given << " J";
  c.check(end);
}

void expect_flagged(const HardCase& c, const Task& task) {
  EXPECT_EQ(task.status, Status::diverged);
  EXPECT_FALSE(task.reason.empty());
  EXPECT_GT(task.ended_at, 0);
  EXPECT_LE(task.ended_at, c.dt * static_cast<double>(c.steps) * (1 + 1e-12));
  EXPECT_TRUE(task.stress.empty());
  EXPECT_EQ(task.work, 0);
}

/// Another body in the batch of a case.
struct Neighbour {
  Body body;
  State state;
  Task task() { return {.body = &body, .state = &state, .dt = 0.0005, .steps = 250}; }
};

void expect_outcome(const HardCase& c, Simulator& simulator, double rounding) {
  constexpr Recording all{.stress = true, .work = true};
  const Body first = random_body(30, 6, 5, 1), second = random_body(30, 6, 5, 2);
  std::vector<Neighbour> alone{{first, state_at_birth(first, c.scene)}, {second, state_at_birth(second, c.scene)}};
  std::vector<Neighbour> beside = alone;
  State state = c.start;
  std::vector<Task> batch{
      beside[0].task(), {.body = &c.body, .state = &state, .dt = c.dt, .steps = c.steps}, beside[1].task()};
  simulator.run(batch, all);
  for (std::size_t i = 0; i < 2; ++i) {
    Task task = alone[i].task();
    simulator.run({&task, 1}, all);
    EXPECT_TRUE(same_bits(alone[i].state, beside[i].state)) << "a neighbour was perturbed";
    EXPECT_EQ(task.status, batch[2 * i].status);
    EXPECT_EQ(task.stress, batch[2 * i].stress);
  }
  const Task& task = batch[1];
  if (task.status == Status::ok) {
    EXPECT_NE(c.outcome, Outcome::flagged) << "went unnoticed";
    expect_right(c, task, state, rounding);
  } else {
    EXPECT_NE(c.outcome, Outcome::right) << task.reason << " at " << task.ended_at << " s";
    expect_flagged(c, task);
  }
}

/// Two masses of 0.2 kg joined by a muscle that is `length` m long, has the amplitude `amplitude`, and is driven at
/// resonance.
Body resonant_pair(double length, double amplitude) {
  Body body = pair_of_masses(0.2, {5000, amplitude, std::sqrt(2 * 5000 / 0.2) / (2 * pi), 0}, length);
  body.springs[0].rest_length = length;
  return body;
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

std::vector<HardCase> hard_cases(Method method) {
  const bool limited = is_explicit(method);
  const Scene walking = walking_scene();
  Body coincident = random_body(20, 6, 5, 1);
  coincident.masses[7].rest = coincident.masses[3].rest;
  relax(coincident);
  const Body heavy = with_masses(0.2, 2e5);
  const Outcome beyond = limited ? Outcome::flagged : Outcome::right_or_flagged;

  return {
      near_the_limit("step_of_0.95_of_the_limit", 0.95, method),
      near_the_limit("step_of_1.05_of_the_limit", 1.05, method),
      from_birth("stiffness_ratio_1e-6", with_stiffnesses(5000, 0.005), walking, 0.0005, 4000),
      very_stiff_springs(method, beyond),
      from("mass_ratio_1e6", heavy, shaken(heavy, 0.1), {}, 0.0005, 4000),
      from_birth("mass_ratio_1e-6", with_masses(0.2, 2e-7), walking, 0.0005, 4000, beyond),
      on_a_hard_floor("floor_1e8", 0.0005, 2000, limited ? Outcome::right_or_flagged : Outcome::right, 10),
      on_a_hard_floor("floor_1e8_within_its_step", 1.2 * std::sqrt(0.1 / 1e8), 20000, Outcome::right, 1.05),
      from_birth("springs_of_no_length", springs_of_no_length(), {}, 0.00025, 4000),
      from_birth("coincident_springs", coincident_springs(), walking, 0.0005, 4000),
      from_birth("coincident_masses", coincident, walking, 0.0005, 4000),
      inverted_voxel(),
      mirrored_block(),
      from_birth("flat_body_on_the_floor", flat_body(), walking, 0.0005, 4000),
      from_birth("collinear_body", collinear_body({1, 0, 0}), walking, 0.0005, 4000),
      from_birth("collinear_body_upright", collinear_body({0, 0, 1}), walking, 0.0005, 4000),
      lonely_mass(),
      at_the_edge_of_sliding(),
      thrown_down("thrown_at_100_m_per_s", walking, 0.0005, 10, Outcome::right_or_flagged),
      thrown_down("thrown_at_100_m_per_s_in_small_steps", walking, 0.00005, 1.05, Outcome::right),
      thrown_down("thrown_at_100_m_per_s_on_a_rigid_floor", on_rigid_floor(0.8), 0.0005, 1.05, Outcome::right),
      bounces_in_long_steps(),
      fast_muscles("muscles_of_1999_Hz", 1999),
      fast_muscles("muscles_of_700_Hz", 700),
      fast_muscles("muscles_of_1_MHz", 1e6 + 3),
      pulled_up(),
      sliding_impact(0),
      sliding_impact(0.5),
      sliding_impact(1),
      stretched_star(method),
      ten_minutes(),
      pumped_by_the_floor(method),
      not_a_number("velocity_nan", std::numeric_limits<double>::quiet_NaN()),
      not_a_number("velocity_infinite", -std::numeric_limits<double>::infinity()),
  };
}

void expect_outcomes(const std::vector<HardCase>& cases, const SimulatorFactory& simulator_for, double rounding) {
  for (const HardCase& c : cases) {
    SCOPED_TRACE(c.name);
    expect_outcome(c, *simulator_for(c.scene), rounding);
  }
}

void expect_resonance_to_live(const SimulatorFactory& simulator_for, Method method) {
  const auto simulator = simulator_for({});
  const double truth = energy_at_resonance(1, 0.05, 0.1), strain = 0.5 * 5000 * 0.1 * 0.1;
  ASSERT_GT(truth, 10 * strain);
  const Body linear = resonant_pair(1, 0.05);
  const Answer early = simulate(*simulator, linear, resting(linear, {}), 0.0001, 1000);
  EXPECT_EQ(early.task.status, Status::ok) << early.task.reason;
  if (is_explicit(method)) {
    EXPECT_NEAR(total_energy(linear, early.state, {}), truth, 0.05 * truth);
  }
  // long enough for the masses to fly through each other repeatedly
  const Body wild = resonant_pair(0.5, 0.14);
  for (const Recording recording : {Recording{}, Recording{.stress = true, .work = true}}) {
    const Answer late = simulate(*simulator, wild, resting(wild, {}), 0.0005, 4000, recording);
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
    ended += simulate(*simulator, body, birth, 0.0005, 10000).task.status == Status::diverged;
    const Answer healthy = simulate(*simulator, body, birth, 0.0001, 10000);
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
  const Answer once = simulate(*simulator, body, start, 0.0003, 900);
  State state = start;
  for (const std::uint64_t steps : {250u, 0u, 50u, 600u})
    state = simulate(*simulator, body, state, 0.0003, steps).state;
  const double expected = std::pow(std::sqrt(start.start_energy) + 900 * 0.0003 * std::sqrt(sum / 2), 2);
  EXPECT_NEAR(once.state.start_energy, expected, 1e-9 * expected);
  EXPECT_NEAR(state.start_energy, expected, 1e-9 * expected);

  State other = start;
  other.start_energy = 0.3;
  EXPECT_EQ(simulate(*simulator, passive(body), other, 0.0003, 900).state.start_energy, 0.3);
}

}  // namespace evodevo::test
