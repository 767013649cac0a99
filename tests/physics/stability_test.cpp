// The largest stable step, compared with the eigenvalues of dense matrices and with the behaviour of the simulator.
#include "analysis/stability.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "analysis/ground.hpp"
#include "stiffness_matrix.hpp"
#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// The highest angular frequency of a body at its rest positions, from the eigenvalues of a dense matrix, 1/s.
double highest_frequency(const Body& body) {
  std::vector<double> stiffness;
  for (const Spring& spring : body.springs) stiffness.push_back(body.materials[spring.material].stiffness);
  return std::sqrt(largest_eigenvalue(mass_weighted_matrix(body, stiffness)));
}

Steps at(double dt) { return {Method::paper_euler, Precision::float64, dt}; }

std::vector<Vec3> rest_positions(const Body& body) {
  std::vector<Vec3> places;
  for (const Mass& mass : body.masses) places.push_back(mass.rest);
  return places;
}

/// Whether a step is stable for the body at its rest positions.
bool is_stable_at_rest(const Body& body, const Steps& stepping) {
  return is_stable(body, rest_positions(body), {}, stepping.method, stepping.dt);
}

TEST(Stability, TheLargestStepIsThatOfTheHighestFrequency) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const Body body =
        random_body(static_cast<std::uint32_t>(3 + 12 * seed), static_cast<std::uint32_t>(2 + seed), 5, seed);
    const double frequency = highest_frequency(body);
    for (const auto& [method, phase] :
         {std::pair{Method::paper_euler, 2.0}, std::pair{Method::symplectic_euler, 2.0},
          std::pair{Method::velocity_verlet, 2.0}, std::pair{Method::rk4, std::sqrt(8)}}) {
      const double largest = largest_dt(body, rest_positions(body), method);
      EXPECT_LE(largest, phase / frequency) << seed << ", " << name(method);
      EXPECT_GT(largest, 0.98 * phase / frequency) << seed << ", " << name(method);
    }
  }
}

TEST(Stability, OnlyExplicitMethodsHaveALargestStep) {
  const double infinity = std::numeric_limits<double>::infinity();
  const Material material{5000, 0, 0, 0};
  const Body body = block(2, material);
  for (const Method method : {Method::implicit, Method::xpbd}) {
    EXPECT_EQ(largest_dt(body, rest_positions(body), method), infinity);
    EXPECT_EQ(largest_spring_dt(material, 0.2, method), infinity);
    EXPECT_EQ(largest_contact_dt(walking_scene(), 0.2, method), infinity);
    EXPECT_TRUE(is_stable(body, rest_positions(body), {}, method, 0.1));
  }
  EXPECT_EQ(largest_dt(single_mass(0.2), {{Vec3{}}}, Method::rk4), infinity);
  EXPECT_EQ(largest_dt({}, {}, Method::rk4), infinity);
}

TEST(Stability, TheLimitOfRandomBodiesIsThatOfTheirHighestFrequency) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const Body body =
        random_body(static_cast<std::uint32_t>(3 + 12 * seed), static_cast<std::uint32_t>(2 + seed), 5, seed);
    const double limit = 2 / highest_frequency(body);
    EXPECT_TRUE(is_stable_at_rest(body, at(0.985 * limit))) << seed;  // the stated margin is one percent
    EXPECT_FALSE(is_stable_at_rest(body, at(1.0005 * limit))) << seed;
  }
}

TEST(Stability, TheLimitOfAChainIsThatOfItsHighestFrequency) {
  // hard for an iterative method: the highest frequencies are close to each other
  Body body;
  body.materials = {{1000, 0, 0, 0}};
  for (std::uint32_t i = 0; i < 100; ++i) body.masses.push_back({{0.1 * i, 0, 0}, 0.2});
  for (std::uint32_t i = 1; i < 100; ++i) body.springs.push_back({i - 1, i, 0.1, 0});
  const double limit = 2 / highest_frequency(body);
  EXPECT_TRUE(is_stable_at_rest(body, at(0.985 * limit)));
  EXPECT_FALSE(is_stable_at_rest(body, at(1.005 * limit)));
}

TEST(Stability, OneSpringIsStableUpToItsLimitAndNotBeyond) {
  const Material material{5000, 0, 0, 0};
  const Body body = pair_of_masses(0.2, material, 1.001);
  const double limit = largest_spring_dt(material, 0.2, Method::paper_euler);
  EXPECT_NEAR(limit, 2 / highest_frequency(body), 1e-12);
  EXPECT_TRUE(is_stable_at_rest(body, at(0.9999 * limit)));
  EXPECT_FALSE(is_stable_at_rest(body, at(1.0001 * limit)));
  // the simulation confirms the limit
  State start = resting(body, {});
  start.start_energy *= 100;  // near the limit, energy oscillates by a factor of 50 around a conserved, modified energy
  EXPECT_EQ(simulate(body, start, {}, at(0.99 * limit), 50000).task.status, Status::ok);
  EXPECT_EQ(simulate(body, start, {}, at(1.01 * limit), 1000).task.status, Status::diverged);
}

TEST(Stability, WhatIsWantedIsGivenWhereTheBodyBearsIt) {
  const Body body = random_body(80, 12, 5, 3);
  const double limit = 2 / highest_frequency(body);
  for (const double wanted : {1e-4 * limit, 0.5 * limit, 0.9 * limit})
    EXPECT_EQ(largest_dt(body, rest_positions(body), Method::paper_euler, wanted), wanted);
  const double largest = largest_dt(body, rest_positions(body), Method::paper_euler, 1.5 * limit);
  EXPECT_LE(largest, limit);
  EXPECT_GT(largest, 0.98 * limit);
}

TEST(Stability, ASafeStepHasAMarginForWhateverLimitsIt) {
  const Body body = random_body(80, 12, 5, 3);
  const auto safe = [&](const Scene& scene, Method method) {
    return safe_dt(body, rest_positions(body), scene, method);
  };
  const double springs = 2 / highest_frequency(body);
  EXPECT_LE(safe({}, Method::velocity_verlet), spring_margin * springs);
  EXPECT_GT(safe({}, Method::velocity_verlet), 0.98 * spring_margin * springs);
  double lightest = 1;
  for (const Mass& mass : body.masses) lightest = std::min(lightest, mass.mass);
  EXPECT_EQ(safe(walking_scene(), Method::paper_euler), largest_contact_dt(walking_scene(), lightest, Method::rk4));
  Scene thick;
  thick.damping = Damping{1e4};
  EXPECT_EQ(safe(thick, Method::rk4), 2e-4);
  EXPECT_GT(safe(thick, Method::paper_euler), 2e-4) << "damps exactly";
}

TEST(Stability, ASafeStepSeesTheMusclesAndEndsInTime) {
  const auto safe = [](double frequency) {
    const Body body = pair_of_masses(1, {0.01, 0.1, frequency, 0});
    return safe_dt(body, rest_positions(body), {}, Method::paper_euler);
  };
  EXPECT_EQ(safe(100), 0.0005);
  EXPECT_EQ(safe(0), 0.01);
  const Body still = single_mass(1);
  EXPECT_EQ(safe_dt(still, rest_positions(still), {}, Method::paper_euler), 0.01);
  const Body lost = pair_of_masses(1, {0.01, 0, 0, 0}, std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(safe_dt(lost, rest_positions(lost), {}, Method::paper_euler) > 0);
}

TEST(Stability, RandomBodiesInMotionBearTheirSafeStep) {
  for (const Method method : explicit_methods)
    for (std::uint64_t seed = 0; seed < 6; ++seed)
      for (const Scene& scene : {Scene{}, walking_scene()}) {
        const Body body = random_body(60, 10, 5, seed);
        const State birth = state_at_birth(body, scene);
        const double dt = safe_dt(body, birth.position, scene, method);
        const Answer a =
            simulate(body, birth, scene, {method, Precision::float64, dt}, static_cast<std::uint64_t>(5 / dt));
        EXPECT_EQ(a.task.status, Status::ok) << name(method) << ", " << seed << ": " << a.task.reason;
      }
}

TEST(Stability, UniformDampingAndSpringsCountTogetherWhereBothAreForces) {
  // how far a spring still swings after 400 steps of rk4, relative to the start; infinite if it has diverged
  const auto swings = [](const Body& body, const Scene& scene, double dt) {
    const Answer a = simulate(body, resting(body, scene), scene, {Method::rk4, Precision::float64, dt}, 400);
    const double stretch = a.state.position[1].x - a.state.position[0].x - 1;
    return a.task.status == Status::ok ? std::abs(stretch) / 0.001 : INFINITY;
  };
  const auto bears = [](const Body& body, const Scene& scene, double dt) {
    return is_stable(body, rest_positions(body), scene, Method::rk4, dt);
  };
  const double k = 400, mass = 0.2, omega = std::sqrt(2 * k / mass);
  for (const auto& [ratio, phase, rate] :
       {std::tuple{0.0, 2.8, 1.4}, {0.0, 2.57, 2.5}, {0.0, 0.1, 2.57}, {0.1, 2.2, 0.0}, {0.1, 1.0, 1.9}}) {
    const Body body = pair_of_masses(mass, {k, 0, 0, 0, ratio}, 1.001);
    const double dt = phase / omega;
    const Scene scene{{}, {}, {}, Damping{rate / dt}, {}};
    EXPECT_TRUE(bears(body, scene, dt)) << ratio << ' ' << phase << ' ' << rate;
    EXPECT_LT(swings(body, scene, dt), 0.5) << ratio << ' ' << phase << ' ' << rate;
  }
  for (const auto& [ratio, phase, rate] : {std::tuple{0.0, 2.75, 2.5}, {0.0, 0.1, 2.9}, {3.0, 0.4, 2.0}}) {
    const Body body = pair_of_masses(mass, {k, 0, 0, 0, ratio}, 1.001);
    const double dt = phase / omega;
    const Scene scene{{}, {}, {}, Damping{rate / dt}, {}};
    EXPECT_TRUE(bears(body, {}, dt)) << "without uniform damping";
    EXPECT_FALSE(bears(body, scene, dt)) << ratio << ' ' << phase << ' ' << rate;
    EXPECT_GT(swings(body, scene, dt), 2) << ratio << ' ' << phase << ' ' << rate;
  }
}

TEST(Stability, DegenerateBodiesHaveAnAnswer) {
  EXPECT_TRUE(is_stable_at_rest({}, at(1)));
  EXPECT_TRUE(is_stable_at_rest(single_mass(0.2), at(1)));
  const Body coincident = pair_of_masses(0.2, {5000, 0, 0, 0}, 0);
  const double limit = largest_spring_dt({5000, 0, 0, 0}, 0.2, Method::paper_euler);
  EXPECT_TRUE(is_stable_at_rest(coincident, at(0.98 * limit)));
  EXPECT_FALSE(is_stable_at_rest(coincident, at(1.01 * limit)));
}

TEST(Stability, AFixedMassAddsNothing) {
  // one end is held: omega^2 = k / m, which is half of the value for two free ends
  Body body = pair_of_masses(0.2, {5000, 0, 0, 0});
  body.masses[0].mass = 0;
  const double limit = 2 / std::sqrt(5000 / 0.2);
  EXPECT_TRUE(is_stable_at_rest(body, at(0.985 * limit)));
  EXPECT_FALSE(is_stable_at_rest(body, at(1.001 * limit)));
}

TEST(Stability, ScenesAndMaterialsHaveTheirOwnLimits) {
  EXPECT_DOUBLE_EQ(largest_contact_dt(walking_scene(), 0.2, Method::paper_euler), 1.2 * std::sqrt(0.2 / 1e6));
  EXPECT_EQ(largest_contact_dt({}, 0.2, Method::paper_euler), std::numeric_limits<double>::infinity());
  EXPECT_EQ(largest_muscle_dt({5000, 0.1, 1000, 0}), 0.0005);
  EXPECT_EQ(largest_muscle_dt({5000, 0, 1000, 0}), std::numeric_limits<double>::infinity());
  EXPECT_EQ(largest_spring_dt({0, 0, 0, 0}, 0.2, Method::paper_euler), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
