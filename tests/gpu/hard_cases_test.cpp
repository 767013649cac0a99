// Where methods fail, the GPU is right or flags it as well, and no neighbour notices.
#include "physics/hard_cases.hpp"

#include "gpu.hpp"

namespace evodevo::testing_gpu {
namespace {

class HardCases : public testing::TestWithParam<test::Arithmetic> {};

INSTANTIATE_TEST_SUITE_P(Gpu, HardCases, all_ways(),
                         [](const auto& instance) { return test::name_of(instance.param); });

TEST_P(HardCases, AreRightOrFlagged) {
  EVODEVO_NEEDS_GPU();
  const auto [method, precision] = GetParam();
  test::expect_outcomes(test::hard_cases(method), [&, method = method, precision = precision](const Scene& scene) {
    return make_cuda_simulator(scene, {method, precision});
  });
}

}  // namespace
}  // namespace evodevo::testing_gpu
