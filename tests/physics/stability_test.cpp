// The largest stable step and bounds of frequencies, compared with the eigenvalues of dense matrices and with the
// behaviour of the simulator.
#include "analysis/stability.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "random_numbers.hpp"
#include "ways.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// Returns M^-1/2 K M^-1/2 of a body at `places` (m), 1/s^2, with the exact derivatives of its springs' forces: a
/// spring under tension is stiff across its direction, too.
Eigen::MatrixXd strained_matrix(const Body& body, const std::vector<Vec3>& places) {
  const auto size = static_cast<Eigen::Index>(3 * body.masses.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
  for (const Spring& spring : body.springs) {
    const Vec3 d = places[spring.b] - places[spring.a];
    const Eigen::Vector3d along = Eigen::Vector3d(d.x, d.y, d.z).normalized();
    const double k = body.stiffness(spring), across = k * (1 - spring.rest_length / norm(d));
    const Eigen::Matrix3d own = (k - across) * along * along.transpose() + across * Eigen::Matrix3d::Identity();
    const std::uint32_t ends[] = {spring.a, spring.b};
    for (const std::uint32_t i : ends)
      for (const std::uint32_t j : ends)
        matrix.block<3, 3>(3 * i, 3 * j) +=
            (i == j ? 1 : -1) / std::sqrt(body.masses[i].mass * body.masses[j].mass) * own;
  }
  return matrix;
}

/// The matrix of springs that are stiff in every direction alike, and of masses that a floor of `floor` N/m holds: that
/// of one axis, 1/s^2.
Eigen::MatrixXd matrix_of_any_shape(const Body& body, double floor) {
  const auto size = static_cast<Eigen::Index>(body.masses.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index i = 0; i < size; ++i) matrix(i, i) = floor / body.masses[static_cast<std::size_t>(i)].mass;
  for (const Spring& spring : body.springs) {
    Eigen::VectorXd edge = Eigen::VectorXd::Zero(size);
    edge[spring.a] = -1 / std::sqrt(body.masses[spring.a].mass);
    edge[spring.b] = 1 / std::sqrt(body.masses[spring.b].mass);
    matrix += body.stiffness(spring) * edge * edge.transpose();
  }
  return matrix;
}

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

/// The highest angular frequency of a body in any shape, whose masses a floor of `floor` N/m holds, from the
/// eigenvalues of a dense matrix, 1/s.
double frequency_in_any_shape(const Body& body, double floor = 0) {
  return std::sqrt(largest_eigenvalue(matrix_of_any_shape(body, floor)));
}

/// Whether a step is stable for the body in any shape.
bool is_stable_in_any_shape(const Body& body, double dt) { return is_stable(body, {}, Method::paper_euler, dt); }

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
    const double highest = frequency_in_any_shape(body);
    EXPECT_TRUE(is_stable_in_any_shape(body, 0.985 * 2 / highest)) << seed;  // the stated margin is one percent
    EXPECT_FALSE(is_stable_in_any_shape(body, 1.0005 * 2 / highest)) << seed;
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
    EXPECT_TRUE(is_stable(body, {}, method, 0.1));
  }
  EXPECT_EQ(largest_dt(single_mass(0.2), {{Vec3{}}}, Method::rk4), infinity);
  EXPECT_EQ(largest_dt({}, {}, Method::rk4), infinity);
}

TEST(Stability, WhatIsWantedIsGivenWhereTheBodyBearsIt) {
  const Body body = random_body(80, 12, 5, 3);
  const double limit = 2 / frequency_in_any_shape(body);
  for (const double wanted : {1e-4 * limit, 0.5 * limit, 0.9 * limit})
    EXPECT_EQ(largest_dt_in_any_shape(body, {}, Method::paper_euler, wanted), wanted);
  const double largest = largest_dt_in_any_shape(body, {}, Method::paper_euler, 1.5 * limit);
  EXPECT_LE(largest, limit);
  EXPECT_GT(largest, 0.98 * limit);
}

TEST(Stability, NoShapeIsLessStableThanAnyShape) {
  Scene soft;
  soft.floor = Floor{4e4, 0.05};
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const Body body = random_body(static_cast<std::uint32_t>(4 + 5 * seed), 6, 5, seed);
    const double floor = soft.floor->stiffness * (1 + std::pow(soft.floor->steepest(), 2));
    for (const bool on_floor : {false, true}) {
      const double highest = frequency_in_any_shape(body, on_floor ? floor : 0);
      const double largest = largest_dt_in_any_shape(body, on_floor ? soft : Scene{}, Method::paper_euler);
      EXPECT_LE(largest, 2 / highest) << seed;
      EXPECT_GT(largest, 0.98 * 2 / highest) << seed;
      EXPECT_EQ(largest_dt_in_any_shape(body, on_floor ? soft : Scene{}, Method::rk4, 0.5 * largest), 0.5 * largest);
    }
    // places that have nothing to do with the rest lengths, near each other and far apart
    for (const double size : {0.1, 1.0, 30.0}) {
      std::vector<Vec3> places =
          rest_positions(random_body(static_cast<std::uint32_t>(4 + 5 * seed), 3, 5, seed + 100));
      for (Vec3& place : places) place = size * place;
      const double highest = std::sqrt(largest_eigenvalue(strained_matrix(body, places)));
      EXPECT_LE(largest_dt_in_any_shape(body, {}, Method::paper_euler), 2 / highest) << seed << ' ' << size;
    }
  }
}

TEST(Stability, ASafeStepHasAMarginForWhateverLimitsIt) {
  const Body body = random_body(80, 12, 5, 3), damped = with_dashpots(body);
  const auto safe = [&](const Scene& scene, Method method) { return safe_dt(body, scene, method); };
  const double springs = 2 / frequency_in_any_shape(body);
  EXPECT_LE(safe({}, Method::velocity_verlet), undamped_margin * springs);
  EXPECT_GT(safe({}, Method::velocity_verlet), 0.98 * undamped_margin * springs);
  EXPECT_GT(safe({}, Method::rk4), std::sqrt(2) * 0.98 * spring_margin * springs) << "which damps by itself";
  const double with_dashpots = largest_dt_in_any_shape(damped, {}, Method::velocity_verlet);
  EXPECT_EQ(safe_dt(damped, {}, Method::velocity_verlet), spring_margin * with_dashpots);
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
    return safe_dt(body, {}, Method::paper_euler);
  };
  EXPECT_EQ(safe(100), 0.0005);
  EXPECT_EQ(safe(0), 0.01);
  const Body still = single_mass(1);
  EXPECT_EQ(safe_dt(still, {}, Method::paper_euler), 0.01);
  const Body lost = pair_of_masses(1, {std::numeric_limits<double>::infinity(), 0, 0, 0});
  EXPECT_FALSE(safe_dt(lost, {}, Method::paper_euler) > 0);
}

/// A rigid floor, and nothing that damps.
Scene ice(double restitution = 0) { return {Gravity{}, Floor{.restitution = restitution}, {}, {}, {}}; }

TEST(Stability, PassiveLatticesWithoutDampingBearTheirSafeStep) {
  for (const Method method : explicit_methods)
    for (std::uint64_t seed = 0; seed < 24; ++seed) {
      // some of their springs are too long and some too short, so that they shake for ever
      Random random(seed);
      Body body = seed % 2 == 0 ? passive(random_body(30, 8, 5, seed)) : block(2, {5000, 0, 0, 0});
      for (Spring& spring : body.springs) spring.rest_length *= random.between(0.85, 1.15);
      const Scene scene = ice(0.25 * static_cast<double>(seed % 5));
      const State start = thrown(body, scene, {0, 0, 0.3}, random.vector(1));
      const double dt = safe_dt(body, scene, method);
      SCOPED_TRACE(std::string(name(method)) + ", " + std::to_string(seed));
      const Answer a =
          simulate_ok(body, start, scene, {method, Precision::float64, dt}, static_cast<std::uint64_t>(20 / dt));
      EXPECT_LT(total_energy(body, a.state, scene), 1.3 * start.start_energy);
    }
}

TEST(Stability, RandomBodiesInMotionBearTheirSafeStep) {
  for (const Method method : explicit_methods)
    for (std::uint64_t seed = 0; seed < 6; ++seed)
      for (const Scene& scene : {Scene{}, walking_scene(), ice()}) {
        const Body body = random_body(60, 10, 5, seed);
        const State birth = state_at_birth(body, scene);
        const double dt = safe_dt(body, scene, method);
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
    return is_stable(body, scene, Method::rk4, dt);
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
    EXPECT_TRUE(is_stable_in_any_shape(body, within * limit)) << name;
    EXPECT_FALSE(is_stable_in_any_shape(body, beyond * limit)) << name;
  }
  EXPECT_TRUE(is_stable_in_any_shape({}, 1));
  EXPECT_TRUE(is_stable_in_any_shape(single_mass(0.2), 1));
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

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
