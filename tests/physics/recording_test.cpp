// Recordings of stress and work, compared with known results.
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/ground.hpp"
#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

class Recorded : public ::testing::TestWithParam<Arithmetic> {
 protected:
  static Precision precision() { return std::get<Precision>(GetParam()); }
  static Steps stepping() { return {std::get<Method>(GetParam()), precision(), 0.0005}; }
};

INSTANTIATE_TEST_SUITE_P(Methods, Recorded,
                         ::testing::Combine(::testing::ValuesIn(all_methods),
                                            ::testing::Values(Precision::float32, Precision::float64)),
                         [](const auto& instance) { return name_of(instance.param); });

TEST_P(Recorded, AStaticallyLoadedSpringIsUnderItsLoad) {
  // a mass of 0.2 kg hangs on a spring from a fixed mass; the spring is stretched by m g / k
  const double weight = 0.2 * 9.81, k = 1000;
  Body body = pair_of_masses(0.2, {k, 0, 0, 0});
  body.masses[0] = {{0, 0, 2}, 0};
  body.masses[1] = {{0, 0, 1 - weight / k}, 0.2};
  const Scene scene{Gravity{}, {}, {}, {}, {}};
  const Recording of_springs{.stress = true, .peak_force = true, .muscle_work = true, .tension = true};
  const Answer a = simulate(body, resting(body, scene), scene, stepping(), 1234, of_springs);
  ASSERT_EQ(a.task.stress.size(), 1u);
  const double rounding = precision() == Precision::float32 ? 2e-3 : 1e-9;
  EXPECT_NEAR(a.task.stress[0], weight, rounding);
  EXPECT_NEAR(a.task.peak_force.at(0), weight, rounding);
  EXPECT_NEAR(a.task.tension.at(0), weight, rounding);
  EXPECT_EQ(a.task.muscle_work, std::vector{0.0}) << "no muscle";
  EXPECT_EQ(a.task.work, 0);
}

TEST_P(Recorded, ALoadedSpringUnderItsMassIsCompressed) {
  const double weight = 0.2 * 9.81, k = 1000;
  Body body = pair_of_masses(0.2, {k, 0, 0, 0});
  body.masses[0] = {{0, 0, 1}, 0};
  body.masses[1] = {{0, 0, 2 - weight / k}, 0.2};
  const Scene scene{Gravity{}, {}, {}, {}, {}};
  const Answer a = simulate(body, resting(body, scene), scene, stepping(), 1234, {.tension = true});
  EXPECT_NEAR(a.task.tension.at(0), -weight, precision() == Precision::float32 ? 2e-3 : 1e-9);
}

TEST_P(Recorded, ASwingingSpringPeaksAtTheEndsOfItsSwing) {
  // A hanging mass that is released at the rest length oscillates; the force of the spring varies between 0 and twice
  // the weight. Over whole periods of 2 pi sqrt(m/k) = 88.9 ms, its mean is the weight.
  const double mass = 0.2, weight = mass * 9.81, k = 1000, period = 2 * pi * std::sqrt(mass / k);
  Body body = pair_of_masses(mass, {k, 0, 0, 0});
  body.masses[0] = {{0, 0, 2}, 0};
  body.masses[1] = {{0, 0, 1}, mass};
  const Scene scene{Gravity{}, {}, {}, {}, {}};
  const Steps steps{std::get<Method>(GetParam()), precision(), period / 1000};
  const Answer a =
      simulate(body, resting(body, scene), scene, steps, 3000, {.stress = true, .peak_force = true, .tension = true});
  // implicit and xpbd damp the oscillation: its first peak is reduced by a factor of e^(-pi/2 dt omega)
  const double damped = is_explicit(steps.method) ? 1e-3 : 0.02;
  EXPECT_NEAR(a.task.peak_force.at(0), 2 * weight, damped * 2 * weight);
  EXPECT_NEAR(a.task.tension.at(0), weight, damped * weight);
  EXPECT_NEAR(a.task.stress.at(0), a.task.tension[0], 1e-4 * weight) << "it never pushes";
}

TEST_P(Recorded, AnIsometricMuscleWorksWhileItPushesOut) {
  // Both ends are held: |d| = L0, so force = -k L0 A sin and dL/dt = L0 A w cos. Over a period, the positive part of
  // their product has the integral k (L0 A)^2, and |force| has the mean 2/pi k L0 A.
  const double k = 2000, amplitude = 0.1;
  Body body = pair_of_masses(0, {k, amplitude, 2, 0});
  const Recording all{.stress = true, .work = true, .peak_force = true, .muscle_work = true, .tension = true};
  const Answer a = simulate(body, resting(body, {}), {}, stepping(), 1000, all);
  EXPECT_NEAR(a.task.work, k * amplitude * amplitude, 1e-3 * k * amplitude * amplitude);
  EXPECT_NEAR(a.task.muscle_work.at(0), a.task.work, 1e-12) << "the only one";
  EXPECT_NEAR(a.task.stress[0], 2 / pi * k * amplitude, 1e-3 * k * amplitude);
  EXPECT_NEAR(a.task.peak_force.at(0), k * amplitude, 1e-3 * k * amplitude);
  EXPECT_NEAR(a.task.tension.at(0), 0, 1e-3 * k * amplitude) << "over a whole period";
}

TEST_P(Recorded, TheMusclesWorkIsThatOfTheBody) {
  const Body body = random_body(30, 6, 5, 3);
  const Scene scene = walking_scene();
  const Recording both{.work = true, .muscle_work = true};
  const Answer a = simulate(body, state_at_birth(body, scene), scene, stepping(), 250, both);
  ASSERT_EQ(a.task.muscle_work.size(), body.springs.size());
  double sum = 0;
  for (std::size_t i = 0; i < body.springs.size(); ++i) {
    const bool is_muscle = body.materials[body.springs[i].material].amplitude != 0;
    if (!is_muscle) {
      EXPECT_EQ(a.task.muscle_work[i], 0) << i;
    }
    EXPECT_GE(a.task.muscle_work[i], 0) << i;
    sum += a.task.muscle_work[i];
  }
  EXPECT_GT(a.task.work, 0.01);
  EXPECT_NEAR(sum, a.task.work, 1e-12 * a.task.work);
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
  const Answer tension = simulate(body, start, {}, stepping(), 200, {.tension = true});
  EXPECT_TRUE(tension.task.stress.empty());
  EXPECT_TRUE(tension.task.peak_force.empty());
  EXPECT_TRUE(tension.task.muscle_work.empty());
  EXPECT_EQ(tension.task.tension.size(), body.springs.size());
  const Answer muscles = simulate(body, start, {}, stepping(), 200, {.muscle_work = true});
  EXPECT_EQ(muscles.task.muscle_work.size(), body.springs.size());
  EXPECT_EQ(muscles.task.work, 0);
  // a recorded quantity does not depend on which other quantities are recorded
  const Answer all = simulate(body, start, {}, stepping(), 200,
                              {.stress = true, .work = true, .peak_force = true, .muscle_work = true, .tension = true});
  EXPECT_EQ(all.task.stress, stress.task.stress);
  EXPECT_EQ(all.task.work, work.task.work);
  EXPECT_EQ(all.task.muscle_work, muscles.task.muscle_work);
  EXPECT_EQ(all.task.tension, tension.task.tension);
  // recording does not change the motion
  EXPECT_TRUE(same_bits(none.state, all.state));
  EXPECT_TRUE(same_bits(none.state, stress.state));
  EXPECT_TRUE(same_bits(none.state, work.state));
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
