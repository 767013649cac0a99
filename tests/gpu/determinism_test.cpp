// The result of a body is bit-identical, whatever its position in a batch and however often it is computed.
#include <algorithm>
#include <optional>

#include "gpu.hpp"
#include "threads/parallel.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

class Determinism : public EachWayOnGpu {
 protected:
  const Scene scene = walking_scene();
};

/// Moving bodies of many sizes, of which every one whose index is `first` modulo `every` is taken.
std::vector<Robot> robots_in(const Scene& scene, const std::vector<Body>& bodies, std::size_t first = 0,
                             std::size_t every = 1, std::optional<std::uint64_t> seed = {}) {
  std::vector<Robot> robots;
  for (std::size_t i = first; i < bodies.size(); i += every)
    robots.emplace_back(bodies[i], moving_state(bodies[i], scene, seed.value_or(i)));
  return robots;
}

std::vector<Body> bodies_of_many_sizes() {
  std::vector<Body> bodies;
  for (std::uint32_t i = 0; i < 16; ++i) bodies.push_back(random_body(20 + 47 * i, 15, i));
  return bodies;
}

TEST_P(Determinism, AloneInAnySlotAndAgain) {
  const auto simulator = gpu(scene);
  const std::vector<Body> bodies = bodies_of_many_sizes();
  std::vector<Robot> forwards = robots_in(scene, bodies), backwards = forwards, again = forwards, alone = forwards;
  std::reverse(backwards.begin(), backwards.end());
  simulate(*simulator, forwards, 500, all_records);
  simulate(*simulator, backwards, 500, all_records);
  simulate(*gpu(scene), again, 500, all_records);
  std::reverse(backwards.begin(), backwards.end());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    expect_same_bits(forwards[i], backwards[i]);
    expect_same_bits(forwards[i], again[i]);
  }
  for (const std::size_t i : {0u, 8u, 15u}) {
    simulate(*simulator, {&alone[i]}, 500, all_records);
    expect_same_bits(forwards[i], alone[i]);
  }
}

TEST_P(Determinism, BesideBodiesOfOtherSteps) {
  const auto simulator = gpu(scene);
  // a body on the chip, and a streamed one
  for (const std::uint32_t masses : {60u, 12000u}) {
    const Body body = random_body(masses, 8, 3);
    const Robot robot(body, moving_state(body, scene, 1));
    std::vector<Robot> together(4, robot);
    std::vector<Task> tasks;
    for (std::size_t i = 0; i < together.size(); ++i) {
      together[i].dt = 0.0005 / static_cast<double>(1 + i);
      tasks.push_back(together[i].task(130 + 70 * i));
    }
    simulator->run(tasks, all_records);
    for (std::size_t i = 0; i < together.size(); ++i) {
      together[i].answer = tasks[i];
      EXPECT_DOUBLE_EQ(together[i].state.time, together[i].dt * static_cast<double>(130 + 70 * i));
      Robot alone = robot;
      alone.dt = together[i].dt;
      simulate(*simulator, {&alone}, 130 + 70 * i, all_records);
      expect_same_bits(together[i], alone);
    }
  }
}

TEST_P(Determinism, BesideBodiesWithAndWithoutMuscles) {
  const auto simulator = gpu(scene);
  // a body on the chip, one with its springs in the device's memory, and one completely in the device's memory
  for (const std::uint32_t masses : {60u, 1500u, 12000u}) {
    if (masses > 1500 && !is_explicit(method())) continue;
    const Body still = random_body(masses, 8, 3, {{4000, 0, 0, 0}, {10000, 0, 0, 0}});
    const Body lively = random_body(masses, 8, 4);
    Robot still_beside(still, moving_state(still, scene, 1)), still_alone = still_beside;
    Robot lively_beside(lively, moving_state(lively, scene, 2)), lively_alone = lively_beside;
    simulate(*simulator, {&still_beside, &lively_beside}, 230, all_records);
    simulate(*simulator, {&still_alone}, 230, all_records);
    simulate(*simulator, {&lively_alone}, 230, all_records);
    expect_same_bits(still_beside, still_alone);
    expect_same_bits(lively_beside, lively_alone);
  }
}

TEST_P(Determinism, InPortions) {
  const Body small = random_body(100, 15, 3), large = random_body(1500, 20, 4);
  const auto enough = gpu(scene);
  const auto scarce = make_cuda_simulator(scene, way(), 0, 100'000);
  for (const Body* body : {&small, &large}) {
    std::vector<Robot> together(5, Robot(*body, state_at_birth(*body, scene))), apart = together;
    simulate(*enough, together, 200, {.stress = true});
    simulate(*scarce, apart, 200, {.stress = true});
    for (std::size_t i = 0; i < together.size(); ++i) expect_same_bits(together[i], apart[i]);
  }
}

TEST_P(Determinism, InternalForcesLeaveTheMomentumAlone) {
  Body body = random_body(200, 15, 5);
  for (Mass& mass : body.masses) mass.mass = 0.25;
  Robot run(body, state_at_birth(body, {}));
  simulate(*gpu({}), {&run}, 1000);
  // the method `implicit` solves the equation of each step only up to a relative residual of 1e-6
  const double rest = method() == Method::implicit ? 1e-5 : 1e-12;
  EXPECT_LT(norm(test::momentum(body, run.state).linear), single() ? 1e-4 : rest);
}

INSTANTIATE_TEST_SUITE_P(Gpu, Determinism, all_ways(), named);

TEST(DeterminismOfSimulators, SideBySideAsAlone) {
  EVODEVO_NEEDS_GPU();
  const std::vector<Stepping> ways{{Method::paper_euler, Precision::float32},
                                   {Method::paper_euler, Precision::float64},
                                   {Method::rk4, Precision::float32},
                                   {Method::xpbd, Precision::float32},
                                   {Method::paper_euler, Precision::float32}};
  constexpr std::size_t simulators = 60;  // so many that those of the same kind wait, and then simulate together
  const auto scene_of_simulator = [](std::size_t i) {
    Scene scene = walking_scene();
    scene.gravity->slope = static_cast<double>(i % 7);
    return scene;
  };
  const std::vector<Body> bodies = bodies_of_many_sizes();
  const auto simulate_all = [&](std::vector<Robot>& robots, std::size_t i) {
    simulate(*make_cuda_simulator(scene_of_simulator(i), ways[i % ways.size()]), robots, 700,
             {.stress = true, .work = true});
  };
  std::vector<std::vector<Robot>> alone, together;
  for (std::size_t i = 0; i < simulators; ++i) {
    together.push_back(robots_in(scene_of_simulator(i), bodies, i % 4, 4, i));
    alone.push_back(together.back());
    simulate_all(alone.back(), i);
  }
  on_own_threads(simulators, [&](std::size_t i) { simulate_all(together[i], i); });
  for (std::size_t i = 0; i < simulators; ++i)
    for (std::size_t k = 0; k < alone[i].size(); ++k) expect_same_bits(alone[i][k], together[i][k]);
}

}  // namespace
}  // namespace evodevo::testing_gpu::EVODEVO_FILE
