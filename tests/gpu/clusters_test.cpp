// A body gets the same bits whether a block or a cluster of blocks simulates it. A body alone gets a large cluster;
// many bodies share the device.
#include "gpu.hpp"
#include "physics/cases.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

const Recording order_free{.stress = true, .work = false, .peak_force = true, .muscle_work = false, .tension = true};

/// Compares a body that is alone with several that are simulated together, for each of the given numbers of bodies.
void expect_the_same_in_any_number(const Scene& scene, const Stepping& stepping, const Body& body,
                                   std::vector<std::size_t> numbers) {
  const State start = moving_state(body, scene, 7);
  const auto simulator = make_cuda_simulator(scene, stepping);
  Robot alone(body, start);
  constexpr std::uint64_t steps = 10050;  // long enough to be worth a cluster
  simulate(*simulator, {&alone}, steps, order_free);
  EXPECT_EQ(alone.answer.status, Status::ok) << alone.answer.reason;
  for (const std::size_t number : numbers) {
    SCOPED_TRACE(number);
    std::vector<Robot> robots(number, Robot(body, start));
    simulate(*simulator, robots, steps, order_free);
    for (const Robot& robot : {robots.front(), robots.back()}) expect_same_bits(robot, alone);
  }
}

Body damped_body() {
  Body body = random_body(500, 20, 6);
  for (Material& material : body.materials) material.damping = 0.05;
  return body;
}

class Clusters : public EachWayOnGpu {};

TEST_P(Clusters, AnyNumberOfBlocksGivesTheSameBits) {
  // on an H200 in single precision, clusters of 8, 5, 4, 3, 2 and 1 blocks
  expect_the_same_in_any_number(walking_scene(), way(), random_body(1000, 20, 5), {12, 20, 28, 36, 60, 150});
  expect_the_same_in_any_number(walking_scene(), way(), damped_body(), {28, 150});
}

TEST_P(Clusters, RecordsChangeNothingAndCountEverySpringOnce) {
  const Scene scene = walking_scene();
  const Body body = random_body(3000, 20, 8);
  const State start = moving_state(body, scene, 3);
  const auto simulator = gpu(scene);
  Robot plain(body, start), recorded(body, start);
  simulate(*simulator, {&plain}, 250, order_free);
  simulate(*simulator, {&recorded}, 250, all_records);
  EXPECT_EQ(plain.state.position, recorded.state.position);
  EXPECT_EQ(plain.answer.stress, recorded.answer.stress);
  double work = 0;
  for (const double of_muscle : recorded.answer.muscle_work) work += of_muscle;
  EXPECT_NEAR(work, recorded.answer.work, 1e-4 * std::abs(work)) << "whether it is cut or not";
}

INSTANTIATE_TEST_SUITE_P(Gpu, Clusters, explicit_ways(), named);

TEST(ClustersWithoutWays, OfComputedMaterialsToo) {
  EVODEVO_NEEDS_GPU();
  const Stepping computed{.materials = Materials::computed};
  expect_the_same_in_any_number(walking_scene(), computed, random_body(1000, 20, 5), {28, 150});
  expect_the_same_in_any_number(walking_scene(), computed, damped_body(), {28, 150});
}

TEST(ClustersWithoutWays, SamplesAndEnergiesDoNotDependOnTheNumberOfBlocks) {
  EVODEVO_NEEDS_GPU();
  const Scene falling{Gravity{}, {}, {}, Damping{}, {}};
  const Body body = random_body(900, 15, 4);
  const State start = moving_state(body, falling, 3);
  const Channels all{.centre = true, .box = true, .positions = true, .velocities = true, .forces = true};
  const auto ends = [&](unsigned largest_cluster) {
    const auto simulator = make_cuda_simulator(falling, single_precision, 0, default_portion, largest_cluster);
    Robot robot(body, start);
    Task task = robot.task(12000);
    task.sampled_at = {{130, all}, {131, all}, {9000, all}, {12000, all}};
    simulator->run({&task, 1}, {});
    EXPECT_EQ(task.status, Status::ok) << task.reason;
    return std::pair(robot.state, task.samples);
  };
  const auto [one, of_one] = ends(1);
  for (const unsigned blocks : {3u, 16u}) {
    SCOPED_TRACE(blocks);
    const auto [several, of_several] = ends(blocks);
    EXPECT_EQ(several.position, one.position);
    EXPECT_EQ(several.start_energy, one.start_energy);
    ASSERT_EQ(of_several.size(), of_one.size());
    for (std::size_t i = 0; i < of_one.size(); ++i) test::expect_same_samples(of_several[i], of_one[i]);
  }
}

}  // namespace
}  // namespace evodevo::testing_gpu::EVODEVO_FILE
