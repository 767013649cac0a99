// The largest stable dt of springs and bodies: theoretical predictions and measurements.
#include "limits.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/stability.hpp"
#include "simulation.hpp"

namespace evodevo::tools::accuracy::EVODEVO_FILE {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::string test_name(const ::testing::TestParamInfo<Method>& info) {
  std::string text(name(info.param));
  std::replace(text.begin(), text.end(), '-', '_');
  return text;
}

class Limits : public ::testing::TestWithParam<Method> {};

INSTANTIATE_TEST_SUITE_P(ExplicitMethods, Limits,
                         ::testing::Values(Method::paper_euler, Method::symplectic_euler, Method::velocity_verlet,
                                           Method::rk4),
                         test_name);

TEST_P(Limits, WithoutDampingIsThatOfTheDocumentation) {
  EXPECT_NEAR(bounded_phases(GetParam(), 0).high, oscillation_limit(GetParam()), 1e-3);
  EXPECT_NEAR(predicted_limit(GetParam(), 50, 0), oscillation_limit(GetParam()) / 50, 1e-4);
}

TEST_P(Limits, OfSpringsAreMeasuredWherePredicted) {
  int finite = 0;
  for (const double stiffness : {500.0, 50000.0})
    for (const double mass : {0.02, 2.0})
      for (const double rate : {0.0, 20.1, 100.0}) {
        const Oscillator oscillator{stiffness, mass, rate};
        const double predicted = predicted_limit(GetParam(), oscillator.frequency(), rate);
        const double measured = measured_limit(oscillator, GetParam());
        if (predicted == infinity) {
          EXPECT_EQ(measured, infinity) << stiffness << " N/m, " << mass << " kg, " << rate << " /s";
          continue;
        }
        ++finite;
        EXPECT_NEAR(measured, predicted, 0.02 * predicted) << stiffness << " N/m, " << mass << " kg, " << rate << " /s";
      }
  EXPECT_GE(finite, 8);
}

TEST_P(Limits, OfABodyIsMeasuredWhereTheProductPredictsIt) {
  // a tetrahedron with a heavy tip
  Body body;
  body.materials = {{5000, 0, 0, 0}};
  body.masses = {{{0, 0, 0}, 0.2}, {{1, 0, 0}, 0.1}, {{0.4, 0.9, 0}, 0.2}, {{0.5, 0.3, 0.8}, 1}};
  for (std::uint32_t a = 0; a < 4; ++a)
    for (std::uint32_t b = a + 1; b < 4; ++b)
      body.springs.push_back({a, b, norm(body.masses[b].rest - body.masses[a].rest), 0});
  const double predicted = largest_dt(body, resting(body, {}).position, GetParam());
  EXPECT_NEAR(measured_limit(body, GetParam(), 0.8 * predicted, 1.2 * predicted), predicted, 0.02 * predicted);
}

TEST(LimitsOfDamping, AreThoseOfTheCharacteristicPolynomials) {
  for (const double c : {0.1, 1.0, 2.5}) {
    const double decay = std::exp(-c);
    // The limits follow from z = -1 as a root of z^2 - (1 + decay - decay h^2) z + decay; for symplectic-euler, the
    // coefficient of h^2 is (1 - decay)/c instead of decay.
    EXPECT_NEAR(bounded_phases(Method::paper_euler, c).high, std::sqrt(2 * (1 + decay) / decay), 1e-3);
    EXPECT_NEAR(bounded_phases(Method::symplectic_euler, c).high, std::sqrt(2 * (1 + decay) * c / (1 - decay)), 1e-3);
    EXPECT_NEAR(bounded_phases(Method::velocity_verlet, c).high, 2, 1e-3);
  }
  // rk4 integrates damping like a force, so the product of damping rate and dt has a limit as well: 2.785, the real
  // root of 1 - z/2 + z^2/6 - z^3/24
  EXPECT_EQ(bounded_phases(Method::rk4, 2.78).low, 0);
  EXPECT_GT(bounded_phases(Method::rk4, 2.79).low, 0);
}

TEST(ContactGain, OfTheEulerMethodsReachesItsBoundAndNoMore) {
  for (const Method method : {Method::paper_euler, Method::symplectic_euler}) {
    double nearest = 0;
    for (const double phase : {0.3, 0.6, 0.9, 1.2, 1.5, 1.8}) {
      const double gain = contact_gain(method, phase), bound = 1 / (1 - phase * phase / 4);
      EXPECT_LE(gain, bound) << phase;
      EXPECT_GE(gain, 1) << phase;
      nearest = std::max(nearest, gain / bound);
    }
    EXPECT_GT(nearest, 0.98);
  }
}

TEST(ContactGain, OfARigidFloorIsItsRestitutionSquaredAtAnyStep) {
  for (const Method method : all_methods())
    for (const double restitution : {0.0, 0.5, 1.0})
      for (const double dt : {1.3e-4, 0.7e-3, 1.1e-2})
        EXPECT_NEAR(rigid_contact_gain(method, restitution, dt), restitution * restitution, 1e-12)
            << name(method) << ", dt " << dt;
}

TEST(ContactGain, IsALossForMethodsThatDamp) {
  for (const Method method : {Method::implicit, Method::xpbd})
    for (const double phase : {0.1, 1.0, 5.0}) EXPECT_LT(contact_gain(method, phase), 1) << phase;
}

}  // namespace
}  // namespace evodevo::tools::accuracy::EVODEVO_FILE
