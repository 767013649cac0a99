// In cases in which methods can fail, the GPU gives correct results or flags the failure, and other bodies are not
// affected.
#include "physics/hard_cases.hpp"

#include "gpu.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

class HardCases : public ::testing::TestWithParam<test::Arithmetic> {};

INSTANTIATE_TEST_SUITE_P(Gpu, HardCases, all_ways(),
                         [](const auto& instance) { return test::name_of(instance.param); });

TEST_P(HardCases, AreRightOrFlagged) {
  EVODEVO_NEEDS_GPU();
  const auto [method, precision] = GetParam();
  // forces are rounded to multiples of 2^-23 of the largest force; near the limit of dt, this adds energy in each step
  const double rounding = precision == Precision::float32 ? 1e-2 : 1e-6;
  test::expect_outcomes(
      test::hard_cases(method),
      [&, method = method, precision = precision](const Scene& scene) {
        return make_cuda_simulator(scene, {method, precision});
      },
      rounding);
}

}  // namespace
}  // namespace evodevo::testing_gpu::EVODEVO_FILE
