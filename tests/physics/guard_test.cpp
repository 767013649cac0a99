// On the CPU, the guard does not stop bodies driven by muscles, but stops bodies whose energy grows without a source.
#include <gtest/gtest.h>

#include "guard_cases.hpp"
#include "physics/energy_bound.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

class GuardOfEachMethod : public ::testing::TestWithParam<Arithmetic> {
 protected:
  static Method method() { return std::get<Method>(GetParam()); }
  static SimulatorFactory factory() {
    return [](const Scene& scene) { return make_cpu_simulator(scene, {method(), std::get<Precision>(GetParam())}, 1); };
  }
};

INSTANTIATE_TEST_SUITE_P(Ways, GuardOfEachMethod,
                         ::testing::Combine(::testing::ValuesIn(all_methods),
                                            ::testing::Values(Precision::float32, Precision::float64)),
                         [](const auto& instance) { return name_of(instance.param); });

TEST_P(GuardOfEachMethod, LetsResonanceLive) { expect_resonance_to_live(factory(), method()); }

TEST_P(GuardOfEachMethod, HasOneBoundForOneRunAndForSeveral) { expect_one_bound(factory()); }

TEST(EnergyBound, GrowsWithTheSquareOfWhatTheMusclesAdd) {
  // the root of 4 J + 5 J is 3; in 2 s, muscles raise it to 9, and so add 81 J - 9 J
  EnergyBound bound{.start = 4, .drive = 3, .allowance = 1};
  EXPECT_DOUBLE_EQ(bound.added(2, 5), 72);
  EXPECT_DOUBLE_EQ(bound.limit(2, 5), 10 * (4 + 72 + 5 + 1));
  bound.start = -1;  // counts as 0
  EXPECT_DOUBLE_EQ(bound.added(2, 0), 36);
  EXPECT_DOUBLE_EQ(bound.limit(2, 0), 10 * (36 + 1));
}

TEST_P(GuardOfEachMethod, EndsWhatTheFloorPumpsUp) {
  // the other methods are stable at this step
  if (is_explicit(method()) && method() != Method::rk4) expect_pumped_bodies_to_end(factory());
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
