// A rigid floor with restitution, and static friction.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "analysis/stability.hpp"
#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

constexpr double g = 9.81;

Floor rigid(double restitution, double roughness = 0) {
  return {.roughness = roughness, .seed = 3, .restitution = restitution};
}

Scene rigid_scene(double restitution) { return {Gravity{}, rigid(restitution), {}, {}, {}}; }

/// A scene with a slope of `slope` degrees.
Scene inclined(double slope, const Floor& floor, Friction friction) {
  return {Gravity{g, slope}, floor, friction, {}, {}};
}

State moving(const Body& body, const Scene& scene, Vec3 velocity) {
  State state = resting(body, scene);
  for (Vec3& v : state.velocity) v = velocity;
  state.start_energy = total_energy(body, state, scene);
  return state;
}

class RigidFloor : public ::testing::TestWithParam<Arithmetic> {
 protected:
  static Method method() { return std::get<Method>(GetParam()); }
  static Precision precision() { return std::get<Precision>(GetParam()); }
  static Steps stepping(double dt = 0.0005) { return {method(), precision(), dt}; }
  static double rounding() { return tolerance(precision()); }

  /// Whether a mass that falls freely keeps its energy. The other methods keep their own energy, in which the velocity
  /// is the mean of those before and after the step.
  static bool keeps_energy() { return method() == Method::velocity_verlet || method() == Method::rk4; }

  /// The height (m) to which a mass can rise according to the energy that the method keeps.
  static double reach(const State& state, double dt) {
    const double v = state.velocity[0].z, next = keeps_energy() ? v : v - g * dt;
    return state.position[0].z + v * next / (2 * g);
  }
};

INSTANTIATE_TEST_SUITE_P(Methods, RigidFloor,
                         ::testing::Combine(::testing::ValuesIn(all_methods),
                                            ::testing::Values(Precision::float32, Precision::float64)),
                         [](const auto& instance) { return name_of(instance.param); });

TEST_P(RigidFloor, ADroppedMassRisesByTheSquareOfTheRestitution) {
  const double h = 0.0731, dt = 0.00013, fall = std::sqrt(2 * h / g), speed = g * fall;
  for (const double e : {0.0, 0.3, 0.7, 1.0}) {
    const Scene scene = rigid_scene(e);
    const Body body = single_mass(0.2, {0, 0, h});
    const auto steps = static_cast<std::uint64_t>(fall * (1 + e) / dt) + 4;  // to the highest point
    const Answer a = simulate(body, resting(body, scene), scene, stepping(dt), steps);
    EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
    EXPECT_NEAR(reach(a.state, dt), e * e * h, 2 * speed * dt) << "restitution " << e;
    EXPECT_NEAR(a.state.position[0].z, e * e * h, 2 * speed * dt) << "restitution " << e;
  }
}

TEST_P(RigidFloor, BouncesWithoutLossKeepTheEnergyOfTheMethod) {
  const double h = 0.0731, dt = 0.00047;
  const Body body = single_mass(0.2, {0, 0, h});
  const Scene scene = rigid_scene(1);
  const State start = resting(body, scene);
  const Answer a = simulate(body, start, scene, stepping(dt), 20000);
  EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
  EXPECT_NEAR(reach(a.state, dt), reach(start, dt), 20 * rounding() * h) << "after some forty bounces";
}

TEST_P(RigidFloor, AMassAtRestStaysWhereItIs) {
  for (const double e : {0.0, 0.6, 1.0}) {
    const Body body = single_mass(0.2);
    const Scene scene = rigid_scene(e);
    const Answer a = simulate(body, resting(body, scene), scene, stepping(0.00047), 5000);
    EXPECT_EQ(a.state.position[0].z, 0) << "restitution " << e;
    EXPECT_EQ(a.state.velocity[0].z, 0) << "restitution " << e;
  }
}

TEST_P(RigidFloor, AMassComesToRest) {
  const double dt = 0.00047;
  const Body body = single_mass(0.2, {0, 0, 0.0731});
  for (const double e : {0.0, 0.6}) {
    const Scene scene = rigid_scene(e);
    const Answer a = simulate(body, resting(body, scene), scene, stepping(dt), 4000);
    EXPECT_NEAR(a.state.position[0].z, 0, g * dt * dt) << "restitution " << e;
    EXPECT_NEAR(a.state.velocity[0].z, 0, 2 * g * dt) << "restitution " << e;
  }
}

TEST_P(RigidFloor, AMassSlidesDownASlopeFasterThanFrictionHolds) {
  const double slope = 30, mu = 0.3, angle = slope * pi / 180, dt = 0.0005;
  const Body body = single_mass(0.2);
  const Scene scene = inclined(slope, rigid(0.4), {mu});
  const Answer a = simulate(body, resting(body, scene), scene, stepping(dt), 2000);
  const double acceleration = g * (std::sin(angle) - mu * std::cos(angle));
  EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
  EXPECT_NEAR(a.state.velocity[0].x, acceleration, 50 * rounding() * acceleration);
  EXPECT_NEAR(a.state.position[0].x, acceleration / 2, (50 * rounding() + dt) * acceleration);
  EXPECT_EQ(a.state.position[0].z, 0);
}

TEST_P(RigidFloor, AMassRestsOnASlopeWithinTheAngleOfFrictionAndOnlyThere) {
  const double mu = 0.5, cone = std::atan(mu) * 180 / pi;
  for (const double slope : {0.999 * cone, -0.999 * cone, 1.01 * cone, -1.01 * cone}) {
    const Body body = single_mass(0.2);
    const Scene scene = inclined(slope, rigid(0), {mu});
    const Answer a = simulate(body, resting(body, scene), scene, stepping(), 1000);
    if (std::abs(slope) < cone)
      EXPECT_EQ(a.state.position[0].x, 0) << slope << " degrees";
    else
      EXPECT_GT(std::copysign(1, slope) * a.state.position[0].x, 1e-3) << slope << " degrees";
  }
}

TEST_P(RigidFloor, StaticFrictionHoldsAMassAtRestAndLetsItSlideOn) {
  const double kinetic = 0.3, held = 0.6, slope = 25, angle = slope * pi / 180;  // between the two angles of friction
  for (const Floor& floor : {rigid(0), Floor{}}) {
    const double sunk = floor.rigid() ? 0 : 0.2 * g * std::cos(angle) / floor.stiffness;
    const Body body = single_mass(0.2, {0, 0, -sunk});
    const Scene scene = inclined(slope, floor, {kinetic, held});
    const Answer still = simulate(body, resting(body, scene), scene, stepping(), 1000);
    EXPECT_EQ(still.state.position[0].x, 0);
    const Answer slid = simulate(body, moving(body, scene, {0.1, 0, 0}), scene, stepping(), 1000);
    const double speed = 0.1 + 0.5 * g * (std::sin(angle) - kinetic * std::cos(angle));
    EXPECT_NEAR(slid.state.velocity[0].x, speed, 1e-3 * speed);
    const Scene steeper = inclined(1.02 * std::atan(held) * 180 / pi, floor, {kinetic, held});
    EXPECT_GT(simulate(body, resting(body, steeper), steeper, stepping(), 1000).state.position[0].x, 1e-3);
  }
}

TEST_P(RigidFloor, StaticFrictionThatIsNotHigherChangesNothing) {
  const Body body = random_body(60, 8, 5, 2);
  Scene scene = walking_scene(), same = scene;
  same.friction->static_coefficient = same.friction->coefficient;
  const State start = state_at_birth(body, scene);
  EXPECT_TRUE(same_bits(simulate(body, start, scene, stepping(), 500).state,
                        simulate(body, start, same, stepping(), 500).state));
}

TEST_P(RigidFloor, TheWholeWeightOfABlockPressesOnIt) {
  // friction stops a sliding block as if its weight were in one mass
  const Scene scene{Gravity{}, rigid(0), Friction{0.5}, Damping{}, {}};
  Scene sliding = scene;
  sliding.damping.reset();
  const Body body = block(2, {10000, 0, 0, 0});
  State start = simulate(body, state_at_birth(body, scene), scene, stepping(), 6000).state;
  EXPECT_GT(bounding_box(start.position).low.z, -1e-9);
  const double from = centre_of_mass(body, start.position).x, v = 1;
  for (Vec3& velocity : start.velocity) velocity = {v, 0, 0};
  start.start_energy = total_energy(body, start, sliding);
  const Answer a = simulate(body, start, sliding, stepping(), 3000);
  EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
  const double distance = v * v / (2 * 0.5 * g);
  EXPECT_NEAR(centre_of_mass(body, a.state.position).x - from, distance, 0.05 * distance);
}

TEST_P(RigidFloor, LetsMassesOutSlowly) {
  for (const double depth : {1e-6, 0.003, 0.4}) {
    const Body body = single_mass(0.2, {0, 0, -depth});
    const Scene scene = rigid_scene(1);
    const Answer a = simulate(body, resting(body, scene), scene, stepping(), 4000);
    EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
    EXPECT_GT(a.state.position[0].z, -1e-6);
    EXPECT_LT(reach(a.state, 0.0005), 0.06) << "it leaves with at most 1 m/s";
  }
}

TEST_P(RigidFloor, AHeldMassStaysInside) {
  Body body = single_mass(0, {0, 0, -0.1});
  const Scene scene = rigid_scene(0.5);
  const Answer a = simulate(body, resting(body, scene), scene, stepping(), 100);
  EXPECT_EQ(a.state.position[0].z, precision() == Precision::float32 ? static_cast<double>(-0.1f) : -0.1);
}

TEST_P(RigidFloor, CountsContactFromTheLandingOn) {
  const double h = 0.05, dt = 0.0005;
  for (const double roughness : {0.0, 0.02}) {
    const Scene scene{Gravity{}, rigid(0, roughness), Friction{}, {}, {}};
    Body body = single_mass(0.2);
    State state = state_at_birth(body, scene);
    state.position[0].z += h;
    state.start_energy = total_energy(body, state, scene);
    Task task{.body = &body, .state = &state, .dt = dt, .steps = 1000, .sampled_at = {{1000, {.contact = true}}}};
    make_cpu_simulator(scene, stepping(dt), 1)->run({&task, 1}, {});
    ASSERT_EQ(task.samples.size(), 1u);
    EXPECT_NEAR(static_cast<double>(task.samples[0].contact_steps), 1000 - std::sqrt(2 * h / g) / dt, 2);
  }
}

/// A point of the ground with a gradient of about `slope`.
Vec3 place_of_slope(const Scene& scene, double slope) {
  const double step = 1e-5;
  for (double x = 0;; x += 1e-3) {
    const Vec3 here{x, 0.3, 0}, right{x + step, 0.3, 0}, behind{x, 0.3 + step, 0};
    const double height = ground_height(scene, here);
    const double gradient =
        std::hypot(ground_height(scene, right) - height, ground_height(scene, behind) - height) / step;
    if (std::abs(gradient - slope) < 0.01 * slope) return {x, 0.3, height};
  }
}

TEST_P(RigidFloor, FrictionOnRoughGroundHoldsAMassInsideTheConeAndOnlyThere) {
  const Scene scene{Gravity{}, rigid(0, 0.05), Friction{0.15}, {}, {}};
  const Body held = single_mass(0.2, place_of_slope(scene, 0.14));
  const Answer a = simulate(held, resting(held, scene), scene, stepping(), 2000);
  EXPECT_LT(norm(a.state.position[0] - held.masses[0].rest), precision() == Precision::float32 ? 1e-6 : 1e-9);
  const Body slipping = single_mass(0.2, place_of_slope(scene, 0.17));
  const Answer b = simulate(slipping, resting(slipping, scene), scene, stepping(), 1000);
  EXPECT_GT(norm(b.state.position[0] - slipping.masses[0].rest), 1e-3);
}

TEST_P(RigidFloor, AMassStaysOnRoughGroundAndGainsNoEnergy) {
  const Scene scene{Gravity{}, rigid(0, 0.05), {}, {}, {}};
  const Body body = single_mass(0.2, place_of_slope(scene, 0.2));
  const State start = resting(body, scene);
  // as on elastic rough ground: the largest deviation of the energy that a first-order method keeps
  const double dt = 0.0001, force = 0.2 * g * scene.floor->steepest();
  double error = dt * force * std::sqrt(2 * g * 2 * scene.floor->roughness) / 2;
  if (method() == Method::implicit && precision() == Precision::float32) error *= 5;  // of the solver
  for (const std::uint64_t steps : {3000u, 10000u, 20000u}) {
    const Answer a = simulate(body, start, scene, stepping(dt), steps);
    EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
    EXPECT_GT(norm(a.state.position[0] - start.position[0]), 0.05);
    EXPECT_GT(a.state.position[0].z - ground_height(scene, a.state.position[0]), -1e-5);
    EXPECT_LT(total_energy(body, a.state, scene), start.start_energy + error);
  }
}

TEST(RigidFloorOfAScene, LimitsNoStep) {
  Scene scene = walking_scene();
  scene.floor->restitution = 0.2;
  EXPECT_EQ(largest_contact_dt(scene, 0.2, Method::paper_euler), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
