// On the GPU, samples do not change a run, and they are true.
#include "physics/samples.hpp"

#include "gpu.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

class GpuSamples : public ::testing::TestWithParam<Way> {
 protected:
  static Method method() { return std::get<Method>(GetParam()); }
  static test::SimulatorFactory factory() {
    return [](const Scene& scene) { return make_cuda_simulator(scene, stepping(GetParam())); };
  }
  /// The relative accuracy of positions.
  static double rounding() { return std::get<Precision>(GetParam()) == Precision::float32 ? 1e-6 : 1e-12; }
};

INSTANTIATE_TEST_SUITE_P(Gpu, GpuSamples, all_ways(), [](const auto& test) { return name(test.param); });

TEST_P(GpuSamples, ChangeNothing) {
  EVODEVO_NEEDS_GPU();
  test::expect_samples_to_change_nothing(
      factory(), {test::random_body(107, 9, 5, 6), test::random_body(41, 6, 23, 7), test::single_mass(0.2)});
}

TEST_P(GpuSamples, ChangeNothingOfLargeBodies) {
  EVODEVO_NEEDS_GPU();
  // one with its springs in the device's memory, and one completely in the device's memory
  std::vector<Body> bodies{test::random_body(1701, 14, 5, 8)};
  if (is_explicit(method())) bodies.push_back(test::random_body(12001, 6, 5, 9));
  test::expect_samples_to_change_nothing(factory(), bodies);
}

TEST_P(GpuSamples, ChangeNothingWithTablesOfFewSteps) {
  EVODEVO_NEEDS_GPU();
  test::expect_samples_to_change_nothing(factory(), {test::random_body(107, 9, 200, 6)});
}

TEST_P(GpuSamples, AreTrue) {
  EVODEVO_NEEDS_GPU();
  test::expect_samples_to_be_true(factory(), test::random_body(61, 9, 5, 6), rounding());
}

TEST_P(GpuSamples, AreTrueAfterRemovals) {
  EVODEVO_NEEDS_GPU();
  test::expect_samples_to_be_true_after_removals(factory(), rounding());
}

TEST_P(GpuSamples, OfLargeBodiesAreTrue) {
  EVODEVO_NEEDS_GPU();
  test::expect_samples_to_be_true(factory(), test::random_body(1701, 14, 5, 8), rounding());
  if (is_explicit(method())) test::expect_samples_to_be_true(factory(), test::random_body(12001, 6, 5, 9), rounding());
}

TEST_P(GpuSamples, AreTheSameInPieces) {
  EVODEVO_NEEDS_GPU();
  test::expect_samples_in_pieces(factory(), test::random_body(61, 9, 5, 6));
}

TEST_P(GpuSamples, CountContactFromTheLandingOn) {
  EVODEVO_NEEDS_GPU();
  if (!is_explicit(method())) return;  // other methods damp an impact
  test::expect_contact_from_the_landing_on(factory(), false);
  test::expect_contact_from_the_landing_on(factory(), true);
}

TEST(GpuSamplesOfComputedMaterials, ChangeNothingAndAreTrue) {
  EVODEVO_NEEDS_GPU();
  for (const Method method : {Method::paper_euler, Method::velocity_verlet, Method::rk4}) {
    const auto factory = [&](const Scene& scene) {
      return make_cuda_simulator(scene, {method, Precision::float32, Materials::computed});
    };
    test::expect_samples_to_change_nothing(factory,
                                           {test::random_body(107, 9, 23, 6), test::random_body(1701, 14, 5, 8)});
    for (const Body& body : {test::random_body(61, 9, 23, 6), test::random_body(1701, 14, 5, 8)})
      test::expect_samples_to_be_true(factory, body, 1e-6, Materials::computed);
  }
}

/// What the tests of batches ask for: some samples of all masses, many of the body.
std::vector<SamplePoint> points_of(std::uint64_t steps, std::uint64_t interval) {
  std::vector<SamplePoint> points;
  for (std::uint64_t step = 0; step <= steps; step += interval)
    points.push_back({step,
                      {.centre = true,
                       .contact = true,
                       .work = true,
                       .positions = step % (4 * interval) == 0,
                       .contacts = step % (3 * interval) == 0}});
  return points;
}

void expect_equal(const Sample& a, const Sample& b) {
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.centre, b.centre);
  EXPECT_EQ(a.velocity, b.velocity);
  EXPECT_EQ(a.contact_steps, b.contact_steps);
  EXPECT_EQ(a.work, b.work);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.contacts, b.contacts);
}

TEST(GpuSamplesOfBatches, AreThoseOfTheBodiesAlone) {
  EVODEVO_NEEDS_GPU();
  // bodies on the chip and beyond it, with different steps, some of them without samples; so many steps and samples
  // that they are divided into ranges
  const Scene scene = walking_scene();
  const auto simulator = make_cuda_simulator(scene, stepping(Precision::float32));
  const std::vector<Body> bodies{random_body(300, 20, 1), random_body(1701, 14, 2), random_body(12001, 6, 3),
                                 random_body(40, 8, 4, {{4000, 0, 0, 0}}), random_body(300, 20, 5)};
  std::vector<State> states, alone;
  std::vector<Task> tasks;
  for (std::size_t i = 0; i < bodies.size(); ++i) states.push_back(moving_state(bodies[i], scene, i));
  alone = states;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    tasks.push_back({.body = &bodies[i], .state = &states[i], .dt = 0.0005, .steps = 3100 - 700 * i});
    if (i + 1 < bodies.size()) tasks.back().sampled_at = points_of(tasks.back().steps, 11 + i);
  }
  simulator->run(tasks, {.stress = true});
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    SCOPED_TRACE(i);
    Task task{.body = &bodies[i], .state = &alone[i], .dt = 0.0005, .steps = 3100 - 700 * i};
    task.sampled_at = tasks[i].sampled_at;
    simulator->run({&task, 1}, {.stress = true});
    EXPECT_EQ(task.status, Status::ok) << task.reason;
    EXPECT_EQ(states[i].position, alone[i].position);
    EXPECT_EQ(tasks[i].stress, task.stress);
    ASSERT_EQ(tasks[i].samples.size(), task.sampled_at.size());
    ASSERT_EQ(task.samples.size(), task.sampled_at.size());
    for (std::size_t k = 0; k < task.samples.size(); ++k) expect_equal(tasks[i].samples[k], task.samples[k]);
  }
}

TEST(GpuSamplesOfBatches, AreDividedIntoPortions) {
  EVODEVO_NEEDS_GPU();
  // a sample of all masses after every step; there is memory for few bodies at once
  const Scene scene = walking_scene();
  const Body body = random_body(500, 20, 1);
  const auto simulator = make_cuda_simulator(scene, stepping(Precision::float32)),
             small = make_cuda_simulator(scene, stepping(Precision::float32), 0, std::size_t{16} << 20);
  std::vector<State> states(41, moving_state(body, scene, 7));
  std::vector<Task> tasks;
  for (State& state : states) {
    tasks.push_back({.body = &body, .state = &state, .dt = 0.0005, .steps = 450});
    tasks.back().sampled_at = points_of(450, 1);
  }
  small->run(std::span(tasks).subspan(1), {});
  simulator->run({tasks.data(), 1}, {});
  EXPECT_EQ(simulator->device_use()->portions, 1u);
  EXPECT_GT(small->device_use()->portions, 2u);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    EXPECT_EQ(states[i].position, states[0].position);
    ASSERT_EQ(tasks[i].samples.size(), 451u);
    for (std::size_t k = 0; k <= 450; k += 10) expect_equal(tasks[i].samples[k], tasks[0].samples[k]);
  }
}

TEST(GpuSamplesOfBatches, EndWithADivergence) {
  EVODEVO_NEEDS_GPU();
  const Scene scene = walking_scene();
  const Body body = random_body(100, 20, 1);
  const auto simulator = make_cuda_simulator(scene, stepping(Precision::float32));
  State state = moving_state(body, scene, 7);
  Task task{.body = &body, .state = &state, .dt = 0.05, .steps = 3000};
  task.sampled_at = points_of(3000, 2);
  simulator->run({&task, 1}, {});
  EXPECT_EQ(task.status, Status::diverged);
  EXPECT_TRUE(task.samples.empty());
}

TEST(GpuSamplesOfBatches, OfNothingAreEmpty) {
  EVODEVO_NEEDS_GPU();
  const Scene scene = walking_scene();
  const Body nothing, body = random_body(10, 3, 1);
  const auto simulator = make_cuda_simulator(scene, stepping(Precision::float32));
  State none, still = moving_state(body, scene, 7);
  std::vector<Task> tasks{{.body = &nothing, .state = &none, .steps = 4}, {.body = &body, .state = &still, .steps = 0}};
  tasks[0].sampled_at = {{0, {.positions = true}}, {3, {.positions = true}}, {4, {.centre = true}}};
  tasks[1].sampled_at = {{0, {.positions = true}}};
  simulator->run(tasks, {});
  ASSERT_EQ(tasks[0].samples.size(), 3u);
  EXPECT_EQ(tasks[0].samples[1].time, 3 * tasks[0].dt);
  ASSERT_EQ(tasks[1].samples.size(), 1u);
  EXPECT_EQ(tasks[1].samples[0].positions.size(), 30u);
}

class GpuRecords : public ::testing::TestWithParam<Way> {};

INSTANTIATE_TEST_SUITE_P(Gpu, GpuRecords, all_ways(), [](const auto& test) { return name(test.param); });

TEST_P(GpuRecords, DoNotChangeEachOther) {
  EVODEVO_NEEDS_GPU();
  // with many materials, the table on the chip has few steps
  const Scene scene = walking_scene();
  const Body body = test::random_body(107, 9, 200, 6);
  const auto simulator = make_cuda_simulator(scene, stepping(GetParam()));
  const auto stress = [&](Recording recording) {
    State state = moving_state(body, scene, 7);
    Task task{.body = &body, .state = &state, .dt = 0.0005, .steps = 450};
    simulator->run({&task, 1}, recording);
    EXPECT_EQ(task.status, Status::ok) << task.reason;
    return task.stress;
  };
  EXPECT_EQ(stress({.stress = true}), stress({.stress = true, .work = true}));
  EXPECT_EQ(stress({.stress = true}), stress({true, true, true, true, true}));
}

}  // namespace
}  // namespace evodevo::testing_gpu::EVODEVO_FILE
