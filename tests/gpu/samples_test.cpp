// On the GPU, samples of bodies in a batch are those of the bodies alone.
#include "gpu.hpp"
#include "physics/cases.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

class GpuSamplesOfBatches : public OnGpu {};

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

TEST_F(GpuSamplesOfBatches, AreThoseOfTheBodiesAlone) {
  // bodies on the chip and beyond it, with different steps, some of them without samples; so many steps and samples
  // that they are divided into ranges
  const Scene scene = walking_scene();
  const auto simulator = make_cuda_simulator(scene, single_precision);
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
    for (std::size_t k = 0; k < task.samples.size(); ++k)
      test::expect_same_samples(tasks[i].samples[k], task.samples[k]);
  }
}

TEST_F(GpuSamplesOfBatches, AreDividedIntoPortions) {
  // a sample of all masses after every step; there is memory for few bodies at once
  const Scene scene = walking_scene();
  const Body body = random_body(500, 20, 1);
  const auto simulator = make_cuda_simulator(scene, single_precision),
             small = make_cuda_simulator(scene, single_precision, 0, std::size_t{16} << 20);
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
    for (std::size_t k = 0; k <= 450; k += 10) test::expect_same_samples(tasks[i].samples[k], tasks[0].samples[k]);
  }
}

TEST_F(GpuSamplesOfBatches, EndWithADivergence) {
  const Scene scene = walking_scene();
  const Body body = random_body(100, 20, 1);
  const auto simulator = make_cuda_simulator(scene, single_precision);
  State state = moving_state(body, scene, 7);
  Task task{.body = &body, .state = &state, .dt = 0.05, .steps = 3000};
  task.sampled_at = points_of(3000, 2);
  simulator->run({&task, 1}, {});
  EXPECT_EQ(task.status, Status::diverged);
  EXPECT_TRUE(task.samples.empty());
}

TEST_F(GpuSamplesOfBatches, OfNothingAreEmpty) {
  const Scene scene = walking_scene();
  const Body nothing, body = random_body(10, 3, 1);
  const auto simulator = make_cuda_simulator(scene, single_precision);
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

}  // namespace
}  // namespace evodevo::testing_gpu::EVODEVO_FILE
