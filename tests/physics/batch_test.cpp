// The result of a body does not depend on the other bodies of its batch or on the number of threads; a body that
// diverges is flagged.
#include <algorithm>
#include <limits>
#include <numeric>

#include "analysis/ground.hpp"
#include "ways.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

constexpr Steps stepping{Method::paper_euler, Precision::float32, 0.0005};

/// Bodies of many sizes, each with its own steps, and its result when it is simulated alone.
class Batch : public ::testing::TestWithParam<Method> {
 protected:
  Batch() {
    for (std::uint32_t i = 0; i < 9; ++i) {
      const Body body = random_body(5 + 17 * i, 4 + i, 3 + 3 * i, i);
      bodies.push_back(i % 3 == 1 ? passive(body) : body);
    }
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const State birth = state_at_birth(bodies[i], full_scene());
      alone.push_back(
          simulate(bodies[i], birth, full_scene(), {GetParam(), precision, dt_of(i)}, steps_of(i), recording));
    }
  }

  static double dt_of(std::size_t body) { return 0.0005 / static_cast<double>(body + 1); }
  static std::uint64_t steps_of(std::size_t body) { return 30 + 60 * body; }

  /// Simulates the bodies with the indices in `order` in one batch, and expects the same results as for each body
  /// alone.
  void expect_the_same(const std::vector<std::size_t>& order, int threads) const {
    std::vector<State> states;
    for (const std::size_t i : order) states.push_back(state_at_birth(bodies[i], full_scene()));
    std::vector<Task> tasks(order.size());
    for (std::size_t t = 0; t < order.size(); ++t)
      tasks[t] = {.body = &bodies[order[t]], .state = &states[t], .dt = dt_of(order[t]), .steps = steps_of(order[t])};
    make_cpu_simulator(full_scene(), {GetParam(), precision}, threads)->run(tasks, recording);
    for (std::size_t t = 0; t < order.size(); ++t) {
      EXPECT_TRUE(same_bits(states[t], alone[order[t]].state)) << "body " << order[t] << ", " << threads << " threads";
      EXPECT_EQ(tasks[t].stress, alone[order[t]].task.stress);
      EXPECT_EQ(tasks[t].work, alone[order[t]].task.work);
      EXPECT_DOUBLE_EQ(states[t].time, tasks[t].dt * static_cast<double>(tasks[t].steps));
      EXPECT_EQ(tasks[t].spring_evaluations, tasks[t].steps * tasks[t].body->springs.size());
    }
  }

  static constexpr Recording recording{.stress = true, .work = true};
  static constexpr Precision precision = Precision::float32;
  std::vector<Body> bodies;
  std::vector<Answer> alone;
};

INSTANTIATE_TEST_SUITE_P(Methods, Batch, ::testing::ValuesIn(all_methods), named);

TEST_P(Batch, GivesTheSameBitsInAnyOrderAndCompositionOnAnyNumberOfThreads) {
  for (const int threads : {0, 1, 2, 3, 16}) expect_the_same({0, 1, 2, 3, 4, 5, 6, 7, 8}, threads);
  expect_the_same({8, 7, 6, 5, 4, 3, 2, 1, 0}, 2);
  expect_the_same({3, 3, 3, 0, 8}, 2);
  expect_the_same({}, 2);
}

TEST(Task, OfNoStepsChangesNothing) {
  const Body body = random_body(20, 6, 5, 1);
  const State start = state_at_birth(body, full_scene());
  const Answer a = simulate_ok(body, start, full_scene(), stepping, 0, {.stress = true});
  EXPECT_EQ(a.state.position, start.position);  // not even rounded
  EXPECT_EQ(a.task.stress, std::vector<double>(body.springs.size()));
}

TEST(Task, ThatDoesNotComeInAsOkIsLeftAlone) {
  const Body body = random_body(20, 6, 5, 2);
  const State birth = state_at_birth(body, full_scene());
  State state = birth;
  Task task{.body = &body, .state = &state, .steps = 100, .status = Status::invalid, .reason = "no"};
  make_cpu_simulator(full_scene(), stepping, 1)->run({&task, 1}, all_records);
  EXPECT_TRUE(same_bits(state, birth));
  EXPECT_EQ(task.status, Status::invalid);
  EXPECT_EQ(task.reason, "no");
}

TEST(GuardOfEnergy, SaysThatEnergyFromNothingIsDivergence) {
  const Body body = block(1, {1000, 0, 0, 0});
  State state = moving(body, {}, {0, 0, 3.6});  // 10.4 J
  state.time = 0.025;
  state.start_energy = 1;
  const Answer a = simulate(body, state, {}, stepping, 1000);
  EXPECT_EQ(a.task.status, Status::diverged);
  EXPECT_NE(a.task.reason.find("10.4 J"), std::string::npos) << a.task.reason;
  EXPECT_DOUBLE_EQ(a.task.ended_at, 150 * stepping.dt);
  EXPECT_EQ(a.state.time, a.task.ended_at);
  for (Vec3& v : state.velocity) v = {0, 0, 3.4};  // 9.2 J
  simulate_ok(body, state, {}, stepping, 1000);
}

TEST(GuardOfEnergy, ChecksAfter100StepsAndAtTheEndOfARun) {
  // a spring whose oscillation is too fast for the step
  const Body body = pair_of_masses(0.2, {1e7, 0, 0, 0}, 1.01);
  for (const auto& [steps, checked] : {std::pair{333u, 100u}, {30u, 30u}}) {
    const Answer a = simulate(body, state_at_birth(body, {}), {}, stepping, steps, {.stress = true, .work = true});
    EXPECT_EQ(a.task.status, Status::diverged);
    EXPECT_DOUBLE_EQ(a.task.ended_at, checked * stepping.dt);
    EXPECT_EQ(a.task.spring_evaluations, checked);
  }
}

TEST(GuardOfEnergy, SaysThatWhatIsNotFiniteIsDivergence) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  for (const Body& body : {block(1, {1000, 0, 0, 0}), single_mass(0.2)})
    for (const double bad : {nan, infinity, -infinity})
      for (int where = 0; where < 6; ++where) {
        State state = state_at_birth(body, {});
        Vec3& v = where < 3 ? state.position.back() : state.velocity.back();
        (where % 3 == 0 ? v.x : where % 3 == 1 ? v.y : v.z) = bad;
        const Answer a = simulate(body, state, {}, stepping, 1);
        EXPECT_EQ(a.task.status, Status::diverged);
        EXPECT_EQ(a.task.reason.find("non-finite"), 0u) << a.task.reason;
      }
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
