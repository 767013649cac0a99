// Quantities that internal forces conserve, and the change of energy that each method causes.
#include "analysis/energy.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/ground.hpp"
#include "analysis/stability.hpp"
#include "ways.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

Body passive_body() { return passive(random_body(60, 10, 5, 4)); }

class Conservation : public EachWay {};

INSTANTIATE_TEST_SUITE_P(Methods, Conservation, all_ways(), named);

TEST_P(Conservation, InternalForcesKeepLinearAndAngularMomentum) {
  const Body body = random_body(150, 12, 5, 3);
  State start = resting(body, {});
  for (std::size_t i = 0; i < start.velocity.size(); ++i) start.velocity[i] = cross({0, 0.4, 1}, start.position[i]);
  start.start_energy = total_energy(body, start, {});
  const Answer a = simulate_ok(body, start, {}, stepping(), 2000);
  const Momentum before = momentum(body, start), after = momentum(body, a.state);
  const double error = single() ? 2e-5 : 1e-13;
  EXPECT_LT(norm(after.linear - before.linear), error * after.scale);
  // Explicit methods use forces along the springs at the beginning of a step, which conserves angular momentum; rk4
  // also uses intermediate positions, which causes a fourth-order error. Backward Euler slows a rotation at omega down
  // by omega^2 dt per second, and xpbd by much more if muscles pull.
  const double lost = method() == Method::rk4 ? 1e-6 : method() == Method::implicit ? 2 * 1.16 * 0.0005 : 0;
  if (method() != Method::xpbd) {
    EXPECT_LT(norm(after.angular - before.angular), 2 * (error + lost) * after.scale);
  }
  EXPECT_GT(largest_difference(start, a.state), 0.1) << "the body has moved";
}

TEST_P(Conservation, TheEnergyOfAnUndampedBodyStaysInBoundsWithoutNumericalDamping) {
  if (!is_explicit(method())) return;
  const Body body = passive_body();
  State state = resting(body, {});
  for (std::size_t i = 0; i < state.velocity.size(); ++i)
    state.velocity[i] = {std::sin(3.0 * static_cast<double>(i)), 0, 0};
  const double energy = state.start_energy = total_energy(body, state, {});
  for (int second = 0; second < 20; ++second) {
    state = simulate_ok(body, state, {}, stepping(), 2000).state;
    EXPECT_NEAR(total_energy(body, state, {}), energy, 0.05 * energy);
  }
}

TEST_P(Conservation, ABodyAtRestWithoutMusclesStaysAtRestAndIsNeverFlagged) {
  const Body body = block(3, {5000, 0, 0, 0});
  const State birth = state_at_birth(body, {});
  EXPECT_LT(largest_difference(simulate_ok(body, birth, {}, stepping(), 20000).state, birth), rounding());
  const Scene scene{Gravity{}, Floor{}, {}, {}, {}};
  Body flat = passive(random_body(50, 8, 2, 5));
  for (Mass& mass : flat.masses) mass.rest.z = 0, mass.mass = 0.2;
  relax(flat);
  EXPECT_NEAR(state_at_birth(flat, scene).start_energy, 0, 1e-20);
  simulate_ok(flat, state_at_birth(flat, scene), scene, stepping(), 4000);
}

class Energy : public ::testing::TestWithParam<Method> {};

INSTANTIATE_TEST_SUITE_P(Methods, Energy, ::testing::ValuesIn(all_methods), named);

/// The factor by which a step of h = omega dt changes the energy of an oscillating spring, on average over its period.
double kept_energy(Method method, double h) {
  if (!is_explicit(method)) return 1 / (1 + h * h);
  return method == Method::rk4 ? 1 - std::pow(h, 6) / 72 + std::pow(h, 8) / 576 : 1;
}

TEST_P(Energy, OfOneSpringIsWhatTheoryLeaves) {
  const double k = 1000, mass = 0.2, omega = std::sqrt(2 * k / mass);
  const Body body = pair_of_masses(mass, {k, 0, 0, 0}, 1.001);
  for (const double h : {0.1, 0.5, 1.0}) {
    const State start = resting(body, {});
    const bool kept = kept_energy(GetParam(), h) == 1;
    const std::uint64_t steps = kept ? 100000 : 20;
    const State end = simulate(body, start, {}, {GetParam(), Precision::float64, h / omega}, steps).state;
    const double ratio = total_energy(body, end, {}) / start.start_energy;
    const double expected = std::pow(kept_energy(GetParam(), h), static_cast<double>(steps));
    // methods without damping conserve a modified energy; the energy oscillates around it, at most between 1/(1 + h/2)
    // and 1/(1 - h/2)
    if (kept)
      EXPECT_TRUE(ratio > (1 - h / 2) / (1 + h / 2) && ratio < (1 + h / 2) / (1 - h / 2)) << ratio << " at " << h;
    else
      EXPECT_NEAR(ratio, expected, 1e-9 * expected) << h;
  }
}

class UnlimitedStep : public EachWay {};

INSTANTIATE_TEST_SUITE_P(Methods, UnlimitedStep, ways({Method::implicit, Method::xpbd}), named);

TEST_P(UnlimitedStep, NeverRaisesTheEnergyWithoutMuscles) {
  const Body body = passive_body();
  const double limit = largest_dt(body, rest_positions(body), Method::paper_euler);
  for (const double factor : {0.25, 20.0}) {
    State state = shaken(body, 1);
    const double before = state.start_energy;
    for (int i = 0; i < 20; ++i) {
      state = simulate_ok(body, state, {}, stepping(factor * limit), 100).state;
      EXPECT_LT(total_energy(body, state, {}), before) << factor << " of the limit, " << i;
    }
  }
}

TEST_P(UnlimitedStep, CarriesAWalkerWhereExplicitMethodsFail) {
  const Body body = random_body(60, 10, 5, 4);
  // one pass of xpbd transmits the weight only through a few springs, which limits the step
  const double factor = method() == Method::implicit ? 20 : 3;
  const double dt = factor * largest_dt(body, rest_positions(body), Method::paper_euler);
  for (const Scene& scene : {walking_scene(), full_scene()}) {
    const State start = state_at_birth(body, scene);
    const Answer a = simulate_ok(body, start, scene, stepping(dt), 2000, {.stress = true, .work = true});
    const Box box = bounding_box(a.state.position), at_birth = bounding_box(start.position);
    EXPECT_GT(box.low.z, -0.01);
    EXPECT_GT(box.high.z, 0.8 * at_birth.high.z);
    EXPECT_LT(box.longest_side(), 1.2 * at_birth.longest_side());
  }
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
