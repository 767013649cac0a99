// Bodies on a rigid floor: they stand, fall and bounce on their springs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "analysis/stability.hpp"
#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

constexpr double g = 9.81;

Floor rigid(double restitution) { return {.restitution = restitution}; }

class BodiesOnARigidFloor : public ::testing::TestWithParam<Arithmetic> {
 protected:
  static Method method() { return std::get<Method>(GetParam()); }
  static Precision precision() { return std::get<Precision>(GetParam()); }
  static Steps stepping(double dt = 0.0005) { return {method(), precision(), dt}; }
  static double rounding() { return tolerance(precision()); }
};

INSTANTIATE_TEST_SUITE_P(Methods, BodiesOnARigidFloor,
                         ::testing::Combine(::testing::ValuesIn(all_methods),
                                            ::testing::Values(Precision::float32, Precision::float64)),
                         [](const auto& instance) { return name_of(instance.param); });

/// The ways in which a body on springs settles: by uniform damping, or by dashpots.
struct Settling {
  std::optional<Damping> damping;
  double ratio;  ///< damping ratio of the dashpots
};
const Settling settlings[] = {{Damping{20}, 0}, {{}, 0.5}};

/// Simulates a body for `seconds` from where it is, at a part of its safe step. Records the mean forces of its springs.
Answer settled(const Body& body, const Scene& scene, const Arithmetic& arithmetic, double part, double seconds) {
  const State start = resting(body, scene);
  const auto [method, precision] = arithmetic;
  const double dt = part * safe_dt(body, start.position, scene, method);
  Answer a = simulate(body, start, scene, {method, precision, dt}, static_cast<std::uint64_t>(seconds / dt));
  a.state.start_energy = start.start_energy;
  a = simulate(body, a.state, scene, {method, precision, dt}, 10, {.tension = true});
  EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
  return a;
}

/// How much (m) a spring and its dashpot seem to shorten in a step if the foot below them gives way under `force` (N):
/// methods that solve the springs before the floor make errors of this size, which is of first order with a dashpot
/// and of second order without.
double yield(double force, double foot, const Body& body, const Scene& scene, double dt) {
  const double damped_dt = scene.damping ? -std::expm1(-scene.damping->rate * dt) / scene.damping->rate : dt;
  return force / foot * damped_dt * (dt + body.damping(body.springs[0]) / body.stiffness(body.springs[0]));
}

TEST_P(BodiesOnARigidFloor, AMassStandsOnASpringAndAFoot) {
  const double mass = 4, foot = 0.2, k = 5000, weight = mass * g;
  for (const auto& [damping, ratio] : settlings)
    for (const double e : {0.0, 0.5})
      for (const double part : {0.25, 1.0}) {
        Body body;
        body.materials = {{k, 0, 0, 0, ratio}};
        body.masses = {{{0, 0, 0}, foot}, {{0, 0, 0.5}, mass}};
        body.springs = {{0, 1, 0.5, 0}};
        const Scene scene{Gravity{}, rigid(e), Friction{}, damping, {}};
        const Answer a = settled(body, scene, GetParam(), part, 12);
        const double wrong = yield(weight + foot * g, foot, body, scene, a.task.dt);
        const double sag = weight / k + (method() == Method::xpbd ? wrong : 0);
        // implicit holds feet in the equation, to one part in 10,000
        const double near = rounding() + (method() == Method::implicit ? 1.2e-4 * wrong : 0);
        EXPECT_EQ(a.state.position[0].z, 0) << ratio << ' ' << e << ' ' << part;
        EXPECT_NEAR(a.state.position[1].z, 0.5 - sag, near) << ratio << ' ' << e << ' ' << part;
        EXPECT_NEAR(a.task.tension[0], -weight, 2 * k * near) << ratio << ' ' << e << ' ' << part;
      }
}

TEST_P(BodiesOnARigidFloor, AMassStandsOnTwoLegsThatFrictionKeepsFromSpreading) {
  const double mass = 4, k = 5000, half_width = 0.25, height = 0.45, leg = std::hypot(half_width, height);
  const double force = mass * g * leg / (2 * height);
  for (const auto& [damping, ratio] : settlings)
    for (const double part : {0.25, 1.0}) {
      Body body;
      body.materials = {{k, 0, 0, 0, ratio}};
      body.masses = {{{-half_width, 0, 0}, 0.2}, {{half_width, 0, 0}, 0.2}, {{0, 0, height}, mass}};
      body.springs = {{0, 2, leg + force / k, 0}, {1, 2, leg + force / k, 0}};
      const Scene scene{Gravity{}, rigid(0), Friction{1}, damping, {}};
      const Answer a = settled(body, scene, GetParam(), part, 3);
      // friction acts after implicit and xpbd have solved the springs
      const double wrong = is_explicit(method()) ? 0 : yield(force, 0.2, body, scene, a.task.dt);
      const double near = rounding() + (method() == Method::xpbd ? 1.5 : 0.7) * wrong;
      EXPECT_NEAR(a.state.position[0].x, -half_width, near) << ratio << ' ' << part;
      EXPECT_NEAR(a.state.position[2].z, height, near) << ratio << ' ' << part;
      EXPECT_NEAR(a.task.tension[0], -force, 2 * k * near) << ratio << ' ' << part;
    }
}

/// The energy that the method keeps in a smooth motion, J: in the kinetic energy, the squared velocity is replaced by
/// the product of two velocities. These are the velocities before and after the next step without contact (Euler
/// methods), or the velocities of the last and the next drift (velocity-verlet).
double kept_energy(const Body& body, const State& state, const Steps& stepping) {
  const Scene airborne{Gravity{}, {}, {}, {}, {}};
  double energy = total_energy(body, state, airborne);
  const State next = simulate(body, state, airborne, stepping, 1).state;
  for (std::size_t i = 0; i < body.masses.size(); ++i) {
    const Vec3 v = state.velocity[i], drift = (1 / stepping.dt) * (next.position[i] - state.position[i]);
    if (stepping.method == Method::paper_euler || stepping.method == Method::symplectic_euler)
      energy += 0.5 * body.masses[i].mass * dot(v, next.velocity[i] - v);
    if (stepping.method == Method::velocity_verlet)
      energy += 0.5 * body.masses[i].mass * (dot(drift, 2 * v - drift) - dot(v, v));
  }
  return energy;
}

/// Lets a passive body without uniform damping fall by 0.02 m. Returns the largest energy that it has then while it
/// bounces or comes to rest, relative to that at the start.
double highest_energy(const Body& body, const Scene& scene, const Steps& stepping) {
  State state = state_at_birth(body, scene);
  for (Vec3& place : state.position) place.z += 0.02;
  const double start = state.start_energy = total_energy(body, state, scene);
  double highest = 0;
  for (int i = 0; i < 60; ++i) {
    Answer a = simulate(body, state, scene, stepping, 97);
    EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
    state = a.state;
    highest = std::max(highest, kept_energy(body, state, stepping));
  }
  return highest / start;
}

TEST_P(BodiesOnARigidFloor, GainNoEnergyFromIt) {
  // at half of the longest step of the springs, and at the step that explicit methods choose
  for (const double e : {0.0, 0.5, 1.0})
    for (std::uint64_t seed = 1; seed < 4; ++seed)
      for (const bool damped : {false, true}) {
        Body body = random_body(40, 8, 5, seed);
        if (damped) body = with_dashpots(body);
        for (Material& material : body.materials) material.amplitude = 0;
        const Scene scene{Gravity{}, rigid(e), {}, {}, {}};
        const std::vector<Vec3> places = state_at_birth(body, scene).position;
        const double half = 0.5 * largest_dt(body, places, Method::paper_euler);
        EXPECT_LT(highest_energy(body, scene, stepping(half)), 1.01) << e << ' ' << damped << ' ' << seed;
        // where nothing damps, springs gain energy by themselves near their longest step, in the air, too
        if (!is_explicit(method()) || (e == 1 && !damped)) continue;
        const double safe = safe_dt(body, places, scene, method());
        EXPECT_LT(highest_energy(body, scene, stepping(safe)), 1.01) << e << ' ' << damped << ' ' << seed;
      }
}

TEST_P(BodiesOnARigidFloor, AreLetOutWithoutBeingThrown) {
  const Body body = block(2, {5000, 0, 0, 0});
  Scene scene = walking_scene();
  scene.floor->restitution = 0.5;
  State start = state_at_birth(body, scene);
  for (Vec3& position : start.position) position.z -= 0.15;
  start.start_energy = total_energy(body, start, scene);
  const Answer a = simulate(body, start, scene, stepping(), 4000);
  EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
  EXPECT_GT(bounding_box(a.state.position).low.z, -1e-6);
  EXPECT_LT(bounding_box(a.state.position).high.z, 0.21) << "the block is 0.2 m high";
}

TEST_P(BodiesOnARigidFloor, MayBeStrainedByBeingLetOut) {
  // the upper end is held, so that the floor compresses the spring by the whole depth
  const double depth = 0.3, k = 20000;
  Body body;
  body.materials = {{k, 0, 0, 0}};
  body.masses = {{{0, 0, -depth}, 0.2}, {{0, 0, 0.7}, 0}};
  body.springs = {{0, 1, 1.0, 0}};
  const Scene scene{Gravity{}, rigid(0), {}, {}, {}};
  const Answer a = simulate(body, resting(body, scene), scene, stepping(), 3000);
  EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
  EXPECT_NEAR(total_energy(body, a.state, scene), 0.5 * k * depth * depth, 1) << "J";
}

TEST_P(BodiesOnARigidFloor, FallAndSlideAlikeWithAllMethods) {
  const Scene scene{Gravity{g, 25}, rigid(0.3), Friction{0.3}, Damping{5}, {}};
  const Body body = block(2, {10000, 0, 0, 0});
  State start = state_at_birth(body, scene);
  for (Vec3& place : start.position) place.z += 0.01;
  start.start_energy = total_energy(body, start, scene);
  const Answer fine = simulate(body, start, scene, {Method::velocity_verlet, Precision::float64, 0.00001}, 40000);
  const Answer a = simulate(body, start, scene, stepping(0.0001), 4000);
  EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
  EXPECT_GT(largest_difference(fine.state, start), 0.05);
  EXPECT_LT(norm(centre_of_mass(body, fine.state.position) - centre_of_mass(body, a.state.position)), 3e-3);
}

TEST(ImplicitOnARigidFloor, CarriesBodiesAtLongSteps) {
  // the block keeps its shape at twenty times the longest step of the explicit methods
  const Scene scene{Gravity{}, rigid(0), Friction{}, Damping{}, {}};
  const Body body = block(2, {10000, 0, 0, 0});
  const State start = state_at_birth(body, scene);
  for (const Precision precision : {Precision::float32, Precision::float64}) {
    const double dt = 20 * largest_dt(body, start.position, Method::paper_euler);
    const Answer a = simulate(body, start, scene, {Method::implicit, precision, dt}, 500);
    EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
    const Answer fine = simulate(body, start, scene, {Method::implicit, Precision::float64, 0.0005}, 5000);
    EXPECT_NEAR(centre_of_mass(body, a.state.position).z, centre_of_mass(body, fine.state.position).z, 2e-4);
  }
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
