// The choice of a body's time step, and the paper's tallies after so many steps, compared with their definition.
#include "core/skip_shift.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "analysis/stability.hpp"
#include "base/philox.hpp"
#include "core/simulator.hpp"
#include "experiment/time_steps.hpp"
#include "support/experiments.hpp"
#include "support/lives.hpp"
#include "support/messages.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

Rng stream(std::uint32_t individual) { return Rng(philox, {5, 0, individual, 0}); }

/// A chain of masses along x; spring i is stretched by i mm, so that it pulls with i N.
Body chain(std::uint32_t springs) {
  Body body;
  body.materials = {{1000, 0, 0, 0}};
  for (std::uint32_t i = 0; i <= springs; ++i) body.masses.push_back({{double(i), 0, 0}, 0.2});
  for (std::uint32_t i = 0; i < springs; ++i) body.springs.push_back({i, i + 1, 1 - 0.001 * i, 0});
  return body;
}

State resting(const Body& body, const Scene& scene) {
  State state = state_at_birth(body, scene);
  for (std::size_t i = 0; i < body.masses.size(); ++i) state.position[i] = body.masses[i].rest;
  state.start_energy = total_energy(body, state, scene);
  return state;
}

/// Returns the points of the springs of a body at rest after so many tallies.
std::vector<double> points_of(const Body& body, std::uint32_t seed, int tallies = 1) {
  const State state = resting(body, {});
  std::vector<double> points(body.springs.size());
  Rng random = stream(seed);
  for (int i = 0; i < tallies; ++i) tally(body, state, random_order(body.springs.size(), random), points);
  return points;
}

TEST(SkipShift, EachGroupGivesAPointToItsMostAndTakesOneFromItsLeast) {
  // computes the same groups again, group by group; a body with few springs has groups of two
  for (const auto& [springs, groups] : {std::pair(1000u, 256u), {10u, 5u}}) {
    Rng again = stream(1);
    const std::vector<std::uint32_t> order = random_order(springs, again);
    std::vector<double> expected(springs);
    for (std::size_t group = 0; group < groups; ++group) {
      const std::size_t first = group * springs / groups, last = (group + 1) * springs / groups;
      const auto [least, most] = std::ranges::minmax(std::span(order).subspan(first, last - first));
      expected[most] += 1;  // force increases with the index
      expected[least] -= 1;
    }
    EXPECT_EQ(points_of(chain(springs), 1), expected);
  }
  EXPECT_EQ(points_of(chain(3), 3), (std::vector<double>{-1, 0, 1})) << "an odd spring makes a group of three";
  EXPECT_EQ(points_of(chain(1), 3), std::vector<double>{0}) << "nothing to compare";
}

TEST(SkipShift, ChanceDecidesAmongEquals) {
  // springs have one of two forces: springs with equal forces get equal points on average, independently of their
  // indices
  Body body = chain(600);
  for (std::uint32_t i = 0; i < 600; ++i) body.springs[i].rest_length = i % 2 ? 0.9 : 0.8;
  const std::vector<double> points = points_of(body, 2, 200);
  double halves[2][2] = {};
  for (std::size_t i = 0; i < 600; ++i) halves[i % 2][i / 300] += points[i];
  EXPECT_GT(halves[0][0], 10'000);
  EXPECT_LT(halves[1][0], -10'000);
  EXPECT_NEAR(halves[0][0], halves[0][1], 800);
  EXPECT_NEAR(halves[1][0], halves[1][1], 800);
}

/// The task, with its stress, and the state after a run with tallies.
struct Tallied {
  Task task;
  State state;
};

Tallied run(Simulator& simulator, const Body& body, const State& start, std::uint64_t steps, std::uint64_t skip) {
  Tallied tallied{{}, start};
  tallied.task = {.body = &body, .state = &tallied.state, .dt = 0.0007, .steps = steps};
  Rng random = stream(4);
  std::uint64_t tallies = 0;
  run_with_tallies(simulator, {&tallied.task, 1}, skip, [&](std::size_t, std::uint64_t number) {
    EXPECT_EQ(number, tallies++) << "each tally has its number";
    return random_order(body.springs.size(), random);
  });
  return tallied;
}

TEST(SkipShift, TalliesAfterEverySkipSteps) {
  const Scene scene{Gravity{}, Floor{}, Friction{}, Damping{}, {}};
  const auto simulator = make_cpu_simulator(scene, {.precision = Precision::float64}, 1);
  const Body body = chain(700);
  const State start = state_at_birth(body, scene);
  const Tallied tallied = run(*simulator, body, start, 105, 10);

  State state = start;
  std::vector<double> points(700);
  Rng random = stream(4);
  Task piece{.body = &body, .state = &state, .dt = 0.0007, .steps = 10, .later_steps = 95};
  for (; piece.later_steps > 0; piece.later_steps -= std::min<std::uint64_t>(10, piece.later_steps)) {
    simulator->run({&piece, 1}, {});
    tally(body, state, random_order(body.springs.size(), random), points);
  }
  EXPECT_EQ(tallied.task.stress, points);
  EXPECT_EQ(tallied.task.status, Status::ok);
  EXPECT_EQ(tallied.task.spring_evaluations, 105u * 700);
  EXPECT_EQ(tallied.state.time, 105 * 0.0007);
  // all steps are simulated, including those after the last tally
  State whole = start;
  Task task{.body = &body, .state = &whole, .dt = 0.0007, .steps = 105};
  simulator->run({&task, 1}, {});
  EXPECT_EQ(whole.position, tallied.state.position);
  EXPECT_EQ(whole.velocity, tallied.state.velocity);
}

TEST(SkipShift, ADivergedBodyEndsAndDisturbsNoOther) {
  const auto simulator = make_cpu_simulator({}, {}, 1);
  Body broken = chain(300);
  broken.materials[0].stiffness = 1e9;
  const Body sound = chain(300);
  const auto alone = run(*simulator, sound, state_at_birth(sound, {}), 200, 20);
  std::vector<State> states{state_at_birth(broken, {}), state_at_birth(sound, {})};
  std::vector<Task> tasks(2);
  tasks[0] = {.body = &broken, .state = &states[0], .dt = 0.0007, .steps = 200};
  tasks[1] = {.body = &sound, .state = &states[1], .dt = 0.0007, .steps = 200};
  std::vector<Rng> random{stream(9), stream(4)};
  run_with_tallies(*simulator, tasks, 20, [&](std::size_t i, std::uint64_t) { return random_order(300, random[i]); });
  EXPECT_EQ(tasks[0].status, Status::diverged);
  EXPECT_FALSE(tasks[0].reason.empty());
  EXPECT_GT(tasks[0].ended_at, 0);
  EXPECT_TRUE(tasks[0].stress.empty());
  EXPECT_EQ(tasks[1].stress, alone.task.stress);
}

TEST(SkipShift, ACycleWithoutATallyIsInvalid) {
  const auto simulator = make_cpu_simulator({}, {}, 1);
  const Body body = chain(3);
  const Tallied none = run(*simulator, body, resting(body, {}), 19, 20);
  EXPECT_EQ(none.task.status, Status::invalid);
  EXPECT_THAT(none.task.reason, testing::naming("19 steps", "skip is 20"));
  EXPECT_TRUE(none.task.stress.empty());
  EXPECT_EQ(run(*simulator, body, resting(body, {}), 20, 20).task.status, Status::ok);
}

TEST(SkipShift, WhereEveryBodyHasItsOwnStepACycleWithoutATallyIsInvalidToo) {
  const Experiment experiment =
      testing::small({"development.probe=skip-shift", "development.skip=100000", "simulation.dt=auto"});
  int without_tally = 0;
  for (const Life& life : testing::Developed(experiment, 6).lives) {
    EXPECT_EQ(life.result.status, Status::invalid);
    without_tally += ::testing::Matches(testing::naming("steps", "skip is 100000"))(life.result.reason);
  }
  EXPECT_GE(without_tally, 3) << "the others have no body";
}

TEST(SkipShift, DrivesDevelopment) {
  using Ends = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  const auto springs_after = [](const char* probe, int threads) {
    const Experiment experiment =
        testing::small({"encoding.size=[3, 2, 2]", "development.skip=10", probe, "development.operator.0.springs=20"});
    std::vector<Ends> matured;
    for (const Life& life : testing::Developed(experiment, 6, threads).lives) {
      if (!life.alive()) continue;
      Ends& ends = matured.emplace_back();
      for (const Spring& spring : life.living.body.springs) ends.emplace_back(spring.a, spring.b);
    }
    EXPECT_GE(matured.size(), 2u);
    return matured;
  };
  const auto tallied = springs_after("development.probe=skip-shift", 1);
  EXPECT_EQ(tallied, springs_after("development.probe=skip-shift", 4));
  EXPECT_NE(tallied, springs_after("development.probe=exact", 1));
}

/// One mass with 399 springs of 10,000 N/m, all in nearly the same direction: omega^2 is about 399 k/m, and 2/omega is
/// 0.45 ms.
Body star() {
  Body body;
  body.materials = {{10000, 0, 0, 0}};
  for (int i = 0; i < 400; ++i) body.masses.push_back({{i == 0 ? 0.0 : 1.0, 0, 1e-3 * i}, 0.2, 0, 0});
  for (std::uint32_t i = 1; i < 400; ++i) body.springs.push_back({0, i, 1, 0});
  return body;
}

LongestStep longest(const StepRule& rule, const Scene& scene = {}, Method method = Method::paper_euler,
                    const Body& body = star()) {
  return longest_step(rule, body, scene, method);
}

const Scene hard_floor{.gravity = {}, .floor = Floor{1e8}, .friction = {}, .damping = {}, .drag = {}};

TEST(TimeSteps, ABodyThatAloneExceedsAFixedStepIsTold) {
  EXPECT_THAT(longest({.dt = 0.0005}).failure, testing::at_place("unstable dt: ", "0.0005 s", "springs"));
  EXPECT_EQ(longest({.dt = 0.0002}).failure, "");
  EXPECT_EQ(longest({.dt = 0.0005, .refine = 2}).failure, "") << "half of it is borne";
  EXPECT_THAT(longest({.dt = 0.0002}, hard_floor).failure,
              testing::at_place("unstable dt: ", "0.0002 s", "lightest mass", "floor"));
  Body fast = star();
  fast.materials[0] = {1, 0.1, 1001, 0};
  EXPECT_THAT(longest({.dt = 0.0005}, {}, Method::implicit, fast).failure,
              testing::at_place("unstable dt: ", "0.0005 s", "muscle"));
  EXPECT_EQ(longest({.dt = 0.0005, .run_unstable = true}, hard_floor).failure, "") << "as the file asks";
}

TEST(TimeSteps, WithoutAFixedStepABodyHasItsOwn) {
  const LongestStep springs = longest({.dt = std::nullopt});
  EXPECT_EQ(springs.failure, "");
  // a hub with 399 neighbours: its highest frequency is sqrt(400 k/m), in any shape
  EXPECT_NEAR(springs.dt, undamped_margin * 2 / std::sqrt(400 * 10000 / 0.2), 4e-6);
  EXPECT_DOUBLE_EQ(longest({.dt = std::nullopt}, hard_floor).dt, 1.2 * std::sqrt(0.2 / 1e8));
  Scene floor = hard_floor;
  floor.floor = Floor{1e18};
  EXPECT_THAT(longest({.dt = std::nullopt}, floor).failure, testing::at_place("unstable dt: ", "5.3665631459"));
}

TEST(TimeSteps, MaterialsThatNoSpringHasShortenNone) {
  Body with_others = star();
  with_others.materials.push_back({1, 0.1, 70'001, 0});  // a muscle whose frequency is too high for any step
  with_others.materials.push_back({1e15, 0, 0, 0});
  with_others.masses.back().material = 2;
  for (const Method method : {Method::paper_euler, Method::rk4, Method::implicit}) {
    EXPECT_EQ(longest({.dt = std::nullopt}, {}, method, with_others).dt, longest({.dt = std::nullopt}, {}, method).dt);
    EXPECT_EQ(longest({.dt = 0.0002}, {}, method, with_others).failure, "");
  }
  with_others.springs.front().material = 1;
  EXPECT_DOUBLE_EQ(longest({.dt = std::nullopt}, {}, Method::implicit, with_others).dt, 0.05 / 70'001);
}

TEST(TimeSteps, AStepThatCannotBeComputedIsNotTold) {
  Body body = star();
  for (const double stiffness : {1e300, std::numeric_limits<double>::infinity(), std::nan("")})
    for (const Method method : {Method::paper_euler, Method::rk4}) {
      body.materials[0].stiffness = stiffness;
      const std::string failure = longest({.dt = std::nullopt}, {}, method, body).failure;
      EXPECT_THAT(failure, testing::at_place("unstable dt: "));
      EXPECT_EQ(failure.find("nan"), std::string::npos) << failure;
      EXPECT_EQ(failure.find("inf"), std::string::npos) << failure;
    }
}

TEST(TimeSteps, DependOnTheBodyAloneAndDivideACycle) {
  const auto expect = [](const Pace& pace, double dt, std::uint64_t steps) {
    EXPECT_DOUBLE_EQ(pace.dt, dt);
    EXPECT_EQ(pace.steps, steps);
  };
  expect(pace_of(1, {.dt = 0.0005}, 1), 0.0005, 2000);
  expect(pace_of(1, {.dt = 0.0005, .refine = 4}, 1), 0.000125, 8000);
  expect(pace_of(1, {.dt = std::nullopt}, 0.3), 0.25, 4);
  expect(pace_of(1, {.dt = std::nullopt, .refine = 4}, 0.3), 0.0625, 16);
  expect(pace_of(0.25, {.dt = std::nullopt}, 0.25), 0.25, 1);
  expect(pace_of(0.001, {.dt = std::nullopt}, 0.25), 0.25, 0);
  expect(pace_of(8.37, {.dt = std::nullopt}, 0.3), 0.25, 33);  // the step nearest to 8.37 s
  expect(pace_of(0.07, {.dt = std::nullopt, .unit = 0.07}, 0.011), 0.01, 7);
  expect(pace_of(1, {.dt = std::nullopt, .unit = 0.07}, 0.011), 0.01, 100);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
