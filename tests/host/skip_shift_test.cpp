// The paper's tallies, compared with their definition.
#include "core/skip_shift.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "base/philox.hpp"
#include "evolution/breeding.hpp"
#include "life/evaluation.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

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

TEST(SkipShift, EachGroupGivesAPointToItsMostAndTakesOneFromItsLeast) {
  const Body body = chain(1000);
  std::vector<double> points(1000);
  Rng random = stream(1);
  tally(body, resting(body, {}), random, points);

  // computes the same groups again, group by group
  std::vector<std::uint32_t> order(1000);
  std::iota(order.begin(), order.end(), 0u);
  Rng again = stream(1);
  again.shuffle(order);
  std::vector<double> expected(1000);
  for (std::size_t group = 0; group < 256; ++group) {
    const std::size_t first = group * 1000 / 256, last = (group + 1) * 1000 / 256;
    std::uint32_t most = order[first], least = order[first];
    for (std::size_t i = first; i < last; ++i) {
      most = std::max(most, order[i]);  // force increases with the index
      least = std::min(least, order[i]);
    }
    expected[most] += 1;
    expected[least] -= 1;
  }
  EXPECT_EQ(points, expected);
}

TEST(SkipShift, ChanceDecidesAmongEquals) {
  // springs have one of two forces: springs with equal forces get equal points on average, independently of their
  // indices
  Body body = chain(600);
  for (std::uint32_t i = 0; i < 600; ++i) body.springs[i].rest_length = i % 2 ? 0.9 : 0.8;
  const State state = resting(body, {});
  std::vector<double> points(600);
  Rng random = stream(2);
  for (int i = 0; i < 200; ++i) tally(body, state, random, points);
  double halves[2][2] = {};
  for (std::size_t i = 0; i < 600; ++i) halves[i % 2][i / 300] += points[i];
  EXPECT_GT(halves[0][0], 10'000);
  EXPECT_LT(halves[1][0], -10'000);
  EXPECT_NEAR(halves[0][0], halves[0][1], 800);
  EXPECT_NEAR(halves[1][0], halves[1][1], 800);
}

TEST(SkipShift, FewSpringsAreRankedToo) {
  // with groups of two, spring i has more force than i of its 9 possible partners, and less than the others
  const Body body = chain(10);
  const State state = resting(body, {});
  constexpr int tallies = 10'000;
  std::vector<double> points(10);
  Rng random = stream(3);
  for (int i = 0; i < tallies; ++i) tally(body, state, random, points);
  for (std::size_t i = 0; i < 10; ++i) {
    const double mean = (2 * static_cast<double>(i) - 9) / 9, deviation = std::sqrt(1 - mean * mean);
    EXPECT_NEAR(points[i], tallies * mean, 5 * deviation * std::sqrt(tallies)) << i;
  }
}

TEST(SkipShift, AnOddSpringMakesAGroupOfThree) {
  const Body body = chain(3);
  std::vector<double> points(3);
  Rng random = stream(3);
  tally(body, resting(body, {}), random, points);
  EXPECT_EQ(points, (std::vector<double>{-1, 0, 1}));
  const Body single = chain(1);
  points.assign(1, 0);
  tally(single, resting(single, {}), random, points);
  EXPECT_EQ(points, std::vector<double>{0}) << "nothing to compare";
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
  run_with_tallies(simulator, {&tallied.task, 1}, skip, {&random, 1});
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
    tally(body, state, random, points);
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

TEST(SkipShift, FindsTheExtremesThatTheExactStressFinds) {
  const Scene scene;
  const auto simulator = make_cpu_simulator(scene, {}, 1);
  Body body = chain(1000);
  for (Mass& mass : body.masses) mass.mass = 0;  // held in place, so that forces are constant
  const Tallied tallied = run(*simulator, body, resting(body, scene), 400, 10);
  std::vector<std::size_t> order(1000);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](auto a, auto b) { return tallied.task.stress[a] < tallied.task.stress[b]; });
  const auto found = std::count_if(order.begin(), order.begin() + 100, [](auto s) { return s < 100; });
  EXPECT_GT(found, 60) << "10 by chance";
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
  run_with_tallies(*simulator, tasks, 20, random);
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
  EXPECT_THAT(none.task.reason, AllOf(HasSubstr("19 steps"), HasSubstr("skip is 20")));
  EXPECT_TRUE(none.task.stress.empty());
  EXPECT_EQ(run(*simulator, body, resting(body, {}), 20, 20).task.status, Status::ok);
}

TEST(SkipShift, WhereEveryBodyHasItsOwnStepACycleWithoutATallyIsInvalidToo) {
  const Experiment experiment = testing::read(
      testing::small_experiment,
      {{"development.probe", "skip-shift", ""}, {"development.skip", "100000", ""}, {"simulation.dt", "auto", ""}});
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
  const std::vector<Individual> individuals = breed(experiment, {}, 0, 0, 6);
  std::vector<Newborn> newborns;
  for (const Individual& individual : individuals) newborns.push_back({individual.id, 0, &individual.genome});
  int without_tally = 0;
  for (const Result& result : Evaluation(experiment, *simulator).evaluate(newborns, [](double) {})) {
    EXPECT_EQ(result.status, Status::invalid);
    without_tally += ::testing::Matches(testing::naming("steps", "skip is 100000"))(result.reason);
  }
  EXPECT_GE(without_tally, 3) << "the others have no body";
}

TEST(SkipShift, DrivesDevelopment) {
  using Ends = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  const auto springs_after = [](const char* probe, int threads) {
    const Experiment experiment =
        testing::read(testing::small_experiment, {{"encoding.size", "[3, 2, 2]", ""},
                                                  {"development.probe", probe, ""},
                                                  {"development.skip", "10", ""},
                                                  {"development.operator.0.springs", "20", ""}});
    const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, threads);
    const Evaluation evaluation(experiment, *simulator);
    const std::vector<Individual> individuals = breed(experiment, {}, 0, 0, 6);
    std::vector<Newborn> newborns;
    for (const Individual& individual : individuals) newborns.push_back({individual.id, 0, &individual.genome});
    std::vector<Life> lives = evaluation.birth.of(newborns);
    evaluation.development.run(lives, [](double) {});
    std::vector<Ends> matured;
    for (const Life& life : lives) {
      if (!life.alive()) continue;
      Ends& ends = matured.emplace_back();
      for (const Spring& spring : life.living.body.springs) ends.emplace_back(spring.a, spring.b);
    }
    EXPECT_GE(matured.size(), 2u);
    return matured;
  };
  EXPECT_EQ(springs_after("skip-shift", 1), springs_after("skip-shift", 4));
  EXPECT_NE(springs_after("skip-shift", 1), springs_after("exact", 1));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
