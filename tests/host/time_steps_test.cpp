// The choice of a body's time step.
#include "experiment/time_steps.hpp"

#include <gtest/gtest.h>

#include "analysis/ground.hpp"
#include "analysis/stability.hpp"
#include "core/simulator.hpp"
#include "support/messages.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

/// One mass with 399 springs of 10,000 N/m, all in nearly the same direction: omega^2 is about 399 k/m, and 2/omega is
/// 0.45 ms.
Body star() {
  Body body;
  body.materials = {{10000, 0, 0, 0}};
  for (int i = 0; i < 400; ++i) body.masses.push_back({{i == 0 ? 0.0 : 1.0, 0, 1e-3 * i}, 0.2, 0, 0});
  for (std::uint32_t i = 1; i < 400; ++i) body.springs.push_back({0, i, 1, 0});
  return body;
}

LongestStep longest(const StepRule& rule, const Scene& scene = {}, Method method = Method::paper_euler) {
  const Body body = star();
  return longest_step(rule, body, state_at_birth(body, {}).position, scene, method);
}

TEST(TimeSteps, ABodyThatAloneExceedsAFixedStepIsTold) {
  EXPECT_THAT(longest({.dt = 0.0005}).failure, testing::at_place("unstable dt: ", "0.0005 s", "springs"));
  EXPECT_EQ(longest({.dt = 0.0002}).failure, "");
  EXPECT_EQ(longest({.dt = 0.0005, .refine = 2}).failure, "") << "half of it is borne";
  Scene floor;
  floor.floor = Floor{1e8};
  EXPECT_THAT(longest({.dt = 0.0002}, floor).failure,
              testing::at_place("unstable dt: ", "0.0002 s", "lightest mass", "floor"));
  Body fast = star();
  fast.materials[0] = {1, 0.1, 1001, 0};
  EXPECT_THAT(longest_step({.dt = 0.0005}, fast, state_at_birth(fast, {}).position, {}, Method::implicit).failure,
              testing::at_place("unstable dt: ", "0.0005 s", "muscle"));
  EXPECT_EQ(longest({.dt = 0.0005, .run_unstable = true}, floor).failure, "") << "as the file asks";
}

TEST(TimeSteps, WithoutAFixedStepABodyHasItsOwn) {
  const LongestStep springs = longest({.dt = std::nullopt});
  EXPECT_EQ(springs.failure, "");
  EXPECT_NEAR(springs.dt, 0.9 * 2 / std::sqrt(399 * 10000 / 0.2), 1e-5);
  Scene floor;
  floor.floor = Floor{1e8};
  EXPECT_DOUBLE_EQ(longest({.dt = std::nullopt}, floor).dt, 1.2 * std::sqrt(0.2 / 1e8));
  floor.floor = Floor{1e18};
  EXPECT_THAT(longest({.dt = std::nullopt}, floor).failure, testing::at_place("unstable dt: ", "5.3665631459"));
}

TEST(TimeSteps, MaterialsThatNoSpringHasShortenNone) {
  const Body body = star();
  Body with_others = body;
  with_others.materials.push_back({1, 0.1, 70'001, 0});  // a muscle whose frequency is too high for any step
  with_others.materials.push_back({1e15, 0, 0, 0});
  with_others.masses.back().material = 2;
  const std::vector<Vec3> positions = state_at_birth(body, {}).position;
  for (const Method method : {Method::paper_euler, Method::rk4, Method::implicit}) {
    EXPECT_EQ(longest_step({.dt = std::nullopt}, with_others, positions, {}, method).dt,
              longest_step({.dt = std::nullopt}, body, positions, {}, method).dt);
    EXPECT_EQ(longest_step({.dt = 0.0002}, with_others, positions, {}, method).failure, "");
  }
  with_others.springs.front().material = 1;
  EXPECT_DOUBLE_EQ(longest_step({.dt = std::nullopt}, with_others, positions, {}, Method::implicit).dt, 0.05 / 70'001);
}

TEST(TimeSteps, AStepThatCannotBeComputedIsNotTold) {
  const Body body = star();
  std::vector<Vec3> positions = state_at_birth(body, {}).position;
  positions[7].y = 1e200;  // its square is infinite
  const std::string far = longest_step({.dt = std::nullopt}, body, positions, {}, Method::paper_euler).failure;
  positions[7].y = std::nan("");
  const std::string nowhere = longest_step({.dt = std::nullopt}, body, positions, {}, Method::rk4).failure;
  EXPECT_THAT(nowhere, testing::at_place("unstable dt: "));
  for (const std::string& failure : {far, nowhere}) {
    EXPECT_EQ(failure.find("nan"), std::string::npos) << failure;
    EXPECT_EQ(failure.find("inf"), std::string::npos) << failure;
  }
}

TEST(TimeSteps, StepsDivideTheirDuration) {
  const auto expect = [](const Pace& pace, double dt, std::uint64_t steps) {
    EXPECT_DOUBLE_EQ(pace.dt, dt);
    EXPECT_EQ(pace.steps, steps);
  };
  expect(pace_over(1, {.dt = 0.0005}, 1), 0.0005, 2000);
  expect(pace_over(1, {.dt = 0.0005, .refine = 4}, 1), 0.000125, 8000);
  expect(pace_over(1, {.dt = std::nullopt}, 0.3), 0.25, 4);
  expect(pace_over(1, {.dt = std::nullopt, .refine = 4}, 0.3), 0.0625, 16);
  expect(pace_over(0.25, {.dt = std::nullopt}, 0.25), 0.25, 1);
  expect(pace_over(0.001, {.dt = std::nullopt}, 0.25), 0.001, 1);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
