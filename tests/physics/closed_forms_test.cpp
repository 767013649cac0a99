// The motion and the recordings of the simulator compared with closed-form solutions.
#include <array>
#include <cmath>
#include <complex>
#include <utility>

#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "ways.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

constexpr double g = 9.81;

TEST(Vec3, HasThreeCoordinatesByNameAndByNumber) {
  Vec3 v{1, 2, 3};
  EXPECT_EQ((std::array{std::as_const(v)[0], std::as_const(v)[1], std::as_const(v)[2]}), (std::array{1.0, 2.0, 3.0}));
  for (std::size_t axis = 0; axis < 3; ++axis) v[axis] *= -2;
  EXPECT_EQ(v, (Vec3{-2, -4, -6}));
  EXPECT_EQ(v[3], -6) << "defined, though no coordinate";
}

TEST(Vec3, IsNormalisedUnlessItHasNoDirection) {
  EXPECT_EQ(normalised({0, -3, 4}), (Vec3{0, -0.6, 0.8}));
  EXPECT_NEAR(norm(normalised({1e-3, 2e-3, -7e-3})), 1, 1e-15);
  EXPECT_EQ(normalised({0, 0, 0}), (Vec3{0, 0, 0}));
}

class ClosedForm : public EachWay {};

INSTANTIATE_TEST_SUITE_P(Methods, ClosedForm, all_ways(), named);

Scene gravity_only() { return {Gravity{}, {}, {}, {}, {}}; }

TEST_P(ClosedForm, FreeFallIsThatOfTheMethod) {
  const Body body = single_mass(0.2, {1, 2, 100});
  const double t = 1, dt = 0.0005;
  const Answer a = simulate_ok(body, moving(body, gravity_only(), {3, 0, 4}), gravity_only(), stepping(dt), 2000);
  EXPECT_NEAR(a.state.velocity[0].z, 4 - g * t, 30 * rounding());
  // methods with x <- x + dt v and the new v fall g t dt / 2 further than g t^2 / 2; the other methods are exact
  const bool exact = method() == Method::velocity_verlet || method() == Method::rk4;
  EXPECT_NEAR(a.state.position[0].z, 100 + 4 * t - g * t * (t + (exact ? 0 : dt)) / 2, 1000 * rounding());
  EXPECT_NEAR(a.state.position[0].x, 1 + 3 * t, 100 * rounding());
  EXPECT_DOUBLE_EQ(a.state.position[0].y, 2);
  const Answer far = simulate_ok(body, state_at_birth(body, gravity_only()), gravity_only(), stepping(), 20000);
  EXPECT_NEAR(far.state.velocity[0].z, -98.1, 0.05);
}

/// The stretch of a spring that starts at rest, relative to its initial stretch, after n steps of h = omega dt.
double discrete_swing(Method method, double h, double n) {
  using namespace std::complex_literals;
  const double theta = std::acos(1 - h * h / 2);
  if (!is_explicit(method)) return std::pow(1.0 / (1.0 - 1i * h), n).real();  // xpbd of one spring is backward Euler
  if (method == Method::rk4)
    return std::pow(1.0 + 1i * h - h * h / 2 - 1i * h * h * h / 6.0 + h * h * h * h / 24, n).real();
  return method == Method::velocity_verlet ? std::cos(n * theta) : std::cos((n + 0.5) * theta) / std::cos(theta / 2);
}

TEST_P(ClosedForm, ASpringSwingsAsItsMethodDoes) {
  const double k = 4000, mass = 0.2, dt = 0.0005, stretch = 0.01;
  const double omega = std::sqrt(2 * k / mass);
  for (const double factor : {1.0, 0.3}) {
    Body body = pair_of_masses(mass, {k / factor, 0, 0, 0}, 1 + stretch);
    body.springs[0].stiffness_factor = factor;
    for (const std::uint64_t n : {1u, 10u, 63u, 500u}) {
      const Answer a = simulate(body, resting(body, {}), {}, stepping(dt), n);
      const double expected = 1 + stretch * discrete_swing(method(), omega * dt, static_cast<double>(n));
      EXPECT_NEAR(a.state.position[1].x - a.state.position[0].x, expected, 2 * rounding()) << n << " steps";
    }
  }
}

TEST_P(ClosedForm, ADrivenSpringFollowsItsEquation) {
  const double k = 500, mass = 0.2, dt = 0.0001, amplitude = 0.1, frequency = 2, phase = 0.7;
  const Body body = pair_of_masses(mass, {k, amplitude, frequency, phase});
  const double omega = std::sqrt(2 * k / mass), drive = 2 * pi * frequency;
  const double c = amplitude * omega * omega / (omega * omega - drive * drive);
  const Answer a = simulate(body, resting(body, {}), {}, stepping(dt), 7000);
  const double t = 0.7;
  const double stretch = c * (std::sin(drive * t + phase) - std::sin(phase) * std::cos(omega * t) -
                              drive / omega * std::cos(phase) * std::sin(omega * t));
  const double error = is_explicit(method()) ? 1e-3 : 2e-2;  // the others damp, which is a first-order error
  EXPECT_NEAR(a.state.position[1].x - a.state.position[0].x, 1 + stretch, error);
}

TEST_P(ClosedForm, LateTimesKeepTheirPhase) {
  // after 10^6 periods of the muscle, the drive is the same as at birth
  const Body body = pair_of_masses(0.2, {500, 0.1, 2, 0.3});
  State late = resting(body, {});
  late.time = 500000;
  const Answer young = simulate(body, resting(body, {}), {}, stepping(), 500);
  const Answer old = simulate(body, late, {}, stepping(), 500);
  EXPECT_LT(largest_difference(young.state, old.state), single() ? 1e-6 : 1e-8);
  EXPECT_EQ(old.state.time, 500000.25);
}

TEST_P(ClosedForm, DragPointsAgainstTheVelocity) {
  const Scene scene{{}, {}, {}, {}, Drag{0.5}};
  const Body body = single_mass(0.2);
  const Answer a = simulate(body, moving(body, scene, {3, -4, 12}), scene, stepping(), 2000);
  const Vec3 v = a.state.velocity[0];
  EXPECT_NEAR(norm(v), 13 / (1 + 13 * 0.5 / 0.2), 1e-3);  // v0 / (1 + v0 c t / m), first order in dt
  EXPECT_NEAR(v.y / v.x, -4.0 / 3, 100 * rounding());
  EXPECT_NEAR(v.z / v.x, 4, 100 * rounding());
}

TEST_P(ClosedForm, DampingIsAnExactDecay) {
  const Scene scene{{}, {}, {}, Damping{3}, {}};
  const Body body = single_mass(0.2);
  for (const double dt : {0.0005, 0.002}) {
    const auto steps = static_cast<std::uint64_t>(std::lround(0.5 / dt));
    const Answer a = simulate(body, moving(body, scene, {1, 2, -2}), scene, stepping(dt), steps);
    // rk4 integrates damping like a force; the other methods apply its exact factor
    const double error = 10 * rounding() + (method() == Method::rk4 ? 1e-10 : 0);
    EXPECT_NEAR(norm(a.state.velocity[0]), 3 * std::exp(-1.5), error) << "dt " << dt;
  }
}

TEST_P(ClosedForm, TheFloorCarriesTheWeightOfWhatRestsOnIt) {
  const Scene soft{Gravity{}, Floor{2e4}, {}, Damping{}, {}};
  const Body mass = single_mass(0.2), body = block(2, {10000, 0, 0, 0});
  EXPECT_NEAR(simulate_ok(mass, state_at_birth(mass, soft), soft, stepping(), 6000).state.position[0].z, -0.2 * g / 2e4,
              1e-9);
  const Answer a = simulate_ok(body, state_at_birth(body, walking_scene()), walking_scene(), stepping(), 10000);
  double push = 0;
  for (const Vec3& x : a.state.position) push += 1e6 * std::max(0.0, -x.z);
  EXPECT_NEAR(push, 27 * 0.2 * g, 1e-3 * 27 * 0.2 * g);
}

Floor rigid(double restitution) { return {.restitution = restitution}; }

/// A mass at rest on a floor with a slope of `slope` degrees.
Body mass_on(const Floor& floor, double slope = 0) {
  return single_mass(0.2, {0, 0, floor.rigid() ? 0 : -0.2 * g * std::cos(slope * pi / 180) / floor.stiffness});
}

TEST_P(ClosedForm, ASlidingMassStopsAfterItsStoppingDistance) {
  const Scene scene{Gravity{}, Floor{}, Friction{0.4}, {}, {}};
  const Body body = mass_on(*scene.floor);
  const double v = 1.5, distance = v * v / (2 * 0.4 * g);
  const Answer a = simulate(body, moving(body, scene, {0.6 * v, 0.8 * v, 0}), scene, stepping(), 2000);
  // velocity-verlet and rk4 are exact except in the last step
  const bool exact = method() == Method::velocity_verlet || method() == Method::rk4;
  const double error = (exact ? 0.1 : 1) * v * 0.0005;
  EXPECT_NEAR(a.state.position[0].x, 0.6 * distance, error);
  EXPECT_NEAR(a.state.position[0].y, 0.8 * distance, error);
  EXPECT_EQ(a.state.velocity[0].x, 0);
  EXPECT_EQ(a.state.velocity[0].y, 0);
}

TEST_P(ClosedForm, ABlockSlidesToItsStoppingDistanceAndFasterAndFasterDownASlope) {
  const double mu = 0.5, steep = 35, angle = steep * pi / 180, down = g * (std::sin(angle) - mu * std::cos(angle));
  const Body body = block(2, {10000, 0, 0, 0});
  const struct {
    Floor floor;
    double slope, speed;
    std::uint64_t steps;
    double distance;
  } cases[] = {{Floor{}, 0, 1, 3000, 1 / (2 * mu * g)},
               {rigid(0), 0, 1, 3000, 1 / (2 * mu * g)},
               {Floor{}, steep, 0, 1000, down * 0.5 * 0.5 / 2}};
  for (const auto& [floor, slope, speed, steps, distance] : cases) {
    const Scene settling{Gravity{}, floor, Friction{mu}, Damping{}, {}},
        scene{Gravity{g, slope}, floor, Friction{mu}, {}, {}};
    State start = simulate(body, state_at_birth(body, settling), settling, stepping(), 6000).state;
    EXPECT_GT(bounding_box(start.position).low.z, floor.rigid() ? -1e-9 : -1e-4);
    const double from = centre_of_mass(body, start.position).x;
    for (Vec3& velocity : start.velocity) velocity.x += speed;
    start.start_energy = total_energy(body, start, scene);
    const Answer a = simulate_ok(body, start, scene, stepping(), steps);
    EXPECT_NEAR(centre_of_mass(body, a.state.position).x - from, distance, 0.05 * distance) << slope << " degrees";
  }
}

/// A mass on the floor, pulled along x by a spring with the force `force` (N). The other end of the spring is held by a
/// mass of 0 kg.
Body drawn_mass(double force) {
  const double k = 100;
  Body body = pair_of_masses(0.2, {k, 0, 0, 0}, 1 + force / k);
  for (Mass& mass : body.masses) mass.rest.z = -0.2 * g / 1e6;
  body.masses[1].mass = 0;
  return body;
}

TEST_P(ClosedForm, FrictionHoldsInsideTheConeAndOnlyThere) {
  const Scene scene{Gravity{}, Floor{}, Friction{0.5}, {}, {}};
  const double cone = 0.5 * 0.2 * g;
  const Body held = drawn_mass(0.99 * cone), slipping = drawn_mass(1.01 * cone);
  const Answer a = simulate(held, resting(held, scene), scene, stepping(), 2000);
  EXPECT_EQ(a.state.position[0].x, 0);
  EXPECT_EQ(a.state.velocity[0].x, 0);
  const Answer b = simulate(slipping, resting(slipping, scene), scene, stepping(), 200);
  EXPECT_GT(b.state.position[0].x, 1e-5);
  const double end = slipping.masses[1].rest.x;
  EXPECT_EQ(b.state.position[1].x, single() ? static_cast<double>(static_cast<float>(end)) : end) << "it is held";
}

/// A scene with a slope of `slope` degrees.
Scene inclined(double slope, const Floor& floor, Friction friction) {
  return {Gravity{g, slope}, floor, friction, {}, {}};
}

TEST_P(ClosedForm, AMassGoesDownASlopeFasterThanFrictionHolds) {
  const double slope = 30, mu = 0.3, dt = 0.0005, angle = slope * pi / 180;
  const double acceleration = g * (std::sin(angle) - mu * std::cos(angle));
  for (const Floor& floor : {Floor{}, rigid(0.4)}) {
    const Body body = mass_on(floor, slope);
    const Scene scene = inclined(slope, floor, {mu});
    const Answer a = simulate_ok(body, resting(body, scene), scene, stepping(dt), 2000);
    const double error = floor.rigid() ? 50 * rounding() : 1e-3;
    EXPECT_NEAR(a.state.velocity[0].x, acceleration, error * acceleration);
    EXPECT_NEAR(a.state.position[0].x, acceleration / 2, (error + dt) * acceleration);
    EXPECT_EQ(a.state.position[0].y, 0);
    if (floor.rigid()) {
      EXPECT_EQ(a.state.position[0].z, 0);
    }
  }
}

TEST_P(ClosedForm, AMassRestsOnASlopeWithinTheAngleOfFrictionAndOnlyThere) {
  const double mu = 0.5, cone = std::atan(mu) * 180 / pi;
  for (const Floor& floor : {Floor{}, rigid(0)})
    for (const double part : {floor.rigid() ? 0.999 : 0.99, 1.01})
      for (const double slope : {part * cone, -part * cone}) {
        const Body body = mass_on(floor, slope);
        const Scene scene = inclined(slope, floor, {mu});
        const double x = simulate(body, resting(body, scene), scene, stepping(), 1000).state.position[0].x;
        if (part < 1)
          EXPECT_EQ(x, 0) << slope << " degrees";
        else
          EXPECT_GT(std::copysign(1, slope) * x, 1e-3) << slope << " degrees";
      }
}

TEST_P(ClosedForm, StaticFrictionHoldsAMassAtRestAndLetsItSlideOn) {
  const double kinetic = 0.3, held = 0.6, slope = 25, angle = slope * pi / 180;  // between the two angles of friction
  for (const Floor& floor : {rigid(0), Floor{}}) {
    const Body body = mass_on(floor, slope);
    const Scene scene = inclined(slope, floor, {kinetic, held});
    const Answer still = simulate(body, resting(body, scene), scene, stepping(), 1000);
    EXPECT_EQ(still.state.position[0].x, 0);
    const Answer slid = simulate(body, moving(body, scene, {0.1, 0, 0}), scene, stepping(), 1000);
    const double speed = 0.1 + 0.5 * g * (std::sin(angle) - kinetic * std::cos(angle));
    EXPECT_NEAR(slid.state.velocity[0].x, speed, 1e-3 * speed);
    const Scene steeper = inclined(1.02 * std::atan(held) * 180 / pi, floor, {kinetic, held});
    EXPECT_GT(simulate(body, resting(body, steeper), steeper, stepping(), 1000).state.position[0].x, 1e-3);
  }
}

TEST_P(ClosedForm, ABlockRestsOnASlopeWithinTheAngleOfFriction) {
  const Body body = block(2, {10000, 0, 0, 0});
  Scene scene = inclined(0.9 * std::atan(0.5) * 180 / pi, Floor{}, {0.5});
  scene.damping.emplace();
  const Answer settled = simulate(body, state_at_birth(body, scene), scene, stepping(), 6000);
  const Answer later = simulate_ok(body, settled.state, scene, stepping(), 2000);
  EXPECT_LT(largest_difference(settled.state, later.state), 1e-5);
}

TEST_P(ClosedForm, GoingFarDownASlopeIsNoDivergence) {
  const double angle = 20 * pi / 180;
  const Scene scene{Gravity{g, 20}, Floor{}, {}, {}, {}};
  const Body body = mass_on(*scene.floor, 20);
  const State start = resting(body, scene);
  const Answer a = simulate_ok(body, start, scene, stepping(), 20000);
  EXPECT_NEAR(a.state.velocity[0].x, 10 * g * std::sin(angle), 0.05);
  const double kinetic = 0.1 * std::pow(norm(a.state.velocity[0]), 2);
  EXPECT_NEAR(total_energy(body, a.state, scene), start.start_energy, 1e-3 * kinetic) << "what it fell is what it has";
}

TEST_P(ClosedForm, FrictionNeedsAFloor) {
  const Scene scene{Gravity{}, {}, Friction{0.5}, {}, {}};
  const Body body = single_mass(0.2, {0, 0, -1});
  const Answer a = simulate(body, moving(body, scene, {1, 0, 0}), scene, stepping(), 100);
  EXPECT_EQ(a.state.velocity[0].x, 1);
}

TEST_P(ClosedForm, AStaticallyLoadedSpringIsUnderItsLoad) {
  // a mass of 0.2 kg hangs on a spring from a fixed mass, or stands on it; the spring is strained by m g / k
  const double weight = 0.2 * 9.81, k = 1000, near = single() ? 2e-3 : 1e-9;
  const Scene scene{Gravity{}, {}, {}, {}, {}};
  for (const double direction : {1.0, -1.0}) {
    Body body = pair_of_masses(0.2, {k, 0, 0, 0});
    body.masses[0] = {{0, 0, 1 + direction}, 0};
    body.masses[1] = {{0, 0, 1 - weight / k}, 0.2};
    const Recording of_springs{.stress = true, .peak_force = true, .muscle_work = true, .tension = true};
    const Answer a = simulate(body, resting(body, scene), scene, stepping(), 1234, of_springs);
    ASSERT_EQ(a.task.stress.size(), 1u);
    EXPECT_NEAR(a.task.stress[0], weight, near);
    EXPECT_NEAR(a.task.peak_force.at(0), weight, near);
    EXPECT_NEAR(a.task.tension.at(0), direction * weight, near);
    EXPECT_EQ(a.task.muscle_work, std::vector{0.0}) << "no muscle";
    EXPECT_EQ(a.task.work, 0);
  }
}

TEST_P(ClosedForm, ASwingingSpringPeaksAtTheEndsOfItsSwing) {
  // A hanging mass that is released at the rest length oscillates; the force of the spring varies between 0 and twice
  // the weight. Over whole periods of 2 pi sqrt(m/k) = 88.9 ms, its mean is the weight.
  const double mass = 0.2, weight = mass * 9.81, k = 1000, period = 2 * pi * std::sqrt(mass / k);
  Body body = pair_of_masses(mass, {k, 0, 0, 0});
  body.masses[0] = {{0, 0, 2}, 0};
  body.masses[1] = {{0, 0, 1}, mass};
  const Scene scene{Gravity{}, {}, {}, {}, {}};
  const Answer a = simulate(body, resting(body, scene), scene, stepping(period / 1000), 3000, all_records);
  // implicit and xpbd damp the oscillation: its first peak is reduced by a factor of e^(-pi/2 dt omega)
  const double damped = is_explicit(method()) ? 1e-3 : 0.02;
  EXPECT_NEAR(a.task.peak_force.at(0), 2 * weight, damped * 2 * weight);
  EXPECT_NEAR(a.task.tension.at(0), weight, damped * weight);
  EXPECT_NEAR(a.task.stress.at(0), a.task.tension[0], 1e-4 * weight) << "it never pushes";
}

TEST_P(ClosedForm, AnIsometricMuscleWorksWhileItPushesOut) {
  // Both ends are held: |d| = L0, so force = -k L0 A sin and dL/dt = L0 A w cos. Over a period, the positive part of
  // their product has the integral k (L0 A)^2, and |force| has the mean 2/pi k L0 A.
  const double k = 2000, amplitude = 0.1;
  Body body = pair_of_masses(0, {k, amplitude, 2, 0});
  const Answer a = simulate(body, resting(body, {}), {}, stepping(), 1000, all_records);
  EXPECT_NEAR(a.task.work, k * amplitude * amplitude, 1e-3 * k * amplitude * amplitude);
  EXPECT_NEAR(a.task.muscle_work.at(0), a.task.work, 1e-12) << "the only one";
  EXPECT_NEAR(a.task.stress[0], 2 / pi * k * amplitude, 1e-3 * k * amplitude);
  EXPECT_NEAR(a.task.peak_force.at(0), k * amplitude, 1e-3 * k * amplitude);
  EXPECT_NEAR(a.task.tension.at(0), 0, 1e-3 * k * amplitude) << "over a whole period";
}

TEST_P(ClosedForm, ASpringOfNoLengthIsUnderNoStress) {
  Body body = pair_of_masses(0.2, {1000, 0, 0, 0}, 0);
  const Answer a = simulate(body, resting(body, {}), {}, stepping(), 10, {.stress = true, .work = true});
  EXPECT_EQ(a.task.stress[0], 0);
}

TEST_P(ClosedForm, RecordingsHoldWhatIsAskedForAlone) {
  const Body body = random_body(30, 6, 5, 1);
  const State start = state_at_birth(body, {});
  const auto recorded = [&](Recording recording) { return simulate(body, start, {}, stepping(), 200, recording); };
  const Answer none = recorded({}), all = recorded(all_records);
  EXPECT_EQ(none.task.work, 0);
  EXPECT_GT(all.task.work, 0);
  double sum = 0;
  for (std::size_t i = 0; i < body.springs.size(); ++i) {
    const bool is_muscle = body.materials[body.springs[i].material].amplitude != 0;
    EXPECT_TRUE(is_muscle ? all.task.muscle_work.at(i) >= 0 : all.task.muscle_work.at(i) == 0) << i;
    sum += all.task.muscle_work[i];
  }
  EXPECT_NEAR(sum, all.task.work, 1e-12 * all.task.work);
  for (const auto list : SpringRecords::lists) {
    EXPECT_TRUE((none.task.*list).empty());
    EXPECT_EQ((all.task.*list).size(), body.springs.size());
  }
  EXPECT_TRUE(same_bits(none.state, all.state)) << "recording does not change the motion";
  for (const Recording one : {Recording{.stress = true}, Recording{.work = true}, Recording{.peak_force = true},
                              Recording{.muscle_work = true}, Recording{.tension = true}}) {
    const Answer a = recorded(one);
    // a recorded quantity does not depend on which other quantities are recorded
    SpringRecords expected = all.task;
    expected.keep(one);
    for (const auto list : SpringRecords::lists) EXPECT_EQ(a.task.*list, expected.*list);
    EXPECT_EQ(a.task.work, one.work ? all.task.work : 0);
    EXPECT_TRUE(same_bits(none.state, a.state));
  }
}

class FreeBodies : public EachWay {};

INSTANTIATE_TEST_SUITE_P(Methods, FreeBodies, all_ways(), named);

TEST_P(FreeBodies, StayWhereTheyAre) {
  // for 200 s, in which a body would drift by metres if every step added 1e-7 of its masses' momentum
  const Body body = random_body(16, 7, 5, 1);
  const State start = resting(body, {});
  const double dt = is_explicit(method()) ? 0.001 : 0.01;
  const Answer a = simulate_ok(body, start, {}, stepping(dt), static_cast<std::uint64_t>(200 / dt));
  const Vec3 drift = centre_of_mass(body, a.state.position) - centre_of_mass(body, start.position);
  EXPECT_LT(norm(drift), single() ? 5e-3 : 1e-9) << "m";
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
