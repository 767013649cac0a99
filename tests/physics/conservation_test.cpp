// Quantities that internal forces must conserve.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "momentum.hpp"
#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

class Conservation : public ::testing::TestWithParam<Arithmetic> {
 protected:
  static Method method() { return std::get<Method>(GetParam()); }
  static Precision precision() { return std::get<Precision>(GetParam()); }
  static Steps stepping() { return {method(), precision(), 0.0005}; }
};

INSTANTIATE_TEST_SUITE_P(Methods, Conservation,
                         ::testing::Combine(::testing::ValuesIn(all_methods),
                                            ::testing::Values(Precision::float32, Precision::float64)),
                         [](const auto& instance) { return name_of(instance.param); });

TEST_P(Conservation, InternalForcesKeepLinearAndAngularMomentum) {
  const Body body = random_body(150, 12, 5, 3);
  State start = resting(body, {});
  for (std::size_t i = 0; i < start.velocity.size(); ++i) start.velocity[i] = cross({0, 0.4, 1}, start.position[i]);
  const Momentum before = momentum(body, start);
  start.start_energy = total_energy(body, start, {});
  const Answer a = simulate(body, start, {}, stepping(), 2000);
  ASSERT_EQ(a.task.status, Status::ok) << a.task.reason;
  const Momentum after = momentum(body, a.state);
  const double error = precision() == Precision::float32 ? 2e-5 : 1e-13;
  // the method `implicit` uses conjugate gradients, which leave a residual
  const double residual = method() == Method::implicit ? 1e-6 : 0;
  EXPECT_LT(norm(after.linear - before.linear), (error + residual) * after.scale);
  // Explicit methods use forces along the springs at the beginning of a step, which conserves angular momentum; rk4
  // also uses intermediate positions, which causes a fourth-order error. Backward Euler slows a rotation at omega down
  // by omega^2 dt per second, and xpbd by much more if muscles pull.
  const double lost = method() == Method::rk4 ? 1e-6 : method() == Method::implicit ? 2 * 1.16 * 0.0005 : 0;
  if (method() != Method::xpbd) {
    EXPECT_LT(norm(after.angular - before.angular), 2 * (error + lost) * after.scale);
  }
  EXPECT_GT(largest_difference(start, a.state), 0.1);  // the body has moved
}

/// Tests of the methods without numerical damping.
class EnergyConservation : public Conservation {};

INSTANTIATE_TEST_SUITE_P(Methods, EnergyConservation,
                         ::testing::Combine(::testing::ValuesIn(explicit_methods),
                                            ::testing::Values(Precision::float32, Precision::float64)),
                         [](const auto& instance) { return name_of(instance.param); });

TEST_P(EnergyConservation, TheEnergyOfAnUndampedBodyStaysInBounds) {
  Body body = random_body(60, 10, 5, 4);
  for (Material& material : body.materials) material.amplitude = 0;
  State state = resting(body, {});
  for (std::size_t i = 0; i < state.velocity.size(); ++i)
    state.velocity[i] = {std::sin(3.0 * static_cast<double>(i)), 0, 0};
  const double energy = state.start_energy = total_energy(body, state, {});
  for (int second = 0; second < 20; ++second) {
    const Answer a = simulate(body, state, {}, stepping(), 2000);
    ASSERT_EQ(a.task.status, Status::ok) << a.task.reason;
    state = a.state;
    EXPECT_NEAR(total_energy(body, state, {}), energy, 0.05 * energy);
  }
}

TEST_P(Conservation, ABodyAtRestWithoutMusclesStaysAtRestAndIsNeverFlagged) {
  const Body body = block(3, {5000, 0, 0, 0});
  const Answer a = simulate(body, state_at_birth(body, {}), {}, stepping(), 20000);
  EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
  EXPECT_LT(largest_difference(a.state, state_at_birth(body, {})), tolerance(precision()));
}

TEST_P(Conservation, AFlatBodyOnTheFloorIsNeverFlagged) {
  const Scene scene{Gravity{}, Floor{}, {}, {}, {}};
  Body body = random_body(50, 8, 2, 5);
  for (Material& material : body.materials) material.amplitude = 0;
  for (Mass& mass : body.masses) mass.rest.z = 0, mass.mass = 0.2;
  for (Spring& s : body.springs) s.rest_length = norm(body.masses[s.b].rest - body.masses[s.a].rest);
  EXPECT_NEAR(state_at_birth(body, scene).start_energy, 0, 1e-20);
  const Answer a = simulate(body, state_at_birth(body, scene), scene, stepping(), 4000);
  EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
