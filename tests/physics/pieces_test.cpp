// On the CPU, a simulation in several pieces equals the simulation as a whole.
#include "pieces.hpp"

#include <gtest/gtest.h>

namespace evodevo::test::EVODEVO_FILE {
namespace {

class Pieces : public ::testing::TestWithParam<Arithmetic> {
 protected:
  static Method method() { return std::get<Method>(GetParam()); }
  static SimulatorFactory factory() {
    return [](const Scene& scene) { return make_cpu_simulator(scene, {method(), std::get<Precision>(GetParam())}, 1); };
  }
};

INSTANTIATE_TEST_SUITE_P(Ways, Pieces,
                         ::testing::Combine(::testing::ValuesIn(all_methods),
                                            ::testing::Values(Precision::float32, Precision::float64)),
                         [](const auto& instance) { return name_of(instance.param); });

TEST_P(Pieces, EndInTheBitsOfTheWhole) {
  expect_pieces_to_be_the_whole(factory(), {random_body(107, 9, 5, 6), random_body(41, 6, 23, 7), single_mass(0.2),
                                            with_dashpots(random_body(43, 8, 5, 3))});
}

TEST_P(Pieces, BetweenTalliesToo) {
  expect_tallies_to_leave_the_motion_alone(factory(), random_body(41, 6, 5, 7));
  expect_tallies_to_leave_the_motion_alone(factory(), with_dashpots(random_body(41, 6, 5, 7)));
}

TEST_P(Pieces, AreNotCheckedWhereTheyMeet) { expect_no_check_between_pieces(factory()); }

TEST_P(Pieces, DivergeWhereTheWholeDoes) {
  if (is_explicit(method())) expect_one_verdict(factory(), method());
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
