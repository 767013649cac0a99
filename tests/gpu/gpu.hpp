// Helpers for tests that need a GPU.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "bodies.hpp"
#include "cuda/runtime/cuda_simulator.hpp"
#include "physics/ways.hpp"

namespace evodevo::testing_gpu {

using test::all_methods, test::all_records, test::all_ways, test::explicit_ways, test::named;

/// Skips a test if there is no usable GPU; with EVODEVO_REQUIRE_GPU=1, the test fails instead.
#define EVODEVO_NEEDS_GPU()                                          \
  do {                                                               \
    const std::string missing = evodevo::why_cuda_is_unusable();     \
    if (missing.empty()) break;                                      \
    const char* required = std::getenv("EVODEVO_REQUIRE_GPU");       \
    if (required && std::string(required) == "1") FAIL() << missing; \
    GTEST_SKIP() << missing;                                         \
  } while (false)

class OnGpu : public ::testing::Test {
 protected:
  void SetUp() override { EVODEVO_NEEDS_GPU(); }
};

/// Tests that are run with several methods and precisions.
class EachWayOnGpu : public ::testing::TestWithParam<test::Arithmetic> {
 protected:
  void SetUp() override { EVODEVO_NEEDS_GPU(); }
  static Method method() { return std::get<Method>(GetParam()); }
  static bool single() { return std::get<Precision>(GetParam()) == Precision::float32; }
  static Stepping way(Materials materials = Materials::table) {
    return {method(), std::get<Precision>(GetParam()), materials};
  }
  static std::unique_ptr<Simulator> cpu(const Scene& scene, int threads = 1) {
    return make_cpu_simulator(scene, way(), threads);
  }
  static std::unique_ptr<Simulator> gpu(const Scene& scene) { return make_cuda_simulator(scene, way()); }
};

inline constexpr Stepping single_precision{Method::paper_euler, Precision::float32};

/// Expects that a body has moved on both devices alike, up to `near` (m), and that its records are alike.
inline void expect_agreement(const Robot& cpu, const Robot& gpu, double near, double near_force, double near_work) {
  EXPECT_EQ(cpu.answer.status, gpu.answer.status) << cpu.answer.reason << " / " << gpu.answer.reason;
  EXPECT_EQ(cpu.state.time, gpu.state.time);
  EXPECT_EQ(cpu.answer.spring_evaluations, gpu.answer.spring_evaluations);
  EXPECT_LE(distance(cpu.state, gpu.state), near);
  for (const auto list : SpringRecords::lists) ASSERT_EQ((cpu.answer.*list).size(), (gpu.answer.*list).size());
  for (std::size_t i = 0; i < cpu.answer.stress.size(); ++i) {
    const double of_force = near_force * (1 + cpu.answer.stress[i]);
    ASSERT_NEAR(cpu.answer.stress[i], gpu.answer.stress[i], of_force) << i;
    ASSERT_NEAR(cpu.answer.tension[i], gpu.answer.tension[i], of_force) << i;
    ASSERT_NEAR(cpu.answer.peak_force[i], gpu.answer.peak_force[i], 2 * of_force * (1 + cpu.answer.peak_force[i])) << i;
    ASSERT_NEAR(cpu.answer.muscle_work[i], gpu.answer.muscle_work[i], of_force) << i;
  }
  EXPECT_NEAR(cpu.answer.work, gpu.answer.work, near_work * (1e-3 + cpu.answer.work));
}

inline void expect_same_bits(const Robot& a, const Robot& b) {
  EXPECT_EQ(a.answer.status, b.answer.status);
  EXPECT_EQ(a.state.position, b.state.position);
  EXPECT_EQ(a.state.velocity, b.state.velocity);
  for (const auto list : SpringRecords::lists) EXPECT_EQ(a.answer.*list, b.answer.*list);
  EXPECT_EQ(a.answer.work, b.answer.work);
}

}  // namespace evodevo::testing_gpu
