// On the GPU: cases in which methods can fail, the guard, runs in pieces, samples, and scenes of single tasks.
#include "physics/cases.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "analysis/stability.hpp"
#include "gpu.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

class OnTheGpu : public EachWayOnGpu {
 protected:
  /// The relative accuracy of positions.
  static double rounding() { return single() ? 1e-6 : 1e-12; }
};

INSTANTIATE_TEST_SUITE_P(Gpu, OnTheGpu, all_ways(), named);

TEST_P(OnTheGpu, HardCasesAreRightOrFlagged) {
  // forces are rounded to multiples of 2^-23 of the largest force; near the limit of dt, this adds energy in each step
  test::expect_outcomes(test::hard_cases(method()), gpu, single() ? 1e-2 : 1e-6);
}

TEST_P(OnTheGpu, ScenesMayDifferWithinABatch) { test::expect_tasks_in_their_own_scenes(gpu); }

TEST_P(OnTheGpu, ResonanceLives) { test::expect_resonance_to_live(gpu, method()); }

TEST_P(OnTheGpu, TheBoundOfEnergyIsOneForOneRunAndForSeveral) { test::expect_one_bound(gpu); }

TEST_P(OnTheGpu, WhatTheFloorPumpsUpEnds) {
  if (is_explicit(method()) && method() != Method::rk4) test::expect_pumped_bodies_to_end(gpu);
}

TEST_P(OnTheGpu, PiecesAndSamplesLeaveTheBitsOfTheWhole) {
  // with 200 materials, the tables have few steps; the last two have their springs, or all of them, in the device's
  // memory
  std::vector<Body> bodies{test::random_body(107, 9, 5, 6), test::random_body(107, 9, 200, 6),
                           test::random_body(41, 6, 23, 7), test::single_mass(0.2), test::random_body(1701, 14, 5, 8)};
  if (is_explicit(method())) bodies.push_back(test::random_body(12001, 6, 5, 9));
  test::expect_pieces_to_be_the_whole(gpu, bodies);
  test::expect_samples_to_change_nothing(gpu, bodies);
}

TEST_P(OnTheGpu, PiecesBetweenTalliesLeaveThemToo) {
  test::expect_tallies_to_leave_the_motion_alone(gpu, test::random_body(41, 6, 5, 7));
}

TEST_P(OnTheGpu, PiecesAreNotCheckedWhereTheyMeet) { test::expect_no_check_between_pieces(gpu); }

TEST_P(OnTheGpu, PiecesDivergeWhereTheWholeDoes) {
  if (is_explicit(method())) test::expect_one_verdict(gpu, method());
}

TEST_P(OnTheGpu, SamplesAreTrue) {
  std::vector<Body> bodies{test::random_body(61, 9, 5, 6), test::random_body(1701, 14, 5, 8)};
  if (is_explicit(method())) bodies.push_back(test::random_body(12001, 6, 5, 9));
  for (const Body& body : bodies) test::expect_samples_to_be_true(gpu, body, rounding());
  test::expect_samples_to_be_true_after_removals(gpu, rounding());
  test::expect_samples_in_pieces(gpu, bodies.front());
}

TEST_P(OnTheGpu, SamplesCountContactFromTheLandingOn) {
  if (is_explicit(method())) test::expect_contact_from_the_landing_on(gpu);  // other methods damp an impact
}

TEST(OnTheGpuWithComputedMaterials, PiecesAndSamplesChangeNothingAndSamplesAreTrue) {
  EVODEVO_NEEDS_GPU();
  const Body large = test::random_body(1701, 14, 5, 8);
  for (const Method method : {Method::paper_euler, Method::velocity_verlet, Method::rk4}) {
    const auto factory = [&](const Scene& scene) {
      return make_cuda_simulator(scene, {method, Precision::float32, Materials::computed});
    };
    test::expect_pieces_to_be_the_whole(factory, {test::random_body(107, 9, 23, 6), large});
    test::expect_samples_to_change_nothing(factory, {test::random_body(107, 9, 23, 6), large});
    for (const Body& body : {test::random_body(61, 9, 23, 6), large})
      test::expect_samples_to_be_true(factory, body, 1e-6, Materials::computed);
  }
}

TEST_P(OnTheGpu, WhatIsNotFiniteIsDivergence) {
  const Scene scene = walking_scene();
  const Body body = random_body(50, 10, 2);
  State start = state_at_birth(body, scene);
  start.velocity[7].y = std::numeric_limits<double>::quiet_NaN();
  Robot run(body, start);
  simulate(*gpu(scene), {&run}, 300);
  EXPECT_EQ(run.answer.status, Status::diverged);
  EXPECT_EQ(run.answer.ended_at, 0.05);
  EXPECT_THAT(run.answer.reason, ::testing::HasSubstr("non-finite"));
}

class Divergence : public EachWayOnGpu {};

INSTANTIATE_TEST_SUITE_P(Gpu, Divergence, explicit_ways(), named);

TEST_P(Divergence, EndsWhenTheCpuSaysSo) {
  const Scene scene = walking_scene();
  const Body body = random_body(100, 15, 1, {{2e7, 0, 0, 0}});  // too stiff for a step of 0.5 ms
  Robot cpu(body, moving_state(body, scene, 3)), gpu(body, moving_state(body, scene, 3));
  simulate(*EachWayOnGpu::cpu(scene), {&cpu}, 1000);
  simulate(*EachWayOnGpu::gpu(scene), {&gpu}, 1000);
  EXPECT_EQ(cpu.answer.status, Status::diverged);
  EXPECT_EQ(gpu.answer.status, Status::diverged);
  EXPECT_EQ(gpu.answer.ended_at, cpu.answer.ended_at);
}

TEST_P(Divergence, ForceRange) {
  // a step beyond the stability limit makes the oscillation grow, although forces are small at the start
  const Body body = random_body(50, 10, 2);
  State start = moving_state(body, {}, 3);
  start.start_energy = 1e300;
  Robot run(body, start);
  run.dt = 1.05 * largest_dt(body, start.position, method());
  simulate(*EachWayOnGpu::gpu({}), {&run}, 300);
  EXPECT_EQ(run.answer.status, Status::diverged);
  EXPECT_THAT(run.answer.reason, ::testing::HasSubstr("force range"));
}

TEST_P(Divergence, NotUnderAWeightThatSpringsCannotBear) {
  const Scene scene = walking_scene();
  Body body = random_body(50, 10, 2);
  constexpr double scale = 1e-4;
  for (Mass& mass : body.masses) mass.rest = scale * mass.rest;
  for (Spring& spring : body.springs) spring.rest_length *= scale;
  Robot cpu(body, state_at_birth(body, scene)), gpu(body, state_at_birth(body, scene));
  simulate(*EachWayOnGpu::cpu(scene), {&cpu}, 4000);
  simulate(*EachWayOnGpu::gpu(scene), {&gpu}, 4000);
  EXPECT_EQ(cpu.answer.status, Status::ok) << cpu.answer.reason;
  EXPECT_EQ(gpu.answer.status, Status::ok) << gpu.answer.reason;
}

}  // namespace
}  // namespace evodevo::testing_gpu::EVODEVO_FILE
