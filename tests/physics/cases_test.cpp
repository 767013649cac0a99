// On the CPU: cases in which methods can fail, the guard, runs in pieces, samples, and scenes of single tasks.
#include "cases.hpp"

#include "analysis/ground.hpp"
#include "physics/energy_bound.hpp"
#include "ways.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

class OnTheCpu : public EachWay {};

INSTANTIATE_TEST_SUITE_P(Ways, OnTheCpu, all_ways(), named);

TEST_P(OnTheCpu, HardCasesAreRightOrFlagged) { expect_outcomes(hard_cases(method()), factory()); }

TEST_P(OnTheCpu, DegenerateBodiesGiveNumbers) {
  Body loose = random_body(20, 3, 5, 1), pieces = random_body(40, 5, 5, 2), held = random_body(20, 6, 5, 1);
  loose.springs.clear();
  Body without_materials = loose;
  without_materials.materials.clear();
  std::erase_if(pieces.springs, [](const Spring& s) { return s.a % 2 != s.b % 2 || s.a == 7 || s.b == 7; });
  for (std::size_t i = 0; i < held.masses.size(); i += 2) held.masses[i].mass = 0;
  const std::pair<const char*, Body> bodies[] = {
      {"nothing", {}},
      {"one mass", single_mass(0.2, {3, 4, 5})},
      {"masses without springs", loose},
      {"masses without springs and materials", without_materials},
      {"coincident masses", pair_of_masses(0.2, {5000, 0.14, 1, 0}, 0)},  // with a rest length of 1
      {"several pieces", pieces},
      {"masses of zero", held}};
  for (const auto& [name, body] : bodies)
    for (const Scene& scene : {Scene{}, full_scene()}) {
      SCOPED_TRACE(name);
      const Answer a =
          simulate_ok(body, state_at_birth(body, scene), scene, stepping(), 1050, {.stress = true, .work = true});
      EXPECT_DOUBLE_EQ(a.state.time, 0.525);
      EXPECT_EQ(a.task.stress.size(), body.springs.size());
      EXPECT_TRUE(is_finite(a.task, a.state));
    }
}

TEST_P(OnTheCpu, ScenesMayDifferWithinABatch) { expect_tasks_in_their_own_scenes(factory(2)); }

TEST_P(OnTheCpu, ResonanceLives) { expect_resonance_to_live(factory(), method()); }

TEST_P(OnTheCpu, TheBoundOfEnergyIsOneForOneRunAndForSeveral) { expect_one_bound(factory()); }

TEST_P(OnTheCpu, WhatTheFloorPumpsUpEnds) {
  // the other methods are stable at this step
  if (is_explicit(method()) && method() != Method::rk4) expect_pumped_bodies_to_end(factory());
}

TEST(EnergyBound, GrowsWithTheSquareOfWhatTheMusclesAdd) {
  // the root of 4 J + 5 J is 3; in 2 s, muscles raise it to 9, and so add 81 J - 9 J
  EnergyBound bound{.start = 4, .drive = 3, .allowance = 1};
  EXPECT_DOUBLE_EQ(bound.added(2, 5), 72);
  EXPECT_DOUBLE_EQ(bound.limit(2, 5), 10 * (4 + 72 + 5 + 1));
  bound.start = -1;  // counts as 0
  EXPECT_DOUBLE_EQ(bound.added(2, 0), 36);
  EXPECT_DOUBLE_EQ(bound.limit(2, 0), 10 * (36 + 1));
}

TEST_P(OnTheCpu, PiecesAndSamplesLeaveTheBitsOfTheWhole) {
  const std::vector<Body> bodies{random_body(107, 9, 5, 6), random_body(41, 6, 23, 7), single_mass(0.2),
                                 with_dashpots(random_body(43, 8, 5, 3))};
  expect_pieces_to_be_the_whole(factory(), bodies);
  expect_samples_to_change_nothing(factory(), bodies);
}

TEST_P(OnTheCpu, PiecesBetweenTalliesLeaveThemToo) {
  const Body body = random_body(41, 6, 5, 7);
  for (const Body& each : {body, with_dashpots(body)}) expect_tallies_to_leave_the_motion_alone(factory(), each);
}

TEST_P(OnTheCpu, PiecesAreNotCheckedWhereTheyMeet) { expect_no_check_between_pieces(factory()); }

TEST_P(OnTheCpu, PiecesDivergeWhereTheWholeDoes) {
  if (is_explicit(method())) expect_one_verdict(factory(), method());
}

TEST_P(OnTheCpu, SamplesAreTrue) {
  const Body body = random_body(61, 9, 5, 6);
  for (const Body& each : {body, with_dashpots(body)}) expect_samples_to_be_true(factory(), each, 1e-12);
  expect_samples_to_be_true_after_removals(factory(), 1e-12);
  expect_samples_in_pieces(factory(), body);
}

TEST_P(OnTheCpu, SamplesCountContactFromTheLandingOn) {
  if (is_explicit(method())) expect_contact_from_the_landing_on(factory());  // other methods damp an impact
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
