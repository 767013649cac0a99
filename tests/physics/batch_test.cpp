// The result of a body does not depend on the other bodies of its batch or on the number of threads.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "analysis/ground.hpp"
#include "scenes.hpp"
#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

using ::testing::Test;

constexpr Steps stepping{Method::paper_euler, Precision::float32, 0.0005};

/// Bodies of many sizes, each with its result when it is simulated alone.
class Bodies {
 protected:
  explicit Bodies(const Steps& steps) : steps_(steps) {
    for (std::uint32_t i = 0; i < 9; ++i) {
      bodies.push_back(random_body(5 + 17 * i, 4 + i, 3 + 3 * i, i));
      if (i % 3 == 1)  // no muscles
        for (Material& material : bodies.back().materials) material.amplitude = 0;
    }
    for (const Body& body : bodies)
      alone.push_back(simulate(body, state_at_birth(body, full_scene()), full_scene(), steps_, 333, recording));
  }

  /// Simulates the bodies with the indices in `order` in one batch, and expects the same results as for each body
  /// alone.
  void expect_the_same(const std::vector<std::size_t>& order, int threads) const {
    std::vector<State> states;
    for (const std::size_t i : order) states.push_back(state_at_birth(bodies[i], full_scene()));
    std::vector<Task> tasks(order.size());
    for (std::size_t t = 0; t < order.size(); ++t)
      tasks[t] = {.body = &bodies[order[t]], .state = &states[t], .dt = steps_.dt, .steps = 333};
    make_cpu_simulator(full_scene(), steps_, threads)->run(tasks, recording);
    for (std::size_t t = 0; t < order.size(); ++t) {
      EXPECT_TRUE(same_bits(states[t], alone[order[t]].state)) << "body " << order[t] << ", " << threads << " threads";
      EXPECT_EQ(tasks[t].stress, alone[order[t]].task.stress);
      EXPECT_EQ(tasks[t].work, alone[order[t]].task.work);
    }
  }

  static constexpr Recording recording{.stress = true, .work = true};
  Steps steps_;
  std::vector<Body> bodies;
  std::vector<Answer> alone;
};

class Batch : public Bodies, public Test {
 protected:
  Batch() : Bodies(stepping) {}
};

class BatchOfEachMethod : public Bodies, public ::testing::TestWithParam<Method> {
 protected:
  BatchOfEachMethod() : Bodies({GetParam(), Precision::float32, 0.0005}) {}
};

INSTANTIATE_TEST_SUITE_P(Methods, BatchOfEachMethod, ::testing::ValuesIn(all_methods),
                         [](const auto& instance) { return name_of(instance.param); });

TEST_P(BatchOfEachMethod, AnyNumberOfThreadsGivesTheSameBits) {
  std::vector<std::size_t> all(bodies.size());
  std::iota(all.begin(), all.end(), 0u);
  for (const int threads : {0, 1, 2, 3, 16}) expect_the_same(all, threads);
}

TEST_P(BatchOfEachMethod, AnyOrderAndCompositionGivesTheSameBits) {
  expect_the_same({8, 7, 6, 5, 4, 3, 2, 1, 0}, 2);
  expect_the_same({3, 3, 3, 0, 8}, 2);
  expect_the_same({}, 2);
}

TEST_P(BatchOfEachMethod, EveryBodyHasItsOwnSteps) {
  std::vector<State> states;
  for (const Body& body : bodies) states.push_back(state_at_birth(body, full_scene()));
  std::vector<Task> tasks(bodies.size());
  const auto pace = [](std::size_t i) { return std::pair(0.0005 / static_cast<double>(i + 1), 30 + 60 * i); };
  for (std::size_t i = 0; i < tasks.size(); ++i)
    tasks[i] = {.body = &bodies[i], .state = &states[i], .dt = pace(i).first, .steps = pace(i).second};
  make_cpu_simulator(full_scene(), steps_, 2)->run(tasks, recording);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const Steps steps{steps_.method, steps_.precision, pace(i).first};
    const Answer a =
        simulate(bodies[i], state_at_birth(bodies[i], full_scene()), full_scene(), steps, pace(i).second, recording);
    EXPECT_TRUE(same_bits(a.state, states[i])) << i;
    EXPECT_EQ(a.task.stress, tasks[i].stress) << i;
    EXPECT_DOUBLE_EQ(states[i].time, pace(i).first * static_cast<double>(pace(i).second));
    EXPECT_EQ(tasks[i].spring_evaluations, pace(i).second * bodies[i].springs.size());
  }
}

TEST_F(Batch, ABodyThatDivergesIsFlaggedAndDisturbsNoOther) {
  // a spring whose oscillation is too fast for the step
  Body unstable = pair_of_masses(0.2, {1e7, 0, 0, 0}, 1.01);
  std::vector<State> states{state_at_birth(bodies[4], full_scene()), state_at_birth(unstable, full_scene()),
                            state_at_birth(bodies[5], full_scene())};
  std::vector<Task> tasks(3);
  tasks[0].body = &bodies[4], tasks[1].body = &unstable, tasks[2].body = &bodies[5];
  for (std::size_t i = 0; i < 3; ++i) tasks[i].state = &states[i], tasks[i].steps = 333;
  make_cpu_simulator(full_scene(), stepping, 2)->run(tasks, recording);
  EXPECT_EQ(tasks[1].status, Status::diverged);
  EXPECT_DOUBLE_EQ(tasks[1].ended_at, 100 * stepping.dt);
  EXPECT_EQ(tasks[1].spring_evaluations, 100u);
  EXPECT_FALSE(tasks[1].reason.empty());
  EXPECT_TRUE(tasks[1].stress.empty());
  EXPECT_EQ(tasks[1].work, 0);
  EXPECT_TRUE(same_bits(states[0], alone[4].state));
  EXPECT_TRUE(same_bits(states[2], alone[5].state));
}

TEST_F(Batch, ATaskThatDoesNotComeInAsOkIsLeftAlone) {
  State state = state_at_birth(bodies[2], full_scene());
  Task task;
  task.body = &bodies[2], task.state = &state;
  task.steps = 100;
  task.status = Status::invalid;
  task.reason = "no";
  make_cpu_simulator(full_scene(), stepping, 1)->run({&task, 1}, recording);
  EXPECT_TRUE(same_bits(state, state_at_birth(bodies[2], full_scene())));
  EXPECT_EQ(task.status, Status::invalid);
  EXPECT_EQ(task.reason, "no");
}

TEST(Guard, EnergyFromNothingIsDivergence) {
  const Body body = block(1, {1000, 0, 0, 0});
  State state = state_at_birth(body, {});
  state.time = 0.025;
  state.start_energy = 1;
  for (Vec3& v : state.velocity) v = {0, 0, 3.6};  // 10.4 J
  const Answer a = simulate(body, state, {}, stepping, 1000);
  EXPECT_EQ(a.task.status, Status::diverged);
  EXPECT_NE(a.task.reason.find("10.4 J"), std::string::npos) << a.task.reason;
  EXPECT_DOUBLE_EQ(a.task.ended_at, 150 * stepping.dt);
  EXPECT_EQ(a.state.time, a.task.ended_at);
  for (Vec3& v : state.velocity) v = {0, 0, 3.4};  // 9.2 J
  EXPECT_EQ(simulate(body, state, {}, stepping, 1000).task.status, Status::ok);
}

TEST(Scenes, MayDifferWithinABatch) {
  for (const Method method : all_methods)
    for (const Precision precision : {Precision::float32, Precision::float64}) {
      SCOPED_TRACE(name_of(method) + " " + name_of(precision));
      expect_tasks_in_their_own_scenes([&](const Scene& scene) {
        return make_cpu_simulator(scene, {method, precision}, 2);
      });
    }
}

TEST(Guard, TheEndOfARunIsChecked) {
  Body body = pair_of_masses(0.2, {1e7, 0, 0, 0}, 1.01);
  const Answer a = simulate(body, state_at_birth(body, {}), {}, stepping, 30);
  EXPECT_EQ(a.task.status, Status::diverged);
  EXPECT_DOUBLE_EQ(a.task.ended_at, 30 * stepping.dt);
}

TEST(Guard, WhatIsNotFiniteIsDivergence) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const Body body = block(1, {1000, 0, 0, 0});
  for (const double bad : {nan, infinity, -infinity})
    for (int where = 0; where < 6; ++where) {
      State state = state_at_birth(body, {});
      Vec3& v = where < 3 ? state.position[5] : state.velocity[5];
      (where % 3 == 0 ? v.x : where % 3 == 1 ? v.y : v.z) = bad;
      const Answer a = simulate(body, state, {}, stepping, 1);
      EXPECT_EQ(a.task.status, Status::diverged);
      EXPECT_EQ(a.task.reason.find("non-finite"), 0u) << a.task.reason;
    }
}

TEST(Guard, AnUnconnectedMassIsWatchedToo) {
  const Body body = single_mass(0.2);
  State state = state_at_birth(body, {});
  state.position[0].y = std::numeric_limits<double>::infinity();
  EXPECT_EQ(simulate(body, state, {}, stepping, 1).task.status, Status::diverged);
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
