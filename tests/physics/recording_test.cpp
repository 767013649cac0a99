// Stress and work, where the answer is known beforehand.
#include <gtest/gtest.h>

#include <cmath>

#include "support.hpp"

namespace evodevo::test {
namespace {

class Recorded : public testing::TestWithParam<Arithmetic> {
 protected:
  static Precision precision() { return std::get<Precision>(GetParam()); }
  static Steps stepping() { return {std::get<Method>(GetParam()), precision(), 0.0005}; }
};

INSTANTIATE_TEST_SUITE_P(Methods, Recorded,
                         testing::Combine(testing::ValuesIn(all_methods),
                                          testing::Values(Precision::float32, Precision::float64)),
                         [](const auto& instance) { return name_of(instance.param); });

TEST_P(Recorded, AStaticallyLoadedSpringIsUnderItsLoad) {
  // a mass of 0.2 kg hangs from one that does not move, stretched by m g / k
  const double weight = 0.2 * 9.81, k = 1000;
  Body body = pair_of_masses(0.2, {k, 0, 0, 0});
  body.masses[0] = {{0, 0, 2}, 0};
  body.masses[1] = {{0, 0, 1 - weight / k}, 0.2};
  const Scene scene{Gravity{}, {}, {}, {}, {}};
  const Answer a = simulate(body, resting(body, scene), scene, stepping(), 1234, {.stress = true});
  ASSERT_EQ(a.task.stress.size(), 1u);
  EXPECT_NEAR(a.task.stress[0], weight, precision() == Precision::float32 ? 2e-3 : 1e-9);
  EXPECT_EQ(a.task.work, 0);
}

TEST_P(Recorded, AnIsometricMuscleWorksWhileItPushesOut) {
  // both ends held: |d| = L0, so force = -k L0 A sin, dL/dt = L0 A w cos; the positive part of their product over a
  // period has the integral k (L0 A)^2, and |force| the mean 2/pi k L0 A
  const double k = 2000, amplitude = 0.1;
  Body body = pair_of_masses(0, {k, amplitude, 2, 0});
  const Answer a = simulate(body, resting(body, {}), {}, stepping(), 1000, {.stress = true, .work = true});
  EXPECT_NEAR(a.task.work, k * amplitude * amplitude, 1e-3 * k * amplitude * amplitude);
  EXPECT_NEAR(a.task.stress[0], 2 / pi * k * amplitude, 1e-3 * k * amplitude);
}

TEST_P(Recorded, ASpringOfNoLengthIsUnderNoStress) {
  Body body = pair_of_masses(0.2, {1000, 0, 0, 0}, 0);
  const Answer a = simulate(body, resting(body, {}), {}, stepping(), 10, {.stress = true, .work = true});
  EXPECT_EQ(a.task.stress[0], 0);
}

TEST_P(Recorded, OnlyWhatIsAskedForIsAnswered) {
  const Body body = random_body(30, 6, 5, 1);
  const State start = state_at_birth(body, {});
  const Answer none = simulate(body, start, {}, stepping(), 200);
  EXPECT_TRUE(none.task.stress.empty());
  EXPECT_EQ(none.task.work, 0);
  const Answer stress = simulate(body, start, {}, stepping(), 200, {.stress = true});
  EXPECT_EQ(stress.task.stress.size(), body.springs.size());
  EXPECT_EQ(stress.task.work, 0);
  const Answer work = simulate(body, start, {}, stepping(), 200, {.work = true});
  EXPECT_TRUE(work.task.stress.empty());
  EXPECT_GT(work.task.work, 0);
  // and recording changes nothing
  EXPECT_TRUE(same_bits(none.state, stress.state));
  EXPECT_TRUE(same_bits(none.state, work.state));
}

}  // namespace
}  // namespace evodevo::test
