// The simulator compared with closed-form solutions.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>

#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

constexpr double g = 9.81;

class ClosedForm : public ::testing::TestWithParam<Arithmetic> {
 protected:
  static Method method() { return std::get<Method>(GetParam()); }
  static Precision precision() { return std::get<Precision>(GetParam()); }
  static Steps stepping(double dt = 0.0005) { return {method(), precision(), dt}; }
  static double rounding() { return tolerance(precision()); }
};

INSTANTIATE_TEST_SUITE_P(Methods, ClosedForm,
                         ::testing::Combine(::testing::ValuesIn(all_methods),
                                            ::testing::Values(Precision::float32, Precision::float64)),
                         [](const auto& instance) { return name_of(instance.param); });

Scene gravity_only() { return {Gravity{}, {}, {}, {}, {}}; }
Scene gravity_and_floor() { return {Gravity{}, Floor{}, {}, {}, {}}; }

State moving(const Body& body, const Scene& scene, Vec3 velocity) {
  State state = resting(body, scene);
  for (Vec3& v : state.velocity) v = velocity;
  state.start_energy = total_energy(body, state, scene);
  return state;
}

TEST_P(ClosedForm, FreeFallIsThatOfTheMethod) {
  const Body body = single_mass(0.2, {1, 2, 100});
  const std::uint64_t n = 2000;
  const Answer a = simulate(body, moving(body, gravity_only(), {3, 0, 4}), gravity_only(), stepping(), n);
  const double t = 1, dt = 0.0005;
  EXPECT_EQ(a.task.status, Status::ok);
  EXPECT_NEAR(a.state.velocity[0].z, 4 - g * t, 30 * rounding());
  // methods with x <- x + dt v and the new v fall g t dt / 2 further than g t^2 / 2; the other methods are exact
  const bool exact = method() == Method::velocity_verlet || method() == Method::rk4;
  EXPECT_NEAR(a.state.position[0].z, 100 + 4 * t - g * t * (t + (exact ? 0 : dt)) / 2, 1000 * rounding());
  EXPECT_NEAR(a.state.position[0].x, 1 + 3 * t, 100 * rounding());
  EXPECT_DOUBLE_EQ(a.state.position[0].y, 2);
}

TEST_P(ClosedForm, FallingFarIsNoDivergence) {
  const Body body = single_mass(0.2);
  const Answer a = simulate(body, state_at_birth(body, gravity_only()), gravity_only(), stepping(), 20000);
  EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
  EXPECT_NEAR(a.state.velocity[0].z, -98.1, 0.05);
}

/// The stretch of a spring that starts at rest, relative to its initial stretch, after n steps of h = omega dt.
double discrete_swing(Method method, double h, double n) {
  using namespace std::complex_literals;
  const double theta = std::acos(1 - h * h / 2);
  switch (method) {
    case Method::paper_euler:
    case Method::symplectic_euler:
      return std::cos((n + 0.5) * theta) / std::cos(theta / 2);
    case Method::velocity_verlet:
      return std::cos(n * theta);
    case Method::rk4:
      return std::pow(1.0 + 1i * h - h * h / 2 - 1i * h * h * h / 6.0 + h * h * h * h / 24, n).real();
    case Method::implicit:
    case Method::xpbd:  // equals backward Euler for a single spring
      return std::pow(1.0 / (1.0 - 1i * h), n).real();
  }
  return std::numeric_limits<double>::quiet_NaN();
}

TEST_P(ClosedForm, ASpringSwingsAsItsMethodDoes) {
  const double k = 4000, mass = 0.2, dt = 0.0005, stretch = 0.01;
  const double omega = std::sqrt(2 * k / mass);
  for (const double factor : {1.0, 0.3}) {
    Body body = pair_of_masses(mass, {k / factor, 0, 0, 0}, 1 + stretch);
    body.springs[0].stiffness_factor = factor;
    for (const std::uint64_t n : {1u, 10u, 63u, 500u}) {
      const Answer a = simulate(body, resting(body, {}), {}, stepping(dt), n);
      const double expected = 1 + stretch * discrete_swing(method(), omega * dt, static_cast<double>(n));
      EXPECT_NEAR(a.state.position[1].x - a.state.position[0].x, expected, 2 * rounding()) << n << " steps";
    }
  }
}

TEST_P(ClosedForm, ADrivenSpringFollowsItsEquation) {
  const double k = 500, mass = 0.2, dt = 0.0001, amplitude = 0.1, frequency = 2, phase = 0.7;
  const Body body = pair_of_masses(mass, {k, amplitude, frequency, phase});
  const double omega = std::sqrt(2 * k / mass), drive = 2 * pi * frequency;
  const double c = amplitude * omega * omega / (omega * omega - drive * drive);
  const Answer a = simulate(body, resting(body, {}), {}, stepping(dt), 7000);
  const double t = 0.7;
  const double stretch = c * (std::sin(drive * t + phase) - std::sin(phase) * std::cos(omega * t) -
                              drive / omega * std::cos(phase) * std::sin(omega * t));
  const double error = is_explicit(method()) ? 1e-3 : 2e-2;  // the others damp, which is a first-order error
  EXPECT_NEAR(a.state.position[1].x - a.state.position[0].x, 1 + stretch, error);
}

TEST_P(ClosedForm, LateTimesKeepTheirPhase) {
  // after 10^6 periods of the muscle, the drive is the same as at birth
  const Body body = pair_of_masses(0.2, {500, 0.1, 2, 0.3});
  State late = resting(body, {});
  late.time = 500000;
  const Answer young = simulate(body, resting(body, {}), {}, stepping(), 500);
  const Answer old = simulate(body, late, {}, stepping(), 500);
  EXPECT_LT(largest_difference(young.state, old.state), precision() == Precision::float32 ? 1e-6 : 1e-8);
  EXPECT_EQ(old.state.time, 500000.25);
}

TEST_P(ClosedForm, DragEndsInTheTerminalVelocity) {
  const Scene scene{Gravity{}, {}, {}, {}, Drag{0.8}};
  const Body body = single_mass(0.2);
  const Answer a = simulate(body, resting(body, scene), scene, stepping(), 6000);
  const double error = 10 * rounding() + (method() == Method::velocity_verlet ? 1e-5 : 0);  // a second-order error
  EXPECT_NEAR(a.state.velocity[0].z, -std::sqrt(0.2 * g / 0.8), error);
}

TEST_P(ClosedForm, DragPointsAgainstTheVelocity) {
  const Scene scene{{}, {}, {}, {}, Drag{0.5}};
  const Body body = single_mass(0.2);
  const Answer a = simulate(body, moving(body, scene, {3, -4, 12}), scene, stepping(), 2000);
  const Vec3 v = a.state.velocity[0];
  EXPECT_NEAR(norm(v), 13 / (1 + 13 * 0.5 / 0.2), 1e-3);  // v0 / (1 + v0 c t / m), first order in dt
  EXPECT_NEAR(v.y / v.x, -4.0 / 3, 100 * rounding());
  EXPECT_NEAR(v.z / v.x, 4, 100 * rounding());
}

TEST_P(ClosedForm, DampingIsAnExactDecay) {
  const Scene scene{{}, {}, {}, Damping{3}, {}};
  const Body body = single_mass(0.2);
  for (const double dt : {0.0005, 0.002}) {
    const auto steps = static_cast<std::uint64_t>(std::lround(0.5 / dt));
    const Answer a = simulate(body, moving(body, scene, {1, 2, -2}), scene, stepping(dt), steps);
    // rk4 integrates damping like a force; the other methods apply its exact factor
    const double error = 10 * rounding() + (method() == Method::rk4 ? 1e-10 : 0);
    EXPECT_NEAR(norm(a.state.velocity[0]), 3 * std::exp(-1.5), error) << "dt " << dt;
  }
}

TEST_P(ClosedForm, AMassAtRestSinksByItsWeightOverTheFloorsStiffness) {
  const Scene scene{Gravity{}, Floor{2e4}, {}, Damping{}, {}};
  const Body body = single_mass(0.2);
  const Answer a = simulate(body, state_at_birth(body, scene), scene, stepping(), 6000);
  EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
  EXPECT_NEAR(a.state.position[0].z, -0.2 * g / 2e4, 1e-9);
}

TEST_P(ClosedForm, ABlockAtRestStandsOnItsLowerMasses) {
  const Body body = block(2, {10000, 0, 0, 0});
  const Answer a = simulate(body, state_at_birth(body, walking_scene()), walking_scene(), stepping(), 10000);
  EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
  double push = 0;
  for (const Vec3& x : a.state.position) push += 1e6 * std::max(0.0, -x.z);
  EXPECT_NEAR(push, 27 * 0.2 * g, 1e-3 * 27 * 0.2 * g);
}

TEST_P(ClosedForm, ASlidingMassStopsAfterItsStoppingDistance) {
  const Scene scene{Gravity{}, Floor{}, Friction{0.4}, {}, {}};
  const Body body = single_mass(0.2, {0, 0, -0.2 * g / 1e6});
  const double v = 1.5;
  const Answer a = simulate(body, moving(body, scene, {0.6 * v, 0.8 * v, 0}), scene, stepping(), 2000);
  const double distance = v * v / (2 * 0.4 * g);
  // velocity-verlet and rk4 are exact except in the last step
  const bool exact = method() == Method::velocity_verlet || method() == Method::rk4;
  const double error = (exact ? 0.1 : 1) * v * 0.0005;
  EXPECT_NEAR(a.state.position[0].x, 0.6 * distance, error);
  EXPECT_NEAR(a.state.position[0].y, 0.8 * distance, error);
  EXPECT_EQ(a.state.velocity[0].x, 0);
  EXPECT_EQ(a.state.velocity[0].y, 0);
}

TEST_P(ClosedForm, ASlidingBlockStopsAfterItsStoppingDistance) {
  const Scene scene{Gravity{}, Floor{}, Friction{0.5}, {}, {}};
  const Body body = block(2, {10000, 0, 0, 0});
  State start = simulate(body, state_at_birth(body, walking_scene()), walking_scene(), stepping(), 6000).state;
  const double from = centre_of_mass(body, start.position).x, v = 1;
  for (Vec3& velocity : start.velocity) velocity = {v, 0, 0};
  start.start_energy = total_energy(body, start, scene);
  const Answer a = simulate(body, start, scene, stepping(), 3000);
  EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
  const double distance = v * v / (2 * 0.5 * g);
  EXPECT_NEAR(centre_of_mass(body, a.state.position).x - from, distance, 0.05 * distance);
}

/// A mass on the floor, pulled along x by a spring with the force `force` (N). The other end of the spring is held by a
/// mass of 0 kg.
Body drawn_mass(double force) {
  const double k = 100;
  Body body = pair_of_masses(0.2, {k, 0, 0, 0}, 1 + force / k);
  for (Mass& mass : body.masses) mass.rest.z = -0.2 * g / 1e6;
  body.masses[1].mass = 0;
  return body;
}

TEST_P(ClosedForm, FrictionHoldsInsideTheConeAndOnlyThere) {
  const Scene scene{Gravity{}, Floor{}, Friction{0.5}, {}, {}};
  const double cone = 0.5 * 0.2 * g;
  const Body held = drawn_mass(0.99 * cone), slipping = drawn_mass(1.01 * cone);
  const Answer a = simulate(held, resting(held, scene), scene, stepping(), 2000);
  EXPECT_EQ(a.state.position[0].x, 0);
  EXPECT_EQ(a.state.velocity[0].x, 0);
  const Answer b = simulate(slipping, resting(slipping, scene), scene, stepping(), 200);
  EXPECT_GT(b.state.position[0].x, 1e-5);
  EXPECT_EQ(b.state.position[1].x,
            static_cast<double>(precision() == Precision::float32 ? static_cast<float>(slipping.masses[1].rest.x)
                                                                  : slipping.masses[1].rest.x));
}

/// A scene with a slope of `slope` degrees.
Scene inclined(double slope, double friction) { return {Gravity{g, slope}, Floor{}, Friction{friction}, {}, {}}; }

TEST_P(ClosedForm, AMassGoesDownASlopeFasterThanFrictionHolds) {
  const double slope = 30, mu = 0.3, dt = 0.0005, angle = slope * pi / 180;
  const Body body = single_mass(0.2, {0, 0, -0.2 * g * std::cos(angle) / 1e6});
  const Scene scene = inclined(slope, mu);
  const Answer a = simulate(body, resting(body, scene), scene, stepping(dt), 2000);
  const double acceleration = g * (std::sin(angle) - mu * std::cos(angle));
  EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
  EXPECT_NEAR(a.state.velocity[0].x, acceleration, 1e-3 * acceleration);
  EXPECT_NEAR(a.state.position[0].x, acceleration / 2, (1e-3 + dt) * acceleration);
  EXPECT_EQ(a.state.position[0].y, 0);
}

TEST_P(ClosedForm, AMassRestsOnASlopeWithinTheAngleOfFrictionAndOnlyThere) {
  const double mu = 0.5, cone = std::atan(mu) * 180 / pi;
  for (const double slope : {0.99 * cone, -0.99 * cone, 1.01 * cone, -1.01 * cone}) {
    const Body body = single_mass(0.2, {0, 0, -0.2 * g * std::cos(slope * pi / 180) / 1e6});
    const Scene scene = inclined(slope, mu);
    const Answer a = simulate(body, resting(body, scene), scene, stepping(), 1000);
    if (std::abs(slope) < cone)
      EXPECT_EQ(a.state.position[0].x, 0) << slope << " degrees";
    else
      EXPECT_GT(std::copysign(1, slope) * a.state.position[0].x, 1e-3) << slope << " degrees";
  }
}

TEST_P(ClosedForm, ABlockGoesDownASlopeFasterThanFrictionHolds) {
  const double slope = 35, mu = 0.5, angle = slope * pi / 180, t = 0.5;
  const Body body = block(2, {10000, 0, 0, 0});
  const Scene scene = inclined(slope, mu);
  State start = simulate(body, state_at_birth(body, walking_scene()), walking_scene(), stepping(), 6000).state;
  const double from = centre_of_mass(body, start.position).x;
  start.start_energy = total_energy(body, start, scene);
  const Answer a = simulate(body, start, scene, stepping(), 1000);
  EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
  const double distance = g * (std::sin(angle) - mu * std::cos(angle)) * t * t / 2;
  EXPECT_NEAR(centre_of_mass(body, a.state.position).x - from, distance, 0.05 * distance);
}

TEST_P(ClosedForm, ABlockRestsOnASlopeWithinTheAngleOfFriction) {
  const Body body = block(2, {10000, 0, 0, 0});
  Scene scene = inclined(0.9 * std::atan(0.5) * 180 / pi, 0.5);
  scene.damping.emplace();
  const Answer settled = simulate(body, state_at_birth(body, scene), scene, stepping(), 6000);
  const Answer later = simulate(body, settled.state, scene, stepping(), 2000);
  EXPECT_EQ(later.task.status, Status::ok) << later.task.reason;
  EXPECT_LT(largest_difference(settled.state, later.state), 1e-5);
}

TEST_P(ClosedForm, GoingFarDownASlopeIsNoDivergence) {
  const double angle = 20 * pi / 180;
  const Body body = single_mass(0.2, {0, 0, -0.2 * g * std::cos(angle) / 1e6});
  const Scene scene{Gravity{g, 20}, Floor{}, {}, {}, {}};
  const State start = resting(body, scene);
  const Answer a = simulate(body, start, scene, stepping(), 20000);
  EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
  EXPECT_NEAR(a.state.velocity[0].x, 10 * g * std::sin(angle), 0.05);
  const double kinetic = 0.1 * std::pow(norm(a.state.velocity[0]), 2);
  EXPECT_NEAR(total_energy(body, a.state, scene), start.start_energy, 1e-3 * kinetic) << "what it fell is what it has";
}

TEST_P(ClosedForm, FrictionNeedsAFloor) {
  const Scene scene{Gravity{}, {}, Friction{0.5}, {}, {}};
  const Body body = single_mass(0.2, {0, 0, -1});
  const Answer a = simulate(body, moving(body, scene, {1, 0, 0}), scene, stepping(), 100);
  EXPECT_EQ(a.state.velocity[0].x, 1);
}

/// Tests of the methods without numerical damping.
class LossFreeClosedForm : public ClosedForm {};

INSTANTIATE_TEST_SUITE_P(Methods, LossFreeClosedForm,
                         ::testing::Combine(::testing::ValuesIn(explicit_methods),
                                            ::testing::Values(Precision::float32, Precision::float64)),
                         [](const auto& instance) { return name_of(instance.param); });

TEST_P(LossFreeClosedForm, ABounceComesBackAsHigh) {
  const Body body = single_mass(0.2, {0, 0, 0.05});
  const Answer a = simulate(body, resting(body, gravity_and_floor()), gravity_and_floor(), stepping(0.0001), 40000);
  EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
  const double height = a.state.position[0].z + std::pow(norm(a.state.velocity[0]), 2) / (2 * g);
  EXPECT_GT(height, 0.03);
  EXPECT_LT(height, 0.08);
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
