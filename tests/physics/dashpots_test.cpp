// Dashpots beside the springs: damping inside the body.
#include <cmath>

#include "analysis/energy.hpp"
#include "analysis/stability.hpp"
#include "ways.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

class Dashpots : public EachWay {};

INSTANTIATE_TEST_SUITE_P(Methods, Dashpots, all_ways(), named);

Body damped_body(double ratio) {
  Body body = random_body(60, 10, 5, 5);
  for (Material& material : body.materials) material = {material.stiffness, 0, 0, 0, ratio};
  return body;
}

TEST(DashpotsOfABody, HaveTheCoefficientOfTheirRatio) {
  Body body = pair_of_masses(0.2, {400, 0, 0, 0, 0.5});
  EXPECT_DOUBLE_EQ(body.damping(body.springs[0]), 2 * 0.5 * std::sqrt(400 * 0.1));
  body.springs[0].stiffness_factor = 4;
  EXPECT_DOUBLE_EQ(body.damping(body.springs[0]), 2 * 0.5 * std::sqrt(1600 * 0.1));
  body.masses[0].mass = 0;
  EXPECT_DOUBLE_EQ(body.damping(body.springs[0]), 2 * 0.5 * std::sqrt(1600 * 0.2)) << "one mass never moves";
  EXPECT_DOUBLE_EQ(mean({1, 0, 0, 0, 0.2}, {1, 0, 0, 0, 0.4}).damping, 0.3);
}

/// The stretch of a spring of two masses that start at rest, relative to that at the start, at time t.
double damped_swing(double omega, double ratio, double t) {
  if (ratio == 1) return (1 + omega * t) * std::exp(-omega * t);
  if (ratio > 1) {
    const double root = omega * std::sqrt(ratio * ratio - 1), decay = ratio * omega;
    return std::exp(-decay * t) * (std::cosh(root * t) + decay / root * std::sinh(root * t));
  }
  const double swing = omega * std::sqrt(1 - ratio * ratio), decay = ratio * omega;
  return std::exp(-decay * t) * (std::cos(swing * t) + decay / swing * std::sin(swing * t));
}

TEST_P(Dashpots, ASpringSwingsAndCreepsAsItsEquationSays) {
  const double k = 400, mass = 0.2, stretch = 0.1, omega = std::sqrt(2 * k / mass), dt = 1e-4;
  for (const double ratio : {0.05, 0.3, 1.0, 3.0}) {
    const Body body = pair_of_masses(mass, {k, 0, 0, 0, ratio}, 1 + stretch);
    for (const std::uint64_t n : {100u, 700u, 2000u}) {
      const Answer a = simulate_ok(body, resting(body, {}), {}, stepping(dt), n);
      const double expected = 1 + stretch * damped_swing(omega, ratio, static_cast<double>(n) * dt);
      EXPECT_NEAR(a.state.position[1].x - a.state.position[0].x, expected,
                  (is_explicit(method()) ? 1 : 4) * stretch * omega * dt + 20 * rounding())
          << ratio << ' ' << n;
    }
  }
}

TEST_P(Dashpots, ConserveMomentum) {
  const Body body = damped_body(0.3);
  const State start = shaken(body, 1);
  const Answer a = simulate_ok(body, start, {}, stepping(1e-4), 500);
  const Momentum before = momentum(body, start), after = momentum(body, a.state);
  EXPECT_LE(norm(after.linear - before.linear), 100 * rounding() * before.scale);
  const bool exact =
      method() == Method::paper_euler || method() == Method::symplectic_euler || method() == Method::velocity_verlet;
  EXPECT_LE(norm(after.angular - before.angular), (exact ? 100 * rounding() : 1e-2) * before.scale);
  EXPECT_LT(total_energy(body, a.state, {}), 0.9 * total_energy(body, start, {})) << "they take energy away";
}

TEST_P(Dashpots, AnExplicitMethodIsStableUpToItsLimitAndNotBeyond) {
  if (!is_explicit(method()) || single()) GTEST_SKIP();
  const double k = 400, mass = 0.2;
  for (const double ratio : {0.02, 0.3, 1.0, 3.0}) {
    const Body body = pair_of_masses(mass, {k, 0, 0, 0, ratio}, 1.001);
    const std::vector<Vec3> positions = rest_positions(body);
    const double limit = largest_dt(body, positions, method());
    EXPECT_NEAR(limit, largest_spring_dt(body.materials[0], mass, method()), 0.03 * limit);
    const auto swings = [&](double dt) {
      const Answer a = simulate(body, resting(body, {}), {}, stepping(dt), 4000);
      return a.task.status == Status::ok ? std::abs(a.state.position[1].x - a.state.position[0].x - 1) : INFINITY;
    };
    EXPECT_LE(swings(0.97 * limit), 0.0011) << ratio;
    // rk4's bound is one for all ratios; velocity-verlet computes its forces anew at every check, which slows the
    // growth
    if (method() != Method::rk4) {
      EXPECT_GT(swings((method() == Method::velocity_verlet ? 1.3 : 1.05) * limit), 0.1) << ratio;
    }
    EXPECT_TRUE(is_stable(body, {}, method(), 0.97 * limit));
    EXPECT_FALSE(is_stable(body, {}, method(), 1.05 * limit));
  }
}

TEST_P(Dashpots, TheLargestStepOfABodyIsBorneAndNearTheLimit) {
  if (!is_explicit(method()) || single()) GTEST_SKIP();
  for (const double ratio : {0.0, 0.02, 0.3, 3.0}) {
    const Body body = damped_body(ratio);
    double limit = 1e-6, beyond = 1;
    while (beyond / limit > 1.001) {
      const double dt = std::sqrt(limit * beyond);
      (is_stable(body, {}, method(), dt) ? limit : beyond) = dt;
    }
    const double dt = largest_dt_in_any_shape(body, {}, method());
    EXPECT_LE(dt, 1.01 * limit) << ratio;
    EXPECT_GE(dt, 0.94 * limit) << ratio;
  }
  for (const double ratio : {0.1, 1.0}) {
    const Body body = damped_body(ratio);
    const double dt = 0.9 * largest_dt(body, rest_positions(body), method());
    EXPECT_LT(dt, largest_dt(damped_body(0), rest_positions(body), method()));
    simulate_ok(body, shaken(body, 1), {}, stepping(dt), 3000);
  }
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
