// Bodies whose energy grows without a source are stopped, and other bodies are not affected.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "analysis/ground.hpp"
#include "analysis/stability.hpp"
#include "gpu.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

class Divergence : public ::testing::TestWithParam<Way> {};

/// A body that is too stiff for a step of 0.5 ms, and diverges.
Body unstable_body() { return random_body(100, 15, 1, {{2e7, 0, 0, 0}}); }

TEST_P(Divergence, StopsOneBodyAlone) {
  EVODEVO_NEEDS_GPU();
  const Scene scene = walking_scene();
  const Body bad = unstable_body(), good = random_body(100, 15, 2);
  const State bad_start = moving_state(bad, scene, 3), good_start = moving_state(good, scene, 4);
  const auto simulator = make_cuda_simulator(scene, stepping(GetParam()));
  Robot alone(good, good_start), beside(good, good_start), diverging(bad, bad_start);
  simulate(*simulator, {&alone}, 1000, {.stress = true});
  simulate(*simulator, {&diverging, &beside}, 1000, {.stress = true});
  EXPECT_EQ(diverging.answer.status, Status::diverged);
  EXPECT_FALSE(diverging.answer.reason.empty());
  EXPECT_GT(diverging.answer.ended_at, 0);
  EXPECT_LT(diverging.answer.ended_at, 0.5);
  const double checks = diverging.answer.ended_at / 0.05;
  EXPECT_NEAR(checks, std::round(checks), 1e-9);
  EXPECT_TRUE(diverging.answer.stress.empty());
  EXPECT_EQ(beside.answer.status, Status::ok) << beside.answer.reason;
  EXPECT_EQ(beside.state.position, alone.state.position);
  EXPECT_EQ(beside.answer.stress, alone.answer.stress);
}

TEST_P(Divergence, EndsWhenTheCpuSaysSo) {
  EVODEVO_NEEDS_GPU();
  const Scene scene = walking_scene();
  const Body body = unstable_body();
  Robot cpu(body, moving_state(body, scene, 3)), gpu(body, moving_state(body, scene, 3));
  simulate(*make_cpu_simulator(scene, stepping(GetParam()), 1), {&cpu}, 1000);
  simulate(*make_cuda_simulator(scene, stepping(GetParam())), {&gpu}, 1000);
  EXPECT_EQ(cpu.answer.status, Status::diverged);
  EXPECT_EQ(gpu.answer.status, Status::diverged);
  EXPECT_EQ(gpu.answer.ended_at, cpu.answer.ended_at);
}

class NotFinite : public ::testing::TestWithParam<Way> {};

TEST_P(NotFinite, IsDivergence) {
  EVODEVO_NEEDS_GPU();
  const Scene scene = walking_scene();
  const Body body = random_body(50, 10, 2);
  State start = state_at_birth(body, scene);
  start.velocity[7].y = std::numeric_limits<double>::quiet_NaN();
  Robot run(body, start);
  simulate(*make_cuda_simulator(scene, stepping(GetParam())), {&run}, 300);
  EXPECT_EQ(run.answer.status, Status::diverged);
  EXPECT_EQ(run.answer.ended_at, 0.05);
  EXPECT_THAT(run.answer.reason, ::testing::HasSubstr("non-finite"));
}

TEST_P(Divergence, ForceRange) {
  EVODEVO_NEEDS_GPU();
  // a step beyond the stability limit makes the oscillation grow, although forces are small at the start
  const Body body = random_body(50, 10, 2);
  State start = moving_state(body, {}, 3);
  start.start_energy = 1e300;
  Robot run(body, start);
  run.dt = 1.05 * largest_dt(body, start.position, std::get<Method>(GetParam()));
  simulate(*make_cuda_simulator(Scene{}, stepping(GetParam())), {&run}, 300);
  EXPECT_EQ(run.answer.status, Status::diverged);
  EXPECT_THAT(run.answer.reason, ::testing::HasSubstr("force range"));
}

TEST_P(Divergence, NotUnderAWeightThatSpringsCannotBear) {
  EVODEVO_NEEDS_GPU();
  const Scene scene = walking_scene();
  Body body = random_body(50, 10, 2);
  constexpr double scale = 1e-4;
  for (Mass& mass : body.masses) mass.rest = scale * mass.rest;
  for (Spring& spring : body.springs) spring.rest_length *= scale;
  Robot cpu(body, state_at_birth(body, scene)), gpu(body, state_at_birth(body, scene));
  simulate(*make_cpu_simulator(scene, stepping(GetParam()), 1), {&cpu}, 4000);
  simulate(*make_cuda_simulator(scene, stepping(GetParam())), {&gpu}, 4000);
  EXPECT_EQ(cpu.answer.status, Status::ok) << cpu.answer.reason;
  EXPECT_EQ(gpu.answer.status, Status::ok) << gpu.answer.reason;
}

INSTANTIATE_TEST_SUITE_P(Gpu, Divergence, explicit_ways(), [](const auto& test) { return name(test.param); });
INSTANTIATE_TEST_SUITE_P(Gpu, NotFinite, all_ways(), [](const auto& test) { return name(test.param); });

}  // namespace
}  // namespace evodevo::testing_gpu::EVODEVO_FILE
