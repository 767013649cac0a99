// The largest stable step and bounds of frequencies, compared with the eigenvalues of dense matrices and with the
// behaviour of the simulator.
#include "analysis/stability.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "analysis/ground.hpp"
#include "analysis/stiffness_bounds.hpp"
#include "ways.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// Returns M^-1/2 K M^-1/2 of a body at its rest positions, 1/s^2, where each spring resists with its own number, N/m.
Eigen::MatrixXd mass_weighted_matrix(const Body& body, std::span<const double> resistance) {
  const auto size = static_cast<Eigen::Index>(3 * body.masses.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
  for (std::size_t i = 0; i < body.springs.size(); ++i) {
    const Mass &a = body.masses[body.springs[i].a], &b = body.masses[body.springs[i].b];
    const Vec3 along = b.rest - a.rest;
    const Eigen::Vector3d direction = Eigen::Vector3d(along.x, along.y, along.z).normalized();
    Eigen::VectorXd edge = Eigen::VectorXd::Zero(size);
    edge.segment<3>(3 * body.springs[i].a) = -direction / std::sqrt(a.mass);
    edge.segment<3>(3 * body.springs[i].b) = direction / std::sqrt(b.mass);
    matrix += resistance[i] * edge * edge.transpose();
  }
  return matrix;
}

double largest_eigenvalue(const Eigen::MatrixXd& matrix) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
}

/// The highest angular frequency of a body at its rest positions, from the eigenvalues of a dense matrix, 1/s.
double highest_frequency(const Body& body) {
  std::vector<double> stiffness;
  for (const Spring& spring : body.springs) stiffness.push_back(body.materials[spring.material].stiffness);
  return std::sqrt(largest_eigenvalue(mass_weighted_matrix(body, stiffness)));
}

Steps at(double dt) { return {Method::paper_euler, Precision::float64, dt}; }

/// Whether a step is stable for the body at its rest positions.
bool is_stable_at_rest(const Body& body, const Steps& stepping) {
  return is_stable(body, rest_positions(body), {}, stepping.method, stepping.dt);
}

TEST(Stability, TheLargestStepIsThatOfTheHighestFrequency) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const Body body =
        random_body(static_cast<std::uint32_t>(3 + 12 * seed), static_cast<std::uint32_t>(2 + seed), 5, seed);
    const double frequency = highest_frequency(body);
    for (const Method method : explicit_methods) {
      const double limit = (method == Method::rk4 ? std::sqrt(8) : 2) / frequency;
      const double largest = largest_dt(body, rest_positions(body), method);
      EXPECT_LE(largest, limit) << seed << ", " << name(method);
      EXPECT_GT(largest, 0.98 * limit) << seed << ", " << name(method);
    }
    EXPECT_TRUE(is_stable_at_rest(body, at(0.985 * 2 / frequency))) << seed;  // the stated margin is one percent
    EXPECT_FALSE(is_stable_at_rest(body, at(1.0005 * 2 / frequency))) << seed;
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
        SCOPED_TRACE(std::string(name(method)) + ", " + std::to_string(seed));
        simulate_ok(body, birth, scene, {method, Precision::float64, dt}, static_cast<std::uint64_t>(5 / dt));
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
  const struct {
    double ratio, phase, rate;
    bool is_borne;
  } cases[] = {{0.0, 2.8, 1.4, true}, {0.0, 2.57, 2.5, true},  {0.0, 0.1, 2.57, true}, {0.1, 2.2, 0.0, true},
               {0.1, 1.0, 1.9, true}, {0.0, 2.75, 2.5, false}, {0.0, 0.1, 2.9, false}, {3.0, 0.4, 2.0, false}};
  for (const auto& [ratio, phase, rate, is_borne] : cases) {
    SCOPED_TRACE(std::to_string(ratio) + ' ' + std::to_string(phase) + ' ' + std::to_string(rate));
    const Body body = pair_of_masses(mass, {k, 0, 0, 0, ratio}, 1.001);
    const double dt = phase / omega;
    const Scene scene{{}, {}, {}, Damping{rate / dt}, {}};
    EXPECT_TRUE(is_borne || bears(body, {}, dt)) << "without uniform damping";
    EXPECT_EQ(bears(body, scene, dt), is_borne);
    EXPECT_TRUE(is_borne ? swings(body, scene, dt) < 0.5 : swings(body, scene, dt) > 2);
  }
}

/// Hard for an iterative method: the highest frequencies are close to each other.
Body chain() {
  Body body;
  body.materials = {{1000, 0, 0, 0}};
  for (std::uint32_t i = 0; i < 100; ++i) body.masses.push_back({{0.1 * i, 0, 0}, 0.2});
  for (std::uint32_t i = 1; i < 100; ++i) body.springs.push_back({i - 1, i, 0.1, 0});
  return body;
}

TEST(Stability, TheLimitsOfSomeBodiesAreKnown) {
  const Material material{5000, 0, 0, 0};
  const double of_spring = largest_spring_dt(material, 0.2, Method::paper_euler);
  const Body spring = pair_of_masses(0.2, material, 1.001);
  EXPECT_NEAR(of_spring, 2 / highest_frequency(spring), 1e-12);
  Body held = pair_of_masses(0.2, material);
  held.masses[0].mass = 0;
  const struct {
    const char* name;
    Body body;
    double limit, within, beyond;
  } cases[] = {{"a chain", chain(), 2 / highest_frequency(chain()), 0.985, 1.005},
               {"a spring", spring, of_spring, 0.9999, 1.0001},
               {"a spring without a direction", pair_of_masses(0.2, material, 0), of_spring, 0.98, 1.01},
               {"one end is held, which adds nothing", held, 2 / std::sqrt(5000 / 0.2), 0.985, 1.001}};
  for (const auto& [name, body, limit, within, beyond] : cases) {
    EXPECT_TRUE(is_stable_at_rest(body, at(within * limit))) << name;
    EXPECT_FALSE(is_stable_at_rest(body, at(beyond * limit))) << name;
  }
  EXPECT_TRUE(is_stable_at_rest({}, at(1)));
  EXPECT_TRUE(is_stable_at_rest(single_mass(0.2), at(1)));
}

TEST(Stability, ScenesAndMaterialsHaveTheirOwnLimits) {
  EXPECT_DOUBLE_EQ(largest_contact_dt(walking_scene(), 0.2, Method::paper_euler), 1.2 * std::sqrt(0.2 / 1e6));
  constexpr double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(largest_contact_dt({}, 0.2, Method::paper_euler), infinity);
  EXPECT_EQ(largest_contact_dt({{}, Floor{.restitution = 0.2}, {}, {}, {}}, 0.2, Method::paper_euler), infinity);
  EXPECT_EQ(largest_muscle_dt({5000, 0.1, 1000, 0}), 0.0005);
  EXPECT_EQ(largest_muscle_dt({5000, 0, 1000, 0}), infinity);
  EXPECT_EQ(largest_spring_dt({0, 0, 0, 0}, 0.2, Method::paper_euler), infinity);
}

/// Returns twice the largest eigenvalue of the diagonal block of any mass.
double twice_the_blocks(const Eigen::MatrixXd& matrix) {
  double largest = 0;
  for (Eigen::Index i = 0; i < matrix.rows(); i += 3)
    largest = std::max(largest, 2 * largest_eigenvalue(matrix.block<3, 3>(i, i)));
  return largest;
}

TEST(StiffnessBounds, ThatOfBlocksLiesBetweenTheEigenvalueAndThatOfDiscs) {
  for (const Resistance resistance : {Resistance{1, 0}, Resistance{0, 1}, Resistance{0.3, 40}})
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
      Body body = random_body(static_cast<std::uint32_t>(4 + seed % 8), 3, 5, seed);
      for (Material& material : body.materials) material.damping = 0.3;
      const std::vector<Vec3> places = rest_positions(body);
      std::vector<double> resisting;
      for (const Spring& spring : body.springs) resisting.push_back(resistance(body, spring));
      const Eigen::MatrixXd matrix = mass_weighted_matrix(body, resisting);
      const StiffnessBounds bounds(body, places, resistance);
      const double blocks = bounds.of_blocks();
      EXPECT_NEAR(blocks, twice_the_blocks(matrix), 1e-9 * blocks);
      EXPECT_LE(largest_eigenvalue(matrix), blocks * (1 + 1e-9));
      EXPECT_LE(blocks, bounds.of_discs() * (1 + 1e-9));
      EXPECT_TRUE(bounds.blocks_are_below(blocks * (1 + 1e-6)));
      EXPECT_FALSE(bounds.blocks_are_below(blocks * (1 - 1e-6)));
    }
}

TEST(StiffnessBounds, OfUnusualBodiesAreKnown) {
  const Body held{
      .masses = {{{0, 0, 0}, 0}, {{1, 0, 0}, 0.5}}, .springs = {{0, 1, 1, 0}}, .materials = {{100, 0, 0, 0}}};
  const Body without_a_direction{.masses = {{{0, 0, 0}, 1}, {{0, 0, 0}, 1}, {{0, 2, 0}, 1}},
                                 .springs = {{0, 1, 1, 0}, {1, 2, 1, 0}},
                                 .materials = {{100, 0, 0, 0}}};
  for (const Body& body : {held, without_a_direction}) {
    const std::vector<Vec3> places = rest_positions(body);
    const StiffnessBounds bounds(body, places, {1, 0});
    EXPECT_DOUBLE_EQ(bounds.of_blocks(), 400);
    EXPECT_TRUE(bounds.blocks_are_below(401));
    EXPECT_FALSE(bounds.blocks_are_below(399));
  }
  const std::vector<Vec3> of_held = rest_positions(held);
  EXPECT_DOUBLE_EQ(StiffnessBounds(held, of_held, {1, 0}).of_discs(), 400);
}

TEST(StiffnessBounds, NothingIsABoundWherePlacesAreNotNumbers) {
  const Vec3 places[] = {{0, 0, 0}, {1, std::numeric_limits<double>::quiet_NaN(), 0}};
  const Body body{.masses = {{places[0], 1}, {places[1], 1}}, .springs = {{0, 1, 1, 0}}, .materials = {{100, 0, 0, 0}}};
  const StiffnessBounds bounds(body, places, {1, 0});
  EXPECT_TRUE(std::isnan(bounds.of_discs()));
  EXPECT_TRUE(std::isnan(bounds.of_blocks()));
  EXPECT_FALSE(bounds.blocks_are_below(std::numeric_limits<double>::max()));
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
