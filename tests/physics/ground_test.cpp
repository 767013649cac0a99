// Rough ground: its shape, and masses on it.
#include "analysis/ground.hpp"

#include <cmath>

#include "analysis/energy.hpp"
#include "analysis/stability.hpp"
#include "physics/physics.hpp"
#include "ways.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

constexpr double g = 9.81;

Floor rough_floor(double roughness = 0.05, std::int64_t seed = 3) { return {1e6, roughness, 1, seed}; }

Floor rigid_rough_floor() { return {.roughness = 0.05, .seed = 3, .restitution = 0}; }

physics::Ground<double> ground(const Floor& floor, double x, double y) {
  return physics::ground_at(x, y,
                            physics::Roughness<double>{floor.roughness, 2 / floor.wavelength, floor.first_line()});
}

TEST(Ground, StaysWithinItsRoughnessAndSteepness) {
  const Floor floor = rough_floor();
  double highest = 0, steepest = 0;
  for (int i = 0; i < 200000; ++i) {
    const auto here = ground(floor, std::fmod(0.618034 * i, 211) - 100, std::fmod(0.754878 * i, 197) - 100);
    highest = std::max(highest, std::abs(here.height));
    steepest = std::max(steepest, std::hypot(here.slope_x, here.slope_y));
  }
  EXPECT_LE(highest, floor.roughness);
  EXPECT_GT(highest, 0.9 * floor.roughness);
  EXPECT_LE(steepest, floor.steepest());
  EXPECT_GT(steepest, 0.7 * floor.steepest());
}

TEST(Ground, SlopesAreTheHeightsDerivatives) {
  const Floor floor = rough_floor();
  for (int i = 0; i < 1000; ++i) {
    const double x = 0.0317 * i - 10, y = 7 - 0.0173 * i, step = 1e-6;
    const auto here = ground(floor, x, y);
    EXPECT_NEAR(here.slope_x, (ground(floor, x + step, y).height - ground(floor, x - step, y).height) / (2 * step),
                1e-8);
    EXPECT_NEAR(here.slope_y, (ground(floor, x, y + step).height - ground(floor, x, y - step).height) / (2 * step),
                1e-8);
  }
}

TEST(Ground, ComesFromItsSeedAloneAndIsNotThatOfAnotherMoved) {
  // largest difference between the heights of two grounds at corners of cells, with one ground moved by whole cells
  const auto difference = [](std::int64_t seed, std::int64_t other, int right, int behind) {
    double largest = 0;
    for (int i = 0; i < 10; ++i)
      largest = std::max(largest, std::abs(ground(rough_floor(0.05, seed), 0.5 * (i + right), 0.5 * behind).height -
                                           ground(rough_floor(0.05, other), 0.5 * i, 0).height));
    return largest;
  };
  EXPECT_EQ(difference(3, 3, 0, 0), 0);
  EXPECT_GT(difference(3, 1000003, 0, 0), 0.01);
  for (std::int64_t seed = 0; seed < 5; ++seed)
    for (std::int64_t other = seed + 1; other < 5; ++other)
      for (int right = -20; right <= 20; ++right)
        for (int behind = -20; behind <= 20; ++behind)
          EXPECT_GT(difference(seed, other, right, behind), 0.01)
              << seed << " " << other << " " << right << " " << behind;
}

TEST(Ground, FrictionThatIsNotHigherAtRestNeedsNoSecondCoefficient) {
  constexpr float coefficient = 0.7f;
  int held = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto number = [&](double factor, double range) {
      return static_cast<float>(std::fmod(factor * i, 2 * range) - range);
    };
    const physics::Ground<float> here{0, number(0.618034, 0.4), number(0.754878, 0.4)};
    const physics::Triple<float> v{number(0.569840, 1), number(0.819173, 1), number(0.471043, 1)};
    const float push = i % 10 == 0 ? 0 : std::abs(number(0.324718, 2));
    const auto after = [&](float at_rest) {
      return physics::after_friction(here, v, push, 0.5f * push, coefficient, at_rest);
    };
    const auto same = after(coefficient), none = after(0), higher = after(4 * coefficient);
    EXPECT_TRUE(same.x == none.x && same.y == none.y && same.z == none.z) << i;
    held += higher.x != none.x;
  }
  EXPECT_GT(held, 2000) << "a higher coefficient must make a difference";
}

TEST(Birth, ABodyStartsOnTheFloorOverTheOrigin) {
  const Body body = random_body(50, 8, 5, 9);
  const State state = state_at_birth(body, walking_scene());
  const Vec3 centre = centre_of_mass(body, state.position);
  EXPECT_NEAR(centre.x, 0, 1e-15);
  EXPECT_NEAR(centre.y, 0, 1e-15);
  EXPECT_EQ(bounding_box(state.position).low.z, 0);
  EXPECT_EQ(state.velocity, std::vector<Vec3>(50));
  EXPECT_EQ(state.time, 0);
  double height = 0;
  for (std::size_t i = 0; i < 50; ++i) height += body.masses[i].mass * 9.81 * state.position[i].z;
  EXPECT_NEAR(state.start_energy, height, 1e-9 * height);
  EXPECT_NEAR(state_at_birth(body, {}).start_energy, 0, 1e-20);
}

TEST(Birth, APhaseStartsStrained) {
  const Body body = pair_of_masses(0.2, {1000, 0.1, 1, pi / 2});
  EXPECT_NEAR(state_at_birth(body, {}).start_energy, 0.5 * 1000 * 0.01, 1e-12);
}

TEST(Birth, ABodyStartsOnRoughGround) {
  const Scene scene{Gravity{}, rough_floor(), {}, {}, {}};
  const State state = state_at_birth(random_body(100, 8, 5, 2), scene);
  double lowest = 1;
  for (const Vec3& place : state.position)
    lowest = std::min(lowest, place.z - ground(*scene.floor, place.x, place.y).height);
  EXPECT_NEAR(lowest, 0, 1e-15);
}

TEST(Ground, SidewaysPushesShortenTheStepThatContactBears) {
  const Scene flat{Gravity{}, Floor{}, {}, {}, {}}, steep{Gravity{}, rough_floor(0.1), {}, {}, {}};
  EXPECT_DOUBLE_EQ(largest_contact_dt(steep, 0.2, Method::rk4),
                   largest_contact_dt(flat, 0.2, Method::rk4) / std::sqrt(1 + 0.75 * 0.75));
}

class OnRoughGround : public EachWay {
 protected:
  /// The corner (m) of a ground cell next to (x, y) that is a hollow, which means lower than its four neighbours.
  static Vec3 hollow(const Floor& floor, double x, double y) {
    const auto height = [&](double i, double j) { return ground(floor, i / 2, j / 2).height; };
    for (double i = std::round(2 * x);; ++i) {
      const double j = std::round(2 * y), here = height(i, j);
      if (here < std::min({height(i - 1, j), height(i + 1, j), height(i, j - 1), height(i, j + 1)}))
        return {i / 2, j / 2, here};
    }
  }
};

INSTANTIATE_TEST_SUITE_P(Methods, OnRoughGround, all_ways(), named);

TEST_P(OnRoughGround, AMassRestsInAHollow) {
  const Scene scene{Gravity{}, rough_floor(), {}, Damping{}, {}};
  // close to and far from the origin, on both sides
  for (const double at : {0.0, -37.0, 300.0}) {
    const Vec3 bottom = hollow(*scene.floor, at, -at);
    const Body body = single_mass(0.2, bottom);
    const Answer a = simulate_ok(body, resting(body, scene), scene, stepping(), 6000);
    EXPECT_EQ(a.state.position[0].x, bottom.x);
    EXPECT_EQ(a.state.position[0].y, bottom.y);
    EXPECT_NEAR(a.state.position[0].z, bottom.z - 0.2 * g / 1e6, single() ? 5e-8 : 1e-9);
  }
}

/// A point of the ground with a gradient of about `slope`, lowered by the depth to which a mass of 0.2 kg sinks into an
/// elastic one.
Vec3 place_of_slope(const Floor& floor, double slope) {
  for (double x = 0;; x += 1e-3) {
    const auto here = ground(floor, x, 0.3);
    if (std::abs(std::hypot(here.slope_x, here.slope_y) - slope) < 0.01 * slope)
      return {x, 0.3, floor.rigid() ? here.height : here.height - 0.2 * g / 1e6};
  }
}

TEST_P(OnRoughGround, FrictionHoldsAMassInsideTheConeAndOnlyThere) {
  for (const Floor& floor : {rough_floor(), rigid_rough_floor()}) {
    const Scene scene{Gravity{}, floor, Friction{0.15}, {}, {}};
    const auto moved = [&](double slope, std::uint64_t steps) {
      const Body body = single_mass(0.2, place_of_slope(floor, slope));
      return norm(simulate(body, resting(body, scene), scene, stepping(), steps).state.position[0] -
                  body.masses[0].rest);
    };
    EXPECT_LT(moved(0.14, floor.rigid() ? 2000 : 1000), !floor.rigid() ? 1e-5 : single() ? 1e-6 : 1e-9);
    EXPECT_GT(moved(0.17, 1000), 1e-3);
  }
}

TEST_P(OnRoughGround, FrictionSlowsDownAMassAsOnAnInclinedPlane) {
  // a mass on wide hills, whose slope hardly changes within centimetres; it goes up if the velocity is negative
  const Floor hills{1e4, 1.5, 20, 3};
  const double mass = 0.2, x = 6.7, y = 4.4, dt = 0.0005;  // the slope there is 0.30
  const auto here = ground(hills, x, y);
  const double slope = std::hypot(here.slope_x, here.slope_y), angle = std::atan(slope);
  const Vec3 down = std::cos(angle) * Vec3{-here.slope_x / slope, -here.slope_y / slope, -slope};
  const double depth = mass * g / (hills.stiffness * physics::normal_squared(here));
  const Body body = single_mass(mass, {x, y, here.height - depth});
  for (const auto& [start, coefficient] : {std::pair{0.3, 0.7}, {0.3, 0.15}, {-0.6, 0.7}, {-0.4, 0.15}}) {
    const Scene scene{Gravity{}, hills, Friction{coefficient}, {}, {}};
    const Answer a = simulate_ok(body, moving(body, scene, start * down), scene, stepping(dt), 100);
    // that of a block on an inclined plane, as long as it does not stop
    const double resistance = std::copysign(coefficient, start) * std::cos(angle);
    const double expected = start + g * (std::sin(angle) - resistance) * dt * 100;
    EXPECT_GT(std::abs(expected), 0.05) << "it stops";
    // friction that acted on the horizontal velocity alone would be 0.003 to 0.07 m/s off
    EXPECT_NEAR(dot(a.state.velocity[0], down), expected, 0.002) << start << " m/s, " << coefficient;
  }
}

/// The energy of the body, including the elastic energy of the ground, J.
double whole_energy(const Body& body, const State& state, const Scene& scene) {
  double energy = total_energy(body, state, scene);
  for (const Vec3& x : state.position)
    energy += scene.floor->stiffness * std::pow(std::max(0.0, ground_height(scene, x) - x.z), 2) / 2;
  return energy;
}

/// First-order methods conserve an energy that deviates by dt F v/2; this deviation (J) is largest on the steepest
/// slope, at the speed reached by a fall from the highest to the lowest point.
double largest_deviation(const Floor& floor, double dt) {
  return dt * 0.2 * g * floor.steepest() * std::sqrt(2 * g * 2 * floor.roughness) / 2;
}

TEST_P(OnRoughGround, AMassWithoutFrictionKeepsItsEnergy) {
  const Scene scene{Gravity{}, rough_floor(), {}, {}, {}};
  const Body body = single_mass(0.2, place_of_slope(*scene.floor, 0.2));
  const State start = resting(body, scene);
  const Answer a = simulate_ok(body, start, scene, stepping(0.0001), 20000);
  EXPECT_GT(norm(a.state.position[0] - start.position[0]), 0.05);
  const double gained = whole_energy(body, a.state, scene) - whole_energy(body, start, scene);
  EXPECT_NEAR(gained, 0, largest_deviation(*scene.floor, 0.0001));
}

TEST_P(OnRoughGround, AMassStaysOnARigidOneAndGainsNoEnergy) {
  const Scene scene{Gravity{}, rigid_rough_floor(), {}, {}, {}};
  const Body body = single_mass(0.2, place_of_slope(*scene.floor, 0.2));
  const State start = resting(body, scene);
  const double of_solver = method() == Method::implicit && single() ? 5 : 1;
  for (const std::uint64_t steps : {3000u, 10000u, 20000u}) {
    const Answer a = simulate_ok(body, start, scene, stepping(0.0001), steps);
    EXPECT_GT(norm(a.state.position[0] - start.position[0]), 0.05);
    EXPECT_GT(a.state.position[0].z - ground_height(scene, a.state.position[0]), -1e-5);
    EXPECT_LT(total_energy(body, a.state, scene),
              start.start_energy + of_solver * largest_deviation(*scene.floor, 0.0001));
  }
}

TEST_P(OnRoughGround, AllMethodsLetABlockFallAlike) {
  const Scene scene{Gravity{}, rough_floor(), Friction{}, Damping{}, {}};
  const Body body = block(2, {10000, 0, 0, 0});
  const State start = thrown(body, scene, {0, 0, 0.01});
  const Answer fine = simulate(body, start, scene, {Method::velocity_verlet, Precision::float64, 0.000025}, 12000);
  const Answer a = simulate_ok(body, start, scene, stepping(0.0001), 3000);
  const double off = largest_difference(fine.state, a.state);
  EXPECT_GT(largest_difference(fine.state, start), 0.01);
  EXPECT_LT(off, is_explicit(method()) ? 2e-4 : 1.5e-3);
}

TEST(ImplicitOnRoughGround, BearsStepsBeyondTheExplicitMethods) {
  const Scene scene{Gravity{}, rough_floor(0.1), Friction{}, Damping{}, {}};
  const Body body = block(2, {10000, 0, 0, 0});
  for (const Method method : {Method::implicit, Method::xpbd}) {
    const Answer a = simulate_ok(body, state_at_birth(body, scene), scene, {method, Precision::float32, 0.01}, 1000);
    double speed = 0;
    for (const Vec3& v : a.state.velocity) speed = std::max(speed, norm(v));
    EXPECT_LT(speed * speed / (2 * g), 0.1 / 4) << "leaps over the ground";
  }
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
