// A rigid floor with restitution, and static friction: single masses, and bodies that stand, fall and bounce.
#include <algorithm>
#include <cmath>
#include <optional>

#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "analysis/stability.hpp"
#include "ways.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

constexpr double g = 9.81;

Floor rigid(double restitution, double roughness = 0) {
  return {.roughness = roughness, .seed = 3, .restitution = restitution};
}

Scene rigid_scene(double restitution) { return {Gravity{}, rigid(restitution), {}, {}, {}}; }

class RigidFloor : public EachWay {
 protected:
  /// Whether a mass that falls freely keeps its energy. The other methods keep their own energy, in which the velocity
  /// is the mean of those before and after the step.
  static bool keeps_energy() { return method() == Method::velocity_verlet || method() == Method::rk4; }

  /// The height (m) to which a mass can rise according to the energy that the method keeps.
  static double reach(const State& state, double dt) {
    const double v = state.velocity[0].z, next = keeps_energy() ? v : v - g * dt;
    return state.position[0].z + v * next / (2 * g);
  }
};

INSTANTIATE_TEST_SUITE_P(Methods, RigidFloor, all_ways(), named);

TEST_P(RigidFloor, ADroppedMassRisesByTheSquareOfTheRestitution) {
  const double h = 0.0731, dt = 0.00013, fall = std::sqrt(2 * h / g), speed = g * fall;
  for (const double e : {0.0, 0.3, 0.7, 1.0}) {
    const Scene scene = rigid_scene(e);
    const Body body = single_mass(0.2, {0, 0, h});
    const auto steps = static_cast<std::uint64_t>(fall * (1 + e) / dt) + 4;  // to the highest point
    const Answer a = simulate_ok(body, resting(body, scene), scene, stepping(dt), steps);
    EXPECT_NEAR(reach(a.state, dt), e * e * h, 2 * speed * dt) << "restitution " << e;
    EXPECT_NEAR(a.state.position[0].z, e * e * h, 2 * speed * dt) << "restitution " << e;
  }
}

TEST_P(RigidFloor, BouncesWithoutLossKeepTheEnergyOfTheMethod) {
  const double h = 0.0731, dt = 0.00047;
  const Body body = single_mass(0.2, {0, 0, h});
  const Scene scene = rigid_scene(1);
  const State start = resting(body, scene);
  const Answer a = simulate_ok(body, start, scene, stepping(dt), 20000);
  EXPECT_NEAR(reach(a.state, dt), reach(start, dt), 20 * rounding() * h) << "after some forty bounces";
}

TEST_P(RigidFloor, AMassComesToRestAndThenStaysWhereItIs) {
  const double dt = 0.00047;
  const Body still = single_mass(0.2), falling = single_mass(0.2, {0, 0, 0.0731});
  for (const double e : {0.0, 0.6, 1.0}) {
    SCOPED_TRACE("restitution " + std::to_string(e));
    const Scene scene = rigid_scene(e);
    const State stayed = simulate(still, resting(still, scene), scene, stepping(dt), 5000).state;
    EXPECT_EQ(stayed.position[0].z, 0);
    EXPECT_EQ(stayed.velocity[0].z, 0);
    if (e == 1) continue;
    const State fallen = simulate(falling, resting(falling, scene), scene, stepping(dt), 4000).state;
    EXPECT_NEAR(fallen.position[0].z, 0, g * dt * dt);
    EXPECT_NEAR(fallen.velocity[0].z, 0, 2 * g * dt);
  }
}

TEST_P(RigidFloor, LetsMassesOutSlowly) {
  for (const double depth : {1e-6, 0.003, 0.4}) {
    const Body body = single_mass(0.2, {0, 0, -depth});
    const Scene scene = rigid_scene(1);
    const Answer a = simulate_ok(body, resting(body, scene), scene, stepping(), 4000);
    EXPECT_GT(a.state.position[0].z, -1e-6);
    EXPECT_LT(reach(a.state, 0.0005), 0.06) << "it leaves with at most 1 m/s";
  }
}

TEST_P(RigidFloor, AHeldMassStaysInside) {
  Body body = single_mass(0, {0, 0, -0.1});
  const Scene scene = rigid_scene(0.5);
  const Answer a = simulate(body, resting(body, scene), scene, stepping(), 100);
  EXPECT_EQ(a.state.position[0].z, single() ? static_cast<double>(-0.1f) : -0.1);
}

TEST_P(RigidFloor, CountsContactFromTheLandingOn) {
  const double h = 0.05, dt = 0.0005;
  for (const double roughness : {0.0, 0.02}) {
    const Scene scene{Gravity{}, rigid(0, roughness), Friction{}, {}, {}};
    const Body body = single_mass(0.2);
    State state = thrown(body, scene, {0, 0, h});
    Task task{.body = &body, .state = &state, .dt = dt, .steps = 1000, .sampled_at = {{1000, {.contact = true}}}};
    make_cpu_simulator(scene, stepping(dt), 1)->run({&task, 1}, {});
    ASSERT_EQ(task.samples.size(), 1u);
    EXPECT_NEAR(static_cast<double>(task.samples[0].contact_steps), 1000 - std::sqrt(2 * h / g) / dt, 2);
  }
}

class BodiesOnARigidFloor : public EachWay {};

INSTANTIATE_TEST_SUITE_P(Methods, BodiesOnARigidFloor, all_ways(), named);

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
  const Steps stepping{method, precision, part * safe_dt(body, scene, method)};
  State end = simulate(body, start, scene, stepping, static_cast<std::uint64_t>(seconds / stepping.dt)).state;
  end.start_energy = start.start_energy;
  return simulate_ok(body, end, scene, stepping, 10, {.tension = true});
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
  State state = thrown(body, scene, {0, 0, 0.02});
  const double start = state.start_energy;
  double highest = 0;
  for (int i = 0; i < 60; ++i) {
    state = simulate_ok(body, state, scene, stepping, 97).state;
    highest = std::max(highest, kept_energy(body, state, stepping));
  }
  return highest / start;
}

TEST_P(BodiesOnARigidFloor, GainNoEnergyFromIt) {
  // at half of the longest step of the springs, and at the step that explicit methods choose
  for (const double e : {0.0, 0.5, 1.0})
    for (std::uint64_t seed = 1; seed < 4; ++seed)
      for (const bool damped : {false, true}) {
        Body body = passive(random_body(40, 8, 5, seed));
        if (damped) body = with_dashpots(body);
        const Scene scene{Gravity{}, rigid(e), {}, {}, {}};
        const std::vector<Vec3> places = state_at_birth(body, scene).position;
        const double half = 0.5 * largest_dt(body, places, Method::paper_euler);
        EXPECT_LT(highest_energy(body, scene, stepping(half)), 1.01) << e << ' ' << damped << ' ' << seed;
        if (!is_explicit(method())) continue;
        const double safe = safe_dt(body, scene, method());
        EXPECT_LT(highest_energy(body, scene, stepping(safe)), 1.01) << e << ' ' << damped << ' ' << seed;
      }
}

TEST_P(BodiesOnARigidFloor, AreLetOutWithoutBeingThrown) {
  const Body body = block(2, {5000, 0, 0, 0});
  Scene scene = walking_scene();
  scene.floor->restitution = 0.5;
  const Answer a = simulate_ok(body, thrown(body, scene, {0, 0, -0.15}), scene, stepping(), 4000);
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
  const Answer a = simulate_ok(body, resting(body, scene), scene, stepping(), 3000);
  EXPECT_NEAR(total_energy(body, a.state, scene), 0.5 * k * depth * depth, 1) << "J";
}

TEST_P(BodiesOnARigidFloor, FallAndSlideAlikeWithAllMethods) {
  const Scene scene{Gravity{g, 25}, rigid(0.3), Friction{0.3}, Damping{5}, {}};
  const Body body = block(2, {10000, 0, 0, 0});
  const State start = thrown(body, scene, {0, 0, 0.01});
  const Answer fine = simulate(body, start, scene, {Method::velocity_verlet, Precision::float64, 0.00001}, 40000);
  const Answer a = simulate_ok(body, start, scene, stepping(0.0001), 4000);
  EXPECT_GT(largest_difference(fine.state, start), 0.05);
  EXPECT_LT(norm(centre_of_mass(body, fine.state.position) - centre_of_mass(body, a.state.position)), 3e-3);
}

TEST_P(BodiesOnARigidFloor, RestInsideTheConeOfFrictionWhateverTheRestitution) {
  const Body body = block(2, {5000, 0, 0, 0, 0.1});
  for (const double e : {0.0, 1.0}) {
    const Scene scene{Gravity{g, 20}, rigid(e), Friction{0.5}, {}, {}};
    const State start = thrown(body, scene, {0, 0, 0.05});
    const Answer landed = simulate_ok(body, start, scene, stepping(0.001), 6000);
    const Answer later = simulate_ok(body, landed.state, scene, stepping(0.001), 6000);
    EXPECT_GT(landed.state.position[0].x - start.position[0].x, 0.01) << "it slides first";
    EXPECT_LT(largest_difference(landed.state, later.state), 1e-4) << e;
  }
}

TEST_P(BodiesOnARigidFloor, HopAlikeWithAllMethods) {
  Body body;
  body.materials = {{1000, 0.2, 4, 0, 0.2}};
  body.masses = {{{0, 0, 0}, 0.2}, {{0, 0, 0.47}, 0.3}};
  body.springs = {{0, 1, 0.5, 0}};
  const Scene scene = rigid_scene(0);
  const State start = thrown(body, scene, {0, 0, 0.03});
  const Answer fine = simulate(body, start, scene, {Method::velocity_verlet, Precision::float64, 0.00001}, 60000);
  ASSERT_GT(fine.state.position[0].z, 0.1) << "it hops";
  const Answer a = simulate_ok(body, start, scene, stepping(0.0001), 6000);
  EXPECT_LT(largest_difference(fine.state, a.state), 5e-3);
}

TEST(ImplicitOnARigidFloor, CarriesBodiesAtLongSteps) {
  // the block keeps its shape at twenty times the longest step of the explicit methods
  const Scene scene{Gravity{}, rigid(0), Friction{}, Damping{}, {}};
  const Body body = block(2, {10000, 0, 0, 0});
  const State start = state_at_birth(body, scene);
  for (const Precision precision : {Precision::float32, Precision::float64}) {
    const double dt = 20 * largest_dt(body, start.position, Method::paper_euler);
    const Answer a = simulate_ok(body, start, scene, {Method::implicit, precision, dt}, 500);
    const Answer fine = simulate(body, start, scene, {Method::implicit, Precision::float64, 0.0005}, 5000);
    EXPECT_NEAR(centre_of_mass(body, a.state.position).z, centre_of_mass(body, fine.state.position).z, 2e-4);
  }
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
