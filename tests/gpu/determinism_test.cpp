// The result of a body is bit-identical, whatever its position in a batch and however often it is computed.
#include "analysis/ground.hpp"
#include "gpu.hpp"
#include "physics/scenes.hpp"
#include "threads/parallel.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

class Determinism : public ::testing::TestWithParam<Way> {};

void expect_same_bits(const Robot& a, const Robot& b) {
  EXPECT_EQ(a.answer.status, b.answer.status);
  EXPECT_EQ(a.state.position, b.state.position);
  EXPECT_EQ(a.state.velocity, b.state.velocity);
  for (const auto list : SpringRecords::lists) EXPECT_EQ(a.answer.*list, b.answer.*list);
  EXPECT_EQ(a.answer.work, b.answer.work);
}

TEST_P(Determinism, AloneInAnySlotAndAgain) {
  EVODEVO_NEEDS_GPU();
  const Scene scene = walking_scene();
  const Recording all{.stress = true, .work = true, .peak_force = true, .muscle_work = true, .tension = true};
  const auto simulator = make_cuda_simulator(scene, stepping(GetParam()));
  std::vector<Body> bodies;
  for (std::uint32_t i = 0; i < 16; ++i) bodies.push_back(random_body(20 + 47 * i, 15, i));
  std::vector<State> starts;
  for (std::size_t i = 0; i < bodies.size(); ++i) starts.push_back(moving_state(bodies[i], scene, i));

  std::vector<Robot> forwards, backwards, again;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    forwards.emplace_back(bodies[i], starts[i]);
    backwards.emplace_back(bodies[i], starts[i]);
    again.emplace_back(bodies[i], starts[i]);
  }
  std::vector<Robot*> in_order, reversed, repeated;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    in_order.push_back(&forwards[i]);
    reversed.insert(reversed.begin(), &backwards[i]);
    repeated.push_back(&again[i]);
  }
  simulate(*simulator, in_order, 500, all);
  simulate(*simulator, reversed, 500, all);
  simulate(*make_cuda_simulator(scene, stepping(GetParam())), repeated, 500, all);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    expect_same_bits(forwards[i], backwards[i]);
    expect_same_bits(forwards[i], again[i]);
  }
  for (const std::size_t i : {0u, 8u, 15u}) {
    Robot alone(bodies[i], starts[i]);
    simulate(*simulator, {&alone}, 500, all);
    expect_same_bits(forwards[i], alone);
  }
}

TEST_P(Determinism, BesideBodiesOfOtherSteps) {
  EVODEVO_NEEDS_GPU();
  const Scene scene = walking_scene();
  const Recording all{.stress = true, .work = true, .peak_force = true, .muscle_work = true, .tension = true};
  const auto simulator = make_cuda_simulator(scene, stepping(GetParam()));
  // a body on the chip, and a streamed one
  for (const std::uint32_t masses : {60u, 12000u}) {
    const Body body = random_body(masses, 8, 3);
    std::vector<Robot> together;
    std::vector<Robot*> batch;
    for (int i = 0; i < 4; ++i) {
      together.emplace_back(body, moving_state(body, scene, 1));
      together.back().dt = 0.0005 / (1 + i);
    }
    std::vector<Task> tasks;
    for (std::size_t i = 0; i < together.size(); ++i) tasks.push_back(together[i].task(130 + 70 * i));
    simulator->run(tasks, all);
    for (std::size_t i = 0; i < together.size(); ++i) {
      together[i].answer = tasks[i];
      EXPECT_DOUBLE_EQ(together[i].state.time, together[i].dt * static_cast<double>(130 + 70 * i));
      Robot alone(body, moving_state(body, scene, 1));
      alone.dt = together[i].dt;
      simulate(*simulator, {&alone}, 130 + 70 * i, all);
      expect_same_bits(together[i], alone);
    }
  }
}

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
  std::vector<Body> bodies;
  for (std::uint32_t k = 0; k < 16; ++k) bodies.push_back(random_body(20 + 47 * k, 15, k));
  const auto robots_of = [&](std::size_t i) {
    std::vector<Robot> robots;
    for (std::size_t k = i % 4; k < bodies.size(); k += 4)
      robots.emplace_back(bodies[k], moving_state(bodies[k], scene_of_simulator(i), i));
    return robots;
  };
  const auto simulate_all = [&](std::vector<Robot>& robots, std::size_t i) {
    std::vector<Robot*> batch;
    for (Robot& robot : robots) batch.push_back(&robot);
    simulate(*make_cuda_simulator(scene_of_simulator(i), ways[i % ways.size()]), batch, 700,
             {.stress = true, .work = true});
  };
  std::vector<std::vector<Robot>> alone, together;
  for (std::size_t i = 0; i < simulators; ++i) {
    alone.push_back(robots_of(i));
    simulate_all(alone.back(), i);
    together.push_back(robots_of(i));
  }
  on_own_threads(simulators, [&](std::size_t i) { simulate_all(together[i], i); });
  for (std::size_t i = 0; i < simulators; ++i)
    for (std::size_t k = 0; k < alone[i].size(); ++k) expect_same_bits(alone[i][k], together[i][k]);
}

TEST_P(Determinism, BesideBodiesWithAndWithoutMuscles) {
  EVODEVO_NEEDS_GPU();
  const Scene scene = walking_scene();
  const Recording all{.stress = true, .work = true, .peak_force = true, .muscle_work = true, .tension = true};
  const auto simulator = make_cuda_simulator(scene, stepping(GetParam()));
  // a body on the chip, one with its springs in the device's memory, and one completely in the device's memory
  for (const std::uint32_t masses : {60u, 1500u, 12000u}) {
    if (masses > 1500 && !is_explicit(std::get<Method>(GetParam()))) continue;
    const Body still = random_body(masses, 8, 3, {{4000, 0, 0, 0}, {10000, 0, 0, 0}});
    const Body lively = random_body(masses, 8, 4);
    Robot still_beside(still, moving_state(still, scene, 1)), still_alone = still_beside;
    Robot lively_beside(lively, moving_state(lively, scene, 2)), lively_alone = lively_beside;
    simulate(*simulator, {&still_beside, &lively_beside}, 230, all);
    simulate(*simulator, {&still_alone}, 230, all);
    simulate(*simulator, {&lively_alone}, 230, all);
    expect_same_bits(still_beside, still_alone);
    expect_same_bits(lively_beside, lively_alone);
  }
}

TEST_P(Determinism, InPortions) {
  EVODEVO_NEEDS_GPU();
  const Scene scene = walking_scene();
  const Body small = random_body(100, 15, 3), large = random_body(1500, 20, 4);
  const auto enough = make_cuda_simulator(scene, stepping(GetParam()));
  const auto scarce = make_cuda_simulator(scene, stepping(GetParam()), 0, 100'000);
  for (const Body* body : {&small, &large}) {
    std::vector<Robot> together(5, Robot(*body, state_at_birth(*body, scene))), apart = together;
    simulate(*enough, {&together[0], &together[1], &together[2], &together[3], &together[4]}, 200, {.stress = true});
    simulate(*scarce, {&apart[0], &apart[1], &apart[2], &apart[3], &apart[4]}, 200, {.stress = true});
    for (std::size_t i = 0; i < together.size(); ++i) expect_same_bits(together[i], apart[i]);
  }
}

TEST_P(Determinism, InternalForcesLeaveTheMomentumAlone) {
  EVODEVO_NEEDS_GPU();
  Body body = random_body(200, 15, 5);
  for (Mass& mass : body.masses) mass.mass = 0.25;
  const auto simulator = make_cuda_simulator(Scene{}, stepping(GetParam()));
  Robot run(body, state_at_birth(body, {}));
  simulate(*simulator, {&run}, 1000);
  Vec3 momentum;
  for (const Vec3& velocity : run.state.velocity) momentum = momentum + 0.25 * velocity;
  const auto [method, precision] = GetParam();
  // the method `implicit` solves the equation of each step only up to a relative residual of 1e-6
  const double rest = method == Method::implicit ? 1e-5 : 1e-12;
  EXPECT_LT(norm(momentum), precision == Precision::float32 ? 1e-4 : rest);
}

TEST_P(Determinism, HoldsForTasksInTheirOwnScenes) {
  EVODEVO_NEEDS_GPU();
  test::expect_tasks_in_their_own_scenes(
      [](const Scene& scene) { return make_cuda_simulator(scene, stepping(GetParam())); });
}

INSTANTIATE_TEST_SUITE_P(Gpu, Determinism, all_ways(), [](const auto& test) { return name(test.param); });

}  // namespace
}  // namespace evodevo::testing_gpu::EVODEVO_FILE
