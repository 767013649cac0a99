// How far a tiny displacement can send a body: a measure by which other tests tell rounding from faults.
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/ground.hpp"
#include "random_lives.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

constexpr double moved = 1e-9, speed = 1.7, dt = 0.00013;
constexpr int steps_before_landing = 40;

/// A mass that sinks at a constant speed towards the height 0, and on for half as many steps again.
Life sinking() {
  Life life;
  life.body.masses = {{{0.3, -0.2, 0}, 0.21}};
  life.start = resting(life.body, Scene());
  life.start.position[0].z = steps_before_landing * speed * dt;
  life.start.velocity[0].z = -speed;
  life.start.start_energy = 1;
  life.dt = dt;
  life.steps = steps_before_landing * 3 / 2;
  return life;
}

constexpr Stepping stepping{Method::symplectic_euler, Precision::float64};

TEST(Sensitivity, OfFreeMotionIsTheDisplacement) {
  const double apart = sensitivity(sinking(), Scene(), stepping, moved);
  EXPECT_GT(apart, 0.9 * moved);
  EXPECT_LT(apart, 1.001 * std::sqrt(3.0) * moved);
}

// A mass bounces off a rigid floor in the step that would take it below: a step earlier, it is one step's way down
// above the floor, and moves one step's way up more.
TEST(Sensitivity, OfALandingIsThatOfOneStep) {
  const double restitution = 0.6;
  const Scene scene{{}, Floor{.restitution = restitution}, {}, {}, {}};
  EXPECT_NEAR(sensitivity(sinking(), scene, stepping, moved), (1 + restitution) * speed * dt, 3 * moved);
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
