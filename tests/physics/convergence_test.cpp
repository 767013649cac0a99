// All methods converge to the same motion, each with its own order.
#include <cmath>

#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "reference.hpp"
#include "ways.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

struct Smooth {
  const char* name;
  Body body;
  Scene scene;
};

/// One oscillating muscle, slowed down by damping and drag.
Smooth one_spring() {
  return {"one_spring", pair_of_masses(0.2, {500, 0.1, 2, 0.7}, 1.05), {{}, {}, {}, Damping{3}, Drag{0.2}}};
}

/// A lattice of muscles with two phases, which rotates as it falls.
Smooth lattice() {
  Body body = block(2, {800, 0.1, 3, 0});
  body.materials.push_back({1000, 0.1, 2, 1});
  for (std::size_t i = 0; i < body.springs.size(); i += 3) body.springs[i].material = 1;
  return {"lattice", body, {Gravity{}, {}, {}, Damping{2}, Drag{0.1}}};
}

/// The same with dashpots instead of damping in space.
Smooth damped_lattice() {
  Smooth smooth = lattice();
  smooth.name = "damped_lattice";
  smooth.scene.damping.reset();
  for (Material& material : smooth.body.materials) material.damping = 0.3;
  return smooth;
}

State turning(const Smooth& smooth) {
  State state = resting(smooth.body, smooth.scene);
  for (std::size_t i = 0; i < state.velocity.size(); ++i)
    state.velocity[i] = {-2 * state.position[i].y, 2 * state.position[i].x, state.position[i].x};
  state.start_energy = 100 + total_energy(smooth.body, state, smooth.scene);
  return state;
}

int order_of(Method method) { return method == Method::velocity_verlet ? 2 : method == Method::rk4 ? 4 : 1; }

class Convergence : public ::testing::TestWithParam<Method> {
 protected:
  /// The distance (m) from the true end of a motion of `time` seconds if it is divided into `steps` steps.
  static double error(const Body& body, const State& start, const Scene& scene, double time, std::uint64_t steps,
                      const State& truth) {
    const Steps stepping{GetParam(), Precision::float64, time / static_cast<double>(steps)};
    return largest_difference(simulate_ok(body, start, scene, stepping, steps).state, truth);
  }
};

INSTANTIATE_TEST_SUITE_P(Methods, Convergence, ::testing::ValuesIn(all_methods), named);

TEST_P(Convergence, TheErrorFallsWithTheOrderOfTheMethod) {
  const int order = order_of(GetParam());
  const double time = 0.2;
  for (const Smooth& smooth : {one_spring(), lattice(), damped_lattice()}) {
    const State start = turning(smooth), truth = tools::accuracy::solution(smooth.body, start, smooth.scene, time);
    ASSERT_GT(largest_difference(start, truth), 0.02);
    // enough steps for the asymptotic order, but few enough for an error above rounding
    const std::uint64_t steps = order == 1 ? 12800 : order == 2 ? 1600 : 200;
    const auto off = [&](std::uint64_t n) { return error(smooth.body, start, smooth.scene, time, n, truth); };
    EXPECT_NEAR(std::log2(off(steps) / off(2 * steps)), order, 0.1) << smooth.name;
  }
}

TEST_P(Convergence, WithFloorAndFrictionAllTendToOneMotion) {
  // a block falls on a soft floor, slides and comes to rest
  const Scene scene{Gravity{}, Floor{2e4}, Friction{0.5}, Damping{2}, {}};
  const Body body = block(1, {2000, 0, 0, 0});
  const State start = thrown(body, scene, {}, {1.2, 0.3, -0.3});
  const double time = 0.15;
  const State truth = reference(body, start, scene, 1e-6, 150000).state;
  ASSERT_GT(largest_difference(start, truth), 0.01);
  const double coarse = error(body, start, scene, time, 600, truth),
               fine = error(body, start, scene, time, 9600, truth);
  EXPECT_LT(coarse, 0.01);
  EXPECT_LT(fine, coarse / 6);  // the step for `fine` is a sixteenth of that for `coarse`
}

TEST_P(Convergence, TheTerminalVelocityIsTrue) {
  const double mass = 0.2, rate = 5, c = 0.3;
  const Scene scene{Gravity{}, {}, {}, Damping{rate}, Drag{c}};
  const Body body = single_mass(mass);
  // at which damping and drag balance the weight: rate m v + c v^2 = m g
  const double b = rate * mass, expected = (std::sqrt(b * b + 4 * c * mass * 9.81) - b) / (2 * c);
  for (const double dt : {0.1, 0.01, 0.001}) {
    const Steps stepping{GetParam(), Precision::float64, dt};
    const Answer a = simulate(body, resting(body, scene), scene, stepping, static_cast<std::uint64_t>(20 / dt));
    const double error = std::abs(a.state.velocity[0].z + expected) / expected;
    // paper-euler's v <- (v + dt a) decay is too slow by a share of about rate dt/2
    const bool paper = GetParam() == Method::paper_euler, verlet = GetParam() == Method::velocity_verlet;
    EXPECT_LT(error, paper ? 5 * dt : verlet ? 10 * dt * dt : 1e-12) << "dt " << dt;
    if (paper) {
      EXPECT_GT(error, 0.5 * dt);
    }
  }
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
