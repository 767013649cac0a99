// The change of energy that each method causes, for a body without damping and drag.
#include "analysis/energy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "analysis/ground.hpp"
#include "analysis/stability.hpp"
#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

std::vector<Vec3> rest_positions(const Body& body) {
  std::vector<Vec3> places;
  for (const Mass& mass : body.masses) places.push_back(mass.rest);
  return places;
}

/// `body` at its rest positions with scattered velocities of at most `speed` m/s along each axis.
State shaken(const Body& body, double speed) {
  State state = resting(body, {});
  for (std::size_t i = 0; i < state.velocity.size(); ++i) {
    const double angle = 1 + 12.9898 * static_cast<double>(i);
    state.velocity[i] = {speed * std::sin(angle), speed * std::sin(2 * angle), speed * std::sin(3 * angle)};
  }
  state.start_energy = total_energy(body, state, {});
  return state;
}

Body passive_body() {
  Body body = random_body(60, 10, 5, 4);
  for (Material& material : body.materials) material.amplitude = 0;
  return body;
}

class Energy : public ::testing::TestWithParam<Method> {};

INSTANTIATE_TEST_SUITE_P(Methods, Energy, ::testing::ValuesIn(all_methods),
                         [](const auto& instance) { return name_of(instance.param); });

/// The factor by which a step of h = omega dt changes the energy of an oscillating spring, on average over its period.
double kept_energy(Method method, double h) {
  switch (method) {
    case Method::rk4:
      return 1 - std::pow(h, 6) / 72 + std::pow(h, 8) / 576;
    case Method::implicit:
    case Method::xpbd:
      return 1 / (1 + h * h);
    default:
      return 1;
  }
}

TEST_P(Energy, OfOneSpringIsWhatTheoryLeaves) {
  const double k = 1000, mass = 0.2, omega = std::sqrt(2 * k / mass);
  const Body body = pair_of_masses(mass, {k, 0, 0, 0}, 1.001);
  for (const double h : {0.1, 0.5, 1.0}) {
    State state = resting(body, {});
    const double before = state.start_energy;
    const bool kept = kept_energy(GetParam(), h) == 1;
    const std::uint64_t steps = kept ? 100000 : 20;
    state = simulate(body, state, {}, {GetParam(), Precision::float64, h / omega}, steps).state;
    const double ratio = total_energy(body, state, {}) / before;
    const double expected = std::pow(kept_energy(GetParam(), h), static_cast<double>(steps));
    // methods without damping conserve a modified energy; the energy oscillates around it, at most between 1/(1 + h/2)
    // and 1/(1 - h/2)
    if (kept)
      EXPECT_TRUE(ratio > (1 - h / 2) / (1 + h / 2) && ratio < (1 + h / 2) / (1 - h / 2)) << ratio << " at " << h;
    else
      EXPECT_NEAR(ratio, expected, 1e-9 * expected) << h;
  }
}

TEST_P(Energy, NeverRisesWithoutMuscles) {
  const Body body = passive_body();
  const double limit = largest_dt(body, rest_positions(body), Method::paper_euler);
  const double factors[] = {0.25, 20};
  for (const Precision precision : {Precision::float32, Precision::float64})
    for (const double factor : factors) {
      if (factor > 1 && is_explicit(GetParam())) continue;
      State state = shaken(body, 1);
      const double before = state.start_energy;
      for (int i = 0; i < 20; ++i) {
        const Answer a = simulate(body, state, {}, {GetParam(), precision, factor * limit}, 100);
        ASSERT_EQ(a.task.status, Status::ok) << a.task.reason;
        state = a.state;
        // explicit methods conserve a modified energy, which differs a little
        EXPECT_LT(total_energy(body, state, {}), (is_explicit(GetParam()) ? 1.1 : 1.0) * before)
            << name_of(precision) << ", " << factor << " of the limit, " << i;
      }
    }
}

class LimitedEnergy : public ::testing::TestWithParam<Method> {};

INSTANTIATE_TEST_SUITE_P(Methods, LimitedEnergy, ::testing::ValuesIn(explicit_methods),
                         [](const auto& instance) { return name_of(instance.param); });

TEST_P(LimitedEnergy, IsBoundedBelowTheLimitOfTheStepAndNotAbove) {
  for (const Body& body : {passive_body(), block(2, {5000, 0, 0, 0})}) {
    const double limit = largest_dt(body, rest_positions(body), GetParam());
    State start = shaken(body, 1e-3);
    start.start_energy *= 100;  // near the limit, energy oscillates far around the conserved, modified energy
    const auto status = [&](double dt) {
      return simulate(body, start, {}, {GetParam(), Precision::float64, dt}, 10000).task.status;
    };
    EXPECT_EQ(status(0.95 * limit), Status::ok);
    EXPECT_EQ(status(1.05 * limit), Status::diverged);
  }
}

class UnlimitedStep : public ::testing::TestWithParam<Method> {};

INSTANTIATE_TEST_SUITE_P(Methods, UnlimitedStep, ::testing::Values(Method::implicit, Method::xpbd),
                         [](const auto& instance) { return name_of(instance.param); });

TEST_P(UnlimitedStep, CarriesAWalkerWhereExplicitMethodsFail) {
  const Body body = random_body(60, 10, 5, 4);
  // one pass of xpbd transmits the weight only through a few springs, which limits the step
  const double factor = GetParam() == Method::implicit ? 20 : 3;
  const double dt = factor * largest_dt(body, rest_positions(body), Method::paper_euler);
  for (const Precision precision : {Precision::float32, Precision::float64})
    for (const Scene& scene : {walking_scene(), full_scene()}) {
      const State start = state_at_birth(body, scene);
      const Answer a = simulate(body, start, scene, {GetParam(), precision, dt}, 2000, {.stress = true, .work = true});
      ASSERT_EQ(a.task.status, Status::ok) << a.task.reason;
      const Box box = bounding_box(a.state.position), at_birth = bounding_box(start.position);
      EXPECT_GT(box.low.z, -0.01);
      EXPECT_GT(box.high.z, 0.8 * at_birth.high.z);
      EXPECT_LT(box.longest_side(), 1.2 * at_birth.longest_side());
    }
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
