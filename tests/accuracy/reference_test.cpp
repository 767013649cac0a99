// The reference solution compared with closed-form solutions.
#include "accuracy/reference.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace evodevo::tools::accuracy::EVODEVO_FILE {
namespace {

Body single_mass(double mass) {
  Body body;
  body.masses = {{{}, mass}};
  return body;
}

State at(Vec3 place, Vec3 velocity = {}) { return {{place}, {velocity}}; }

TEST(Reference, AMassFallsInDamping) {
  const double g = 9.81, rate = 3, time = 0.7;
  const Scene scene{Gravity{g}, {}, {}, Damping{rate}, {}};
  const State end = solution(single_mass(0.2), at({1, 0, 5}, {2, 0, 0}), scene, time);
  const double left = std::exp(-rate * time), fall = (time - (1 - left) / rate) * g / rate;
  EXPECT_NEAR(end.position[0].x, 1 + 2 * (1 - left) / rate, 1e-11);
  EXPECT_NEAR(end.position[0].z, 5 - fall, 1e-11);
  EXPECT_NEAR(end.velocity[0].z, -g / rate * (1 - left), 1e-11);
}

TEST(Reference, DragSlowsAsItsEquationSays) {
  const State end = solution(single_mass(0.2), at({}, {3, -4, 12}), {{}, {}, {}, {}, Drag{0.5}}, 1);
  EXPECT_NEAR(norm(end.velocity[0]), 13 / (1 + 13 * 0.5 / 0.2), 1e-11);
}

TEST(Reference, AMassInTheFloorSwingsAndOneInTheAirBounces) {
  const double g = 9.81, k = 2e4, mass = 0.2, sag = mass * g / k, omega = std::sqrt(k / mass), time = 0.3;
  const Scene scene{Gravity{g}, Floor{k}, {}, {}, {}};
  const State swings = solution(single_mass(mass), at({0, 0, -1.5 * sag}), scene, time);
  EXPECT_NEAR(swings.position[0].z, -sag - 0.5 * sag * std::cos(omega * time), 1e-12);
  const State bounced = solution(single_mass(mass), at({0, 0, 0.05}), scene, time);
  const double speed = norm(bounced.velocity[0]), z = bounced.position[0].z;
  const double energy = mass * (g * z + speed * speed / 2) + k * std::pow(std::max(0.0, -z), 2) / 2;
  EXPECT_NEAR(energy, mass * g * 0.05, 1e-10);
}

TEST(Reference, AMuscleHeldAtOneEndFollowsItsEquation) {
  // x'' = -w^2 (x - 1 - A sin(p t + phase))
  const double k = 500, mass = 0.2, amplitude = 0.1, frequency = 2, phase = 0.7, t = 0.9;
  Body body;
  body.materials = {{k, amplitude, frequency, phase}};
  body.masses = {{{}, 0}, {{1, 0, 0}, mass}};
  body.springs = {{0, 1, 1.0, 0}};
  const State end = solution(body, {{{}, {1, 0, 0}}, {{}, {}}}, {}, t);
  const double w = std::sqrt(k / mass), p = 2 * 3.14159265358979323846 * frequency;
  const double c = amplitude * w * w / (w * w - p * p);
  const double stretch =
      c * (std::sin(p * t + phase) - std::sin(phase) * std::cos(w * t) - p / w * std::cos(phase) * std::sin(w * t));
  EXPECT_NEAR(end.position[1].x, 1 + stretch, 1e-10);
  EXPECT_EQ(end.position[0], (Vec3{}));
}

TEST(Reference, FrictionIsRefused) {
  EXPECT_THROW(solution(single_mass(0.2), at({}), {Gravity{}, Floor{}, Friction{}, {}, {}}, 1), std::invalid_argument);
}

}  // namespace
}  // namespace evodevo::tools::accuracy::EVODEVO_FILE
