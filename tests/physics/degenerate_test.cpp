// Degenerate bodies: the simulator neither crashes nor gives NaN.
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/ground.hpp"
#include "evodevo/lattice.hpp"
#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// Simulates `body` with every method in two scenes and both precisions, with everything recorded. Expects that all
/// results are finite.
void expect_numbers(const Body& body) {
  for (const Method method : all_methods)
    for (const Precision precision : {Precision::float32, Precision::float64})
      for (const Scene& scene : {Scene{}, full_scene()}) {
        SCOPED_TRACE(name_of({method, precision}));
        const Answer a = simulate(body, state_at_birth(body, scene), scene, {method, precision, 0.0005}, 1050,
                                  {.stress = true, .work = true});
        EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
        EXPECT_DOUBLE_EQ(a.state.time, 0.525);
        EXPECT_TRUE(std::isfinite(a.task.work));
        EXPECT_EQ(a.task.stress.size(), body.springs.size());
        for (const double stress : a.task.stress) EXPECT_TRUE(std::isfinite(stress));
        for (const Vec3& x : a.state.position) EXPECT_TRUE(std::isfinite(x.x + x.y + x.z));
        for (const Vec3& v : a.state.velocity) EXPECT_TRUE(std::isfinite(v.x + v.y + v.z));
      }
}

TEST(Degenerate, Nothing) { expect_numbers({}); }

TEST(Degenerate, OneMass) { expect_numbers(single_mass(0.2, {3, 4, 5})); }

TEST(Degenerate, MassesWithoutSprings) {
  Body body = random_body(20, 3, 5, 1);
  body.springs.clear();
  expect_numbers(body);
  body.materials.clear();
  expect_numbers(body);
}

TEST(Degenerate, CoincidentMasses) {
  Body body = random_body(20, 6, 5, 1);
  body.masses[7].rest = body.masses[3].rest;
  for (Spring& s : body.springs) s.rest_length = norm(body.masses[s.b].rest - body.masses[s.a].rest);
  expect_numbers(body);
  expect_numbers(pair_of_masses(0.2, {5000, 0.14, 1, 0}, 0));  // with a rest length of 1
}

TEST(Degenerate, SeveralPieces) {
  Body body = random_body(40, 5, 5, 2);
  const Body other = random_body(3, 2, 5, 3);
  for (const Mass& mass : other.masses) body.masses.push_back(mass);
  for (Spring s : other.springs) {
    s.a += 40, s.b += 40;
    body.springs.push_back(s);
  }
  body.masses.push_back({{0, 0, 1}, 0.2});
  expect_numbers(body);
}

TEST(Degenerate, MassesOfZero) {
  Body body = random_body(20, 6, 5, 1);
  for (std::size_t i = 0; i < body.masses.size(); i += 2) body.masses[i].mass = 0;
  expect_numbers(body);
}

TEST(Degenerate, NoSteps) {
  const Body body = random_body(20, 6, 5, 1);
  const State start = state_at_birth(body, full_scene());
  const Answer a = simulate(body, start, full_scene(), {}, 0, {.stress = true});
  EXPECT_EQ(a.task.status, Status::ok);
  EXPECT_EQ(a.state.position, start.position);  // not even rounded
  EXPECT_EQ(a.task.stress, std::vector<double>(body.springs.size()));
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

TEST(Lattice, TenVoxelsASideAreThePapersBody) {
  const Lattice lattice = make_lattice({10, 10, 10}, 0.1);
  EXPECT_EQ(lattice.corners.size(), 1331u);
  EXPECT_EQ(lattice.springs.size(), 14230u);
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
