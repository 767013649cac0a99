// Controls of development, and schedules of its operators.
#include "life/controls.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/philox.hpp"
#include "life/edits.hpp"
#include "support/changed.hpp"
#include "support/edits.hpp"
#include "support/lives.hpp"
#include "support/told.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using testing::changing, testing::indices, testing::removing;
using ::testing::ElementsAre;
using testing::Told;

const Material bone{10000, 0, 0, 0};
const Material muscle{5000, 0.14, 1, 0};

// changes at random places -------------------------------------------------------------------------------------------

using Kinds = std::vector<Amount::SpringKind>;

/// A ring of 40 masses, each joined to the two nearest ones on either side by springs that are alternately of bone and
/// of muscle.
struct Ring {
  LivingBody living;
  Genome genome;
  Layout layout;

  Ring() {
    Rng rng(philox, {5, 0, 0, 0});
    living.body.materials = {bone, muscle};
    for (int i = 0; i < 40; ++i) {
      const Vec3 position{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(0, 1)};
      living.body.masses.push_back({position, 0.2, 0, 0});
      living.state.position.push_back(position);
      living.state.velocity.push_back({});
    }
    for (std::uint32_t i = 0; i < 80; ++i) {
      const std::uint32_t a = i / 2, b = (a + 1 + i % 2) % 40;
      living.body.springs.push_back({a, b, norm(position(a) - position(b)), i % 4 < 2 ? 0u : 1u});
      living.stress.push_back(i);
    }
  }

  Vec3 position(std::uint32_t mass) const { return living.state.position[mass]; }
  DevoContext context() const {
    return {living.body, living.state, 1, 2, 1, 2, 0.25, {{-1, -1, 0}, {1, 1, 1}}, 0.2, false, genome, layout};
  }
  Edits moved(const Amount& amount, std::uint64_t seed, std::size_t& surplus) const {
    Rng rng(philox, {seed, 1, 2, 3});
    const DevoContext seen = context();
    Chance chance(seen, rng);
    return at_random_places(amount, seen, surplus, chance);
  }
  Edits moved(const Edits& edits, std::uint64_t seed) const {
    std::size_t surplus = 0;
    return moved(amount_of(edits, living.body, 0), seed, surplus);
  }
  Body after(const Edits& edits) const {
    Ring changed = *this;
    apply(resolved(edits, changed.context()), changed.living);
    return changed.living.body;
  }
};

/// Edits of every kind. Springs 40 (bone) and 42 (muscle) change; removing the two masses removes seven springs as
/// well.
Edits some_of_everything() {
  Edits edits(40, 80);
  for (const std::uint32_t spring : {0, 1, 2}) edits.remove_spring(spring, {.cause = 9});
  for (const std::uint32_t mass : {7, 8}) edits.remove_mass(mass);
  edits.change_spring(40, {.rest_length = 1.0});
  edits.change_spring(42, {.material = Material{6000, 0.2, 1, 0}});
  edits.join(edits.add_mass({5, 5, 5}, {.mass = 0.3, .material = 1}), 0, muscle);
  edits.join(edits.add_mass({6, 6, 6}, {.mass = 0.4, .material = 0}), 0, bone, {.rest_length = 2.0});
  edits.join(0, 20, muscle, {.like = 0});
  edits.join(1, 20, muscle);
  return edits;
}

/// Edits of a ring that add a spring of bone between opposite masses.
Edits joining(const NewSpring& spring = {}) {
  Edits edits(40, 80);
  edits.join(0, 20, bone, spring);
  return edits;
}

TEST(RandomPlaces, AsMuchChangesAsBefore) {
  const Ring ring;
  const Edits edits = some_of_everything();
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Edits moved = ring.moved(edits, seed);
    EXPECT_EQ(moved.removed_masses.size(), 2u);
    EXPECT_EQ(moved.changed_springs.size(), 2u);
    EXPECT_EQ(moved.new_masses.size(), 2u);
    ASSERT_EQ(moved.new_springs.size(), 4u);
    EXPECT_EQ(moved.new_masses[1].mass, 0.4);
    EXPECT_EQ(moved.new_masses[1].material, 0);
    for (std::size_t s = 0; s < 4; ++s) EXPECT_EQ(moved.new_springs[s].material, edits.new_springs[s].material);
    EXPECT_TRUE(moved.new_springs[0].a == 40 || moved.new_springs[0].b == 40) << "new masses get their springs";
    EXPECT_THAT(testing::all_causes(moved), ::testing::IsEmpty());
    const Body after = ring.after(moved);
    EXPECT_EQ(after.masses.size(), 40u);
    EXPECT_EQ(after.springs.size(), 80u - 10 + 4) << "those of the masses that go count";
  }
}

TEST(RandomPlaces, TheMixOfMaterialsStays) {
  Ring ring;
  for (std::size_t i = 0; i < 40; ++i) ring.living.body.masses[i].material = i % 2 == 0 ? 0 : 1;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    std::vector<int> count(2, 0);
    for (const Spring& spring : ring.after(ring.moved(removing(ring.living.body, {0, 1, 2, 4}), seed)).springs)
      ++count.at(spring.material);
    EXPECT_EQ(count, (std::vector{37, 39})) << "three of bone go, and one of muscle";
    for (const Removal& mass : ring.moved(removing(ring.living.body, {}, {0, 2, 4}), seed).removed_masses)
      EXPECT_EQ(mass.index % 2, 0u);
  }
}

TEST(RandomPlaces, AnyMaterialGoesWhereNoneOfItsOwnIsLeft) {
  const Ring ring;
  std::size_t surplus = 0;
  const Edits moved = ring.moved({.springs_gone = Kinds(41, {muscle})}, 1, surplus);
  ASSERT_EQ(moved.removed_springs.size(), 41u);
  const auto material = [&](const Removal& s) { return ring.living.body.springs[s.index].material; };
  EXPECT_EQ(std::ranges::count(moved.removed_springs, 1u, material), 40) << "all of muscle";
  const Material tissue{4000, 0, 0, 0};
  EXPECT_EQ(ring.moved({.springs_gone = Kinds(2, {tissue})}, 1, surplus).removed_springs.size(), 2u);
  EXPECT_EQ(ring.moved({.springs_gone = Kinds(81, {bone})}, 1, surplus).removed_springs.size(), 80u);
}

TEST(RandomPlaces, WhatGoesTooMuchWithAMassIsMadeUpForLater) {
  const Ring ring;
  std::size_t surplus = 0;
  const Edits first = ring.moved({.springs_gone = Kinds(1, {bone}), .masses_gone = {bone}}, 1, surplus);
  EXPECT_EQ(first.removed_masses.size(), 1u);
  EXPECT_TRUE(first.removed_springs.empty());
  EXPECT_EQ(surplus, 3u) << "four springs have gone with the mass";
  const Edits second = ring.moved({.springs_gone = Kinds(2, {bone})}, 2, surplus);
  EXPECT_TRUE(second.empty());
  EXPECT_EQ(surplus, 1u);
  const Edits third = ring.moved({.springs_gone = Kinds(5, {bone})}, 3, surplus);
  EXPECT_EQ(third.removed_springs.size(), 4u);
  EXPECT_EQ(surplus, 0u);
}

TEST(RandomPlaces, AllPlacesAreReachedAlike) {
  const Ring ring;
  std::vector<int> gone_springs(80, 0), gone_masses(40, 0), joined(40, 0);
  double height = 0;
  constexpr int rounds = 2000;
  for (std::uint64_t seed = 0; seed < rounds; ++seed) {
    const Edits springs = ring.moved(removing(ring.living.body, {0, 1, 2, 3}), seed);
    for (const std::uint32_t s : indices(springs.removed_springs)) ++gone_springs[s];
    Edits turnover = removing(ring.living.body, {}, {0, 1});
    turnover.add_mass({}, {.mass = 0.2, .material = 0});
    const Edits masses = ring.moved(turnover, seed);
    for (const std::uint32_t m : indices(masses.removed_masses)) ++gone_masses[m];
    height += masses.new_masses[0].position.z / rounds;
    for (const NewSpring& spring : ring.moved(joining(), seed).new_springs) {
      ++joined[spring.a];
      ++joined[spring.b];
    }
  }
  for (const auto& counts : {gone_springs, gone_masses, joined})
    EXPECT_THAT(counts, ::testing::Each(::testing::AllOf(::testing::Ge(50), ::testing::Le(150))));  // five deviations
  EXPECT_NEAR(height, 0.5, 0.04);
}

TEST(RandomPlaces, SpringsOfTheSameMaterialChangeByTheSameFactors) {
  const Ring ring;
  const Spring& before = ring.living.body.springs[3];
  ASSERT_EQ(before.material, 1u);
  const ChangedSpring wanted{
      .spring = 3, .rest_length = 0.9 * before.rest_length, .material = Material{5000, 0.2, 1, 0}};
  std::set<std::uint32_t> reached;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const Edits moved = ring.moved(changing(ring.living.body, {wanted}), seed);
    ASSERT_EQ(moved.changed_springs.size(), 1u);
    const ChangedSpring& change = moved.changed_springs[0];
    const Spring& other = ring.living.body.springs[change.spring];
    EXPECT_EQ(other.material, 1u);
    EXPECT_EQ(change.material, wanted.material);
    EXPECT_NEAR(*change.rest_length, 0.9 * other.rest_length, 1e-12);
    reached.insert(change.spring);
  }
  EXPECT_EQ(reached.size(), 40u);
}

TEST(RandomPlaces, SpringsOfTheSameKindBecomeAsStiff) {
  Ring ring;
  for (std::size_t i = 0; i < 80; ++i) ring.living.body.springs[i].stiffness_factor = i % 8 == 3 ? 4 : 2;
  std::set<std::uint32_t> reached;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const Edits moved = ring.moved(changing(ring.living.body, {{.spring = 3, .stiffness_factor = 6}}), seed);
    ASSERT_EQ(moved.changed_springs.size(), 1u);
    EXPECT_EQ(moved.changed_springs[0].stiffness_factor, 6);
    EXPECT_FALSE(moved.changed_springs[0].material);
    reached.insert(moved.changed_springs[0].spring);
    EXPECT_EQ(moved.changed_springs[0].spring % 8, 3u) << "of muscle, with the factor 4";
    Edits exchange = joining({.stiffness_factor = 0.7});
    exchange.remove_spring(3);
    const Edits removed = ring.moved(exchange, seed);
    EXPECT_EQ(removed.removed_springs.at(0).index % 8, 3u);
    EXPECT_EQ(removed.new_springs.at(0).stiffness_factor, 0.7);
  }
  EXPECT_EQ(reached.size(), 10u);
}

TEST(RandomPlaces, AScalingHappensAsItIs) {
  Edits edits(40, 80);
  edits.scale_lengths({.number = 3, .from = 1, .to = 2, .whole = 5});
  const Edits moved = Ring().moved(edits, 1);
  ASSERT_TRUE(only_scales(moved));
  const Scaling& scaling = *moved.scaling;
  EXPECT_EQ(std::tuple(scaling.number, scaling.from, scaling.to, scaling.whole), std::tuple(3u, 1, 2, 5));
  EXPECT_FALSE(Ring().moved(some_of_everything(), 1).scaling.has_value());
}

TEST(RandomPlaces, FewerComeWhereThereIsNoRoom) {
  Ring ring;
  ring.living.body.masses.resize(3);
  ring.living.body.springs = {{0, 1, 1, 0}, {1, 2, 1, 0}};
  ring.living.stress = {1, 2};
  Edits twice(ring.living.body);
  for (int i = 0; i < 2; ++i) twice.join(0, 2, bone);
  EXPECT_EQ(ring.moved(twice, 1).new_springs.size(), 1u);
  EXPECT_TRUE(ring.moved(Edits{}, 1).empty());
}

// controls of an experiment ------------------------------------------------------------------------------------------

/// The contexts that an operator saw during a life.
struct Seen {
  std::vector<std::vector<double>> stress, peak_force;
  std::vector<std::pair<int, int>> applications;
  std::vector<int> cycles;
};

/// An operator that records its contexts and changes nothing.
std::unique_ptr<Devo> watcher(Seen& seen, RecordRequest request = {.stress = true}) {
  return std::make_unique<Told>(request, [&seen, request](const DevoContext& context, Edits&) {
    if (request.stress) seen.stress.emplace_back(context.stress.begin(), context.stress.end());
    if (request.peak_force) seen.peak_force.emplace_back(context.peak_force.begin(), context.peak_force.end());
    seen.applications.emplace_back(context.application, context.applications);
    seen.cycles.push_back(context.cycle);
  });
}

Life matured(const Experiment& experiment, std::uint32_t id = 0) {
  static const Genome genome = {1, 2};
  const Newborn newborn{id, 0, &genome};
  return testing::Developed(experiment, {&newborn, 1}, 1).lives.front();
}

Experiment with_control(const std::string& control, const std::string& draws = "inherited") {
  return testing::small({"development.control=" + control, "development.draws=" + draws});
}

Seen watch(Experiment experiment) {
  Seen seen;
  experiment.devo.at(0).op = watcher(seen);
  EXPECT_EQ(matured(experiment).result.status, Status::ok);
  return seen;
}

TEST(Control, NoChangeTakesTheSameTimeAndSprings) {
  Seen seen;
  Experiment experiment = with_control("no-change");
  experiment.devo[0].op = watcher(seen);
  const Life still = matured(experiment), developed = matured(with_control("off"));
  EXPECT_TRUE(seen.stress.empty());
  EXPECT_EQ(still.living.state.time, developed.living.state.time);
  EXPECT_NEAR(still.living.state.time, 0.1, 1e-12);
  EXPECT_EQ(still.result.spring_evaluations, 50u * 200) << "springs times steps";
  EXPECT_EQ(developed.result.spring_evaluations, 50u * 200);
  EXPECT_TRUE(still.record.empty());
  EXPECT_NE(still.living.state.position, developed.living.state.position);
}

TEST(Control, ShuffledStressIsTheSameInAnotherOrderWithAllThatIsKnownOfASpringTogether) {
  const auto pairs_of = [](const char* control, const char* draws, std::uint32_t id = 0) {
    Seen seen;
    Experiment experiment = with_control(control, draws);
    experiment.devo[0].op = watcher(seen, {.stress = true, .peak_force = true});
    matured(experiment, id);
    std::vector<std::vector<std::pair<double, double>>> cycles(seen.stress.size());
    for (std::size_t cycle = 0; cycle < cycles.size(); ++cycle)
      for (std::size_t s = 0; s < seen.stress[cycle].size(); ++s)
        cycles[cycle].emplace_back(seen.stress[cycle][s], seen.peak_force.at(cycle).at(s));
    return cycles;
  };
  for (const char* draws : {"inherited", "individual"}) {
    SCOPED_TRACE(draws);
    const auto off = pairs_of("off", draws), shuffled = pairs_of("shuffled-stress", draws);
    ASSERT_EQ(off.size(), 2u);
    ASSERT_EQ(shuffled.size(), 2u);
    for (std::size_t cycle = 0; cycle < 2; ++cycle) {
      EXPECT_EQ(off[cycle].size(), 50u);
      std::size_t stay = 0;
      for (std::size_t s = 0; s < off[cycle].size(); ++s) stay += shuffled[cycle][s] == off[cycle][s];
      EXPECT_LT(stay, 6u);
      EXPECT_THAT(shuffled[cycle], ::testing::UnorderedElementsAreArray(off[cycle]));
    }
    EXPECT_EQ(pairs_of("shuffled-stress", draws), shuffled) << "the same when lived again";
    EXPECT_EQ(pairs_of("shuffled-stress", draws, 1) == shuffled, draws == std::string("inherited"))
        << "another individual";
  }
}

TEST(Development, OperatorsSeeWhatTheyAskForAlone) {
  Seen nothing, peak;
  Experiment experiment = with_control("off");
  experiment.devo.clear();
  experiment.devo.push_back({watcher(nothing, {}), "nothing", {}});
  experiment.devo.push_back({watcher(peak, {.peak_force = true}), "peak", {.from = 2}});
  EXPECT_FALSE(recording(cycle_request(experiment, 1)).of_springs()) << "the second comes later";
  EXPECT_TRUE(recording(cycle_request(experiment, 2)).peak_force);
  EXPECT_FALSE(recording(cycle_request(experiment, 2)).stress);
  matured(experiment);
  EXPECT_THAT(nothing.cycles, ElementsAre(1, 2));
  ASSERT_EQ(peak.peak_force.size(), 1u);
  EXPECT_EQ(peak.peak_force[0].size(), 50u);
}

TEST(Control, OperatorsSeeTheLifeBeforeAloneAndItsCostDoesNotCount) {
  Seen seen;
  Experiment experiment = with_control("random-places");
  experiment.devo[0].op = watcher(seen);
  const Life life = matured(experiment);
  EXPECT_THAT(seen.cycles, ElementsAre(1, 2));
  EXPECT_EQ(seen.stress, watch(with_control("off")).stress);
  EXPECT_EQ(life.result.spring_evaluations, 50u * 200);
  EXPECT_NEAR(life.living.state.time, 0.1, 1e-12);
}

/// In each cycle, how many springs were removed and added, and how many masses.
std::map<std::uint32_t, std::array<std::size_t, 4>> totals(LivingBody living, const LifeRecord& record) {
  const Body& body = living.body;
  std::map<std::uint32_t, std::array<std::size_t, 4>> totals;
  for (const Change& change : record.changes()) {
    const std::size_t springs = body.springs.size(), come = change.edits.new_springs.size();
    apply(change.edits, living, change.op);
    if (!change.op) continue;
    const std::size_t counts[] = {springs + come - body.springs.size(), come, change.edits.removed_masses.size(),
                                  change.edits.new_masses.size()};
    for (std::size_t i = 0; i < 4; ++i) totals[change.cycle][i] += counts[i];
  }
  return totals;
}

/// An experiment with random robots large enough for the paper's two operators.
Experiment large(const std::string& control) {
  return testing::read(
      testing::small_with({{"\"voxel\"\nsize = [2, 1, 1]\nedge = 0.5", "'neural'\npoints = 100\nneighbours = 12"},
                           {"springs = 2",
                            "springs = 60\n[[development.operator]]\nname = 'mass-turnover'\nthreshold = 14\n"
                            "limit = 2\nsprings = 12"}}),
      testing::overrides({"development.control=" + control, "development.cycles=4"}));
}

TEST(Control, RandomPlacesChangeAsMuchInEachCycleAsTheOperatorsDo) {
  const testing::Developed developed(large("off"), 8), moved(large("random-places"), 8);
  std::size_t springs_gone = 0, masses_gone = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    const Life &one = developed.lives[i], &other = moved.lives[i];
    if (!one.alive() || !other.alive()) continue;
    SCOPED_TRACE(i);
    const auto expected = totals(developed.born[i], one.record);
    EXPECT_EQ(totals(moved.born[i], other.record), expected);
    EXPECT_FALSE(other.record == one.record);
    for (const auto& [cycle, counts] : expected) {
      springs_gone += counts[0];
      masses_gone += counts[2];
    }
  }
  EXPECT_GT(springs_gone, 100u) << "there must be something to compare";
  EXPECT_GT(masses_gone, 20u);
}

TEST(Control, YokedLivesDoNotDependOnThreadsOrCompany) {
  const Experiment experiment = large("random-places");
  testing::expect_independent_lives(experiment, breed(experiment, {}, 0, 0, 8));
}

TEST(Control, NothingMoreChangesAfterTheYokesEnd) {
  /// A simulator in whose second run a body diverges. That run simulates the second cycle of the life that serves as
  /// yoke.
  class Breaking final : public testing::AlteredSimulator {
   public:
    using AlteredSimulator::AlteredSimulator;
    void run(std::span<Task> tasks, Recording recording) override {
      AlteredSimulator::run(tasks, recording);
      if (++runs_ == 2) tasks.front().status = Status::diverged;
    }

   private:
    int runs_ = 0;
  };
  Experiment experiment = with_control("random-places");
  experiment.devo[0].op =
      std::make_unique<Told>(RecordRequest{}, [](const DevoContext&, Edits& edits) { edits.remove_spring(4); });
  experiment.development.cycles = 3;
  Breaking simulator(experiment);
  const Genome genome{1, 2};
  const Evaluation evaluation(experiment, simulator);
  std::vector<Life> lives = evaluation.birth.of(std::vector<Newborn>{{0, 0, &genome}});
  evaluation.development.run(lives, testing::unwatched);
  EXPECT_EQ(lives[0].result.status, Status::ok);
  EXPECT_EQ(lives[0].living.body.springs.size(), 49u);
  ASSERT_EQ(lives[0].record.changes().size(), 1u);
  EXPECT_EQ(lives[0].record.changes()[0].cycle, 1u);
}

// schedules ----------------------------------------------------------------------------------------------------------

TEST(Schedule, EarlyLateOnceAndNowAndThenAndOperatorsKnowTheirTurns) {
  const struct {
    std::string schedule;
    std::vector<int> cycles;
  } cases[] = {{"", {1, 2, 3, 4, 5, 6, 7, 8}}, {"to = 3", {1, 2, 3}},    {"from = 7\nto = 100", {7, 8}},
               {"from = 5\nto = 5", {5}},      {"every = 3", {1, 4, 7}}, {"from = 2\nevery = 3\nto = 7", {2, 5}}};
  for (const auto& [schedule, cycles] : cases) {
    SCOPED_TRACE(schedule);
    const Seen seen =
        watch(testing::read(testing::small_with({{"cycles = 2\ncycle_time = 0.05", "cycles = 8\ncycle_time = 0.001"},
                                                 {"springs = 2", "springs = 2\n" + schedule}})));
    EXPECT_EQ(seen.cycles, cycles);
    const int turns = static_cast<int>(cycles.size());
    for (int turn = 1; turn <= turns; ++turn) EXPECT_EQ(seen.applications.at(turn - 1), std::pair(turn, turns));
  }
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
