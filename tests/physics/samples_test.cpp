// On the CPU, samples do not change a run, and they are true.
#include "samples.hpp"

#include <gtest/gtest.h>

namespace evodevo::test::EVODEVO_FILE {
namespace {

class Samples : public ::testing::TestWithParam<Arithmetic> {
 protected:
  static Method method() { return std::get<Method>(GetParam()); }
  static SimulatorFactory factory() {
    return [](const Scene& scene) { return make_cpu_simulator(scene, {method(), std::get<Precision>(GetParam())}, 1); };
  }
};

INSTANTIATE_TEST_SUITE_P(Ways, Samples,
                         ::testing::Combine(::testing::ValuesIn(all_methods),
                                            ::testing::Values(Precision::float32, Precision::float64)),
                         [](const auto& instance) { return name_of(instance.param); });

TEST_P(Samples, ChangeNothing) {
  expect_samples_to_change_nothing(factory(), {random_body(107, 9, 5, 6), random_body(41, 6, 23, 7), single_mass(0.2),
                                               with_dashpots(random_body(43, 8, 5, 3))});
}

TEST_P(Samples, AreTrueAfterRemovals) { expect_samples_to_be_true_after_removals(factory(), 1e-12); }

TEST_P(Samples, AreTrue) {
  expect_samples_to_be_true(factory(), random_body(61, 9, 5, 6), 1e-12);
  expect_samples_to_be_true(factory(), with_dashpots(random_body(61, 9, 5, 6)), 1e-12);
}

TEST_P(Samples, AreTheSameInPieces) { expect_samples_in_pieces(factory(), random_body(61, 9, 5, 6)); }

TEST_P(Samples, CountContactFromTheLandingOn) {
  if (!is_explicit(method())) return;  // other methods damp an impact
  expect_contact_from_the_landing_on(factory(), false);
  expect_contact_from_the_landing_on(factory(), true);
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
