// Cases in which methods can fail: each gives a correct result or is flagged with time and reason, and other bodies of
// the batch are not affected.
#include "hard_cases.hpp"

#include <gtest/gtest.h>

namespace evodevo::test::EVODEVO_FILE {
namespace {

class HardCases : public ::testing::TestWithParam<Arithmetic> {};

INSTANTIATE_TEST_SUITE_P(Methods, HardCases,
                         ::testing::Combine(::testing::ValuesIn(all_methods),
                                            ::testing::Values(Precision::float32, Precision::float64)),
                         [](const auto& instance) { return name_of(instance.param); });

TEST_P(HardCases, AreRightOrFlagged) {
  const auto [method, precision] = GetParam();
  expect_outcomes(hard_cases(method), [&, method = method, precision = precision](const Scene& scene) {
    return make_cpu_simulator(scene, {method, precision}, 1);
  });
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
