// Controls of development, schedules of its operators, and bodies that development tears apart.
#include "life/controls.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/philox.hpp"
#include "evolution/breeding.hpp"
#include "life/evaluation.hpp"
#include "support/experiments.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

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
    return at_random_places(amount, context(), surplus, rng);
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
  return {
      .removed_springs = {0, 1, 2},
      .removed_masses = {7, 8},
      .changed_springs = {{.spring = 40, .rest_length = 1.0}, {.spring = 42, .material = Material{6000, 0.2, 1, 0}}},
      .new_masses = {{{5, 5, 5}, 0.3, 1}, {{6, 6, 6}, 0.4, 0}},
      .new_springs = {{40, 0, muscle, {}}, {41, 0, bone, 2.0}, {0, 20, muscle, {}}, {1, 20, muscle, {}}}};
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
    for (const Spring& spring : ring.after(ring.moved({.removed_springs = {0, 1, 2, 4}}, seed)).springs)
      ++count.at(spring.material);
    EXPECT_EQ(count, (std::vector{37, 39})) << "three of bone go, and one of muscle";
    for (const std::uint32_t mass : ring.moved({.removed_masses = {0, 2, 4}}, seed).removed_masses)
      EXPECT_EQ(mass % 2, 0u);
  }
}

TEST(RandomPlaces, AnyMaterialGoesWhereNoneOfItsOwnIsLeft) {
  const Ring ring;
  std::size_t surplus = 0;
  const Edits moved = ring.moved({.springs_gone = Kinds(41, {muscle})}, 1, surplus);
  ASSERT_EQ(moved.removed_springs.size(), 41u);
  const auto is_muscle = [&](std::uint32_t s) { return ring.living.body.springs[s].material == 1; };
  EXPECT_EQ(std::count_if(moved.removed_springs.begin(), moved.removed_springs.end(), is_muscle), 40);
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
    const Edits springs = ring.moved({.removed_springs = {0, 1, 2, 3}}, seed);
    for (const std::uint32_t s : springs.removed_springs) ++gone_springs[s];
    const Edits masses = ring.moved({.removed_masses = {0, 1}, .new_masses = {{{}, 0.2, 0}}}, seed);
    for (const std::uint32_t m : masses.removed_masses) ++gone_masses[m];
    height += masses.new_masses[0].position.z / rounds;
    for (const NewSpring& spring : ring.moved({.new_springs = {{0, 20, bone, {}}}}, seed).new_springs) {
      ++joined[spring.a];
      ++joined[spring.b];
    }
  }
  for (const int count : gone_springs) EXPECT_NEAR(count, 100, 50);  // five standard deviations
  for (const int count : gone_masses) EXPECT_NEAR(count, 100, 50);
  for (const int count : joined) EXPECT_NEAR(count, 100, 50);
  EXPECT_NEAR(height, 0.5, 0.04);
}

TEST(RandomPlaces, SpringsOfTheSameMaterialChangeByTheSameFactors) {
  const Ring ring;
  std::set<std::uint32_t> reached;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const Spring& before = ring.living.body.springs[3];
    ASSERT_EQ(before.material, 1u);
    const Material stronger{5000, 0.2, 1, 0};
    const Edits moved = ring.moved(
        {.changed_springs = {{.spring = 3, .rest_length = 0.9 * before.rest_length, .material = stronger}}}, seed);
    ASSERT_EQ(moved.changed_springs.size(), 1u);
    const ChangedSpring& change = moved.changed_springs[0];
    const Spring& other = ring.living.body.springs[change.spring];
    EXPECT_EQ(other.material, 1u);
    EXPECT_EQ(change.material, stronger);
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
    const Edits moved = ring.moved({.changed_springs = {{.spring = 3, .stiffness_factor = 6}}}, seed);
    ASSERT_EQ(moved.changed_springs.size(), 1u);
    EXPECT_EQ(moved.changed_springs[0].stiffness_factor, 6);
    EXPECT_FALSE(moved.changed_springs[0].material);
    reached.insert(moved.changed_springs[0].spring);
    EXPECT_EQ(moved.changed_springs[0].spring % 8, 3u) << "of muscle, with the factor 4";
    const Edits removed = ring.moved({.removed_springs = {3}, .new_springs = {{0, 20, bone, {}, 0.7}}}, seed);
    EXPECT_EQ(removed.removed_springs.at(0) % 8, 3u);
    EXPECT_EQ(removed.new_springs.at(0).stiffness_factor, 0.7);
  }
  EXPECT_EQ(reached.size(), 10u);
}

TEST(RandomPlaces, GrowthHappensAsItIs) {
  const Ring ring;
  const Edits moved = ring.moved({.growth = Growth{1, 2, 5}}, 1);
  ASSERT_TRUE(moved.growth.has_value());
  EXPECT_EQ(std::tuple(moved.growth->from, moved.growth->to, moved.growth->whole), std::tuple(1, 2, 5));
  EXPECT_TRUE(moved.changed_springs.empty());
  EXPECT_FALSE(ring.moved(some_of_everything(), 1).growth.has_value());
}

TEST(RandomPlaces, FewerComeWhereThereIsNoRoom) {
  Ring ring;
  ring.living.body.masses.resize(3);
  ring.living.body.springs = {{0, 1, 1, 0}, {1, 2, 1, 0}};
  ring.living.stress = {1, 2};
  const Edits moved = ring.moved({.new_springs = {{0, 2, bone, {}}, {0, 2, bone, {}}}}, 1);
  EXPECT_EQ(moved.new_springs.size(), 1u);
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
class Watcher final : public Devo {
 public:
  explicit Watcher(Seen& seen, RecordRequest request = {.stress = true}) : seen_(seen), request_(request) {}
  RecordRequest observes() const override { return request_; }
  void develop(const DevoContext& context, Edits&, Rng&) const override {
    if (request_.stress) seen_.stress.emplace_back(context.stress.begin(), context.stress.end());
    if (request_.peak_force) seen_.peak_force.emplace_back(context.peak_force.begin(), context.peak_force.end());
    seen_.applications.emplace_back(context.application, context.applications);
    seen_.cycles.push_back(context.cycle);
  }

 private:
  Seen& seen_;
  RecordRequest request_;
};

/// An operator whose edits do not depend on the body.
class Fixed final : public Devo {
 public:
  explicit Fixed(Edits edits) : edits_(std::move(edits)) {}
  void develop(const DevoContext&, Edits& edits, Rng&) const override { edits = edits_; }

 private:
  Edits edits_;
};

Life matured(const Experiment& experiment, Simulator& simulator, std::uint32_t id = 0) {
  static const Genome genome = {1, 2};
  const Newborn newborn{id, 0, &genome};
  const Evaluation evaluation(experiment, simulator);
  std::vector<Life> lives = evaluation.birth.of({&newborn, 1});
  evaluation.development.run(lives, [](double) {});
  return std::move(lives.front());
}

Life matured(const Experiment& experiment, std::uint32_t id = 0) {
  return matured(experiment, *make_cpu_simulator(experiment.scene, experiment.stepping, 1), id);
}

Experiment with_control(const char* control) {
  return testing::read(testing::small_experiment, {{"development.control", control, "--set"}});
}

Seen watch(Experiment experiment, std::uint32_t id = 0) {
  Seen seen;
  for (Scheduled& scheduled : experiment.devo) scheduled.op = std::make_unique<Watcher>(seen);
  EXPECT_EQ(matured(experiment, id).result.status, Status::ok);
  return seen;
}

TEST(Control, NoChangeTakesTheSameTimeAndSprings) {
  Seen seen;
  Experiment experiment = with_control("no-change");
  experiment.devo[0].op = std::make_unique<Watcher>(seen);
  const Life still = matured(experiment), developed = matured(with_control("off"));
  EXPECT_TRUE(seen.stress.empty());
  EXPECT_EQ(still.living.state.time, developed.living.state.time);
  EXPECT_NEAR(still.living.state.time, 0.1, 1e-12);
  ASSERT_EQ(still.living.body.springs.size(), developed.living.body.springs.size());
  EXPECT_EQ(still.result.spring_evaluations, 50u * 200) << "springs times steps";
  EXPECT_EQ(developed.result.spring_evaluations, 50u * 200);
  EXPECT_TRUE(still.result.record.empty());
  EXPECT_NE(still.living.state.position, developed.living.state.position);
}

TEST(Control, ShuffledStressIsTheSameStressInAnotherOrder) {
  const Seen off = watch(with_control("off")), shuffled = watch(with_control("shuffled-stress"));
  ASSERT_EQ(off.stress.size(), 2u);
  ASSERT_EQ(shuffled.stress.size(), 2u);
  for (std::size_t cycle = 0; cycle < 2; ++cycle) {
    EXPECT_NE(shuffled.stress[cycle], off.stress[cycle]);
    EXPECT_THAT(shuffled.stress[cycle], ::testing::UnorderedElementsAreArray(off.stress[cycle]));
  }
  EXPECT_EQ(watch(with_control("shuffled-stress")).stress, shuffled.stress) << "the same when lived again";
  EXPECT_NE(watch(with_control("shuffled-stress"), 1).stress, shuffled.stress) << "but not for another individual";
}

TEST(Control, ShufflesAllThatIsKnownOfASpringTogether) {
  const auto pairs_of = [](const char* control) {
    Seen seen;
    Experiment experiment = with_control(control);
    for (Scheduled& scheduled : experiment.devo)
      scheduled.op = std::make_unique<Watcher>(seen, RecordRequest{.stress = true, .peak_force = true});
    matured(experiment);
    std::vector<std::pair<double, double>> pairs;
    for (std::size_t s = 0; s < seen.stress.at(0).size(); ++s)
      pairs.emplace_back(seen.stress[0][s], seen.peak_force.at(0).at(s));
    return pairs;
  };
  const auto off = pairs_of("off"), shuffled = pairs_of("shuffled-stress");
  ASSERT_EQ(off.size(), 50u);
  EXPECT_NE(shuffled, off);
  EXPECT_THAT(shuffled, ::testing::UnorderedElementsAreArray(off));
}

TEST(Development, OperatorsSeeWhatTheyAskForAlone) {
  Seen nothing, peak;
  Experiment experiment = with_control("off");
  auto& operators = experiment.devo;
  operators.clear();
  operators.push_back({std::make_unique<Watcher>(nothing, RecordRequest{}), {}});
  operators.push_back({std::make_unique<Watcher>(peak, RecordRequest{.peak_force = true}), {.from = 2}});
  EXPECT_FALSE(recording(cycle_request(experiment, 1)).of_springs()) << "the second comes later";
  EXPECT_TRUE(recording(cycle_request(experiment, 2)).peak_force);
  EXPECT_FALSE(recording(cycle_request(experiment, 2)).stress);
  matured(experiment);
  EXPECT_EQ(nothing.cycles, (std::vector<int>{1, 2}));
  ASSERT_EQ(peak.peak_force.size(), 1u);
  EXPECT_EQ(peak.peak_force[0].size(), 50u);
}

TEST(Control, RandomPlacesMoveWhatOperatorsWant) {
  Experiment experiment = with_control("random-places");
  const Edits edits{.removed_springs = {4}};
  experiment.devo[0].op = std::make_unique<Fixed>(edits);
  experiment.development.cycles = 1;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> gone;
  const auto pairs_of = [](const Body& body) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const Spring& spring : body.springs) pairs.insert(std::minmax(spring.a, spring.b));
    return pairs;
  };
  Experiment undeveloped = with_control("no-change");
  const auto all = pairs_of(matured(undeveloped).living.body);
  ASSERT_EQ(all.size(), 50u);
  for (std::uint32_t id = 0; id < 40; ++id) {
    const auto left = pairs_of(matured(experiment, id).living.body);
    ASSERT_EQ(left.size(), 49u);
    for (const auto& pair : all)
      if (!left.contains(pair)) ++gone[pair];
  }
  EXPECT_GT(gone.size(), 15u) << "40 draws out of 50";
}

TEST(Control, OperatorsSeeTheLifeBeforeAloneAndItsCostDoesNotCount) {
  Seen seen;
  Experiment experiment = with_control("random-places");
  experiment.devo[0].op = std::make_unique<Watcher>(seen);
  const Life life = matured(experiment);
  EXPECT_THAT(seen.cycles, ::testing::ElementsAre(1, 2));
  EXPECT_EQ(seen.stress, watch(with_control("off")).stress);
  EXPECT_EQ(life.result.spring_evaluations, 50u * 200);
  EXPECT_NEAR(life.living.state.time, 0.1, 1e-12);
}

/// Numbers of springs and masses that were removed and added in a cycle.
struct Total {
  std::size_t springs_gone = 0, springs_come = 0, masses_gone = 0, masses_come = 0;
  friend bool operator==(const Total&, const Total&) = default;
  friend void PrintTo(const Total& total, std::ostream* out) {
    *out << "springs -" << total.springs_gone << " +" << total.springs_come << ", masses -" << total.masses_gone << " +"
         << total.masses_come;
  }
};

std::map<std::uint32_t, Total> totals(Body body, const LifeRecord& record) {
  std::map<std::uint32_t, Total> totals;
  for (const Change& change : record.changes()) {
    const std::size_t springs = body.springs.size();
    apply(change.edits, body);
    if (!change.op) continue;
    Total& total = totals[change.cycle];
    total.springs_gone += springs + change.edits.new_springs.size() - body.springs.size();
    total.springs_come += change.edits.new_springs.size();
    total.masses_gone += change.edits.removed_masses.size();
    total.masses_come += change.edits.new_masses.size();
  }
  return totals;
}

/// Random robots large enough for the paper's two operators.
struct Population {
  Experiment experiment;
  std::vector<Individual> individuals;
  std::vector<Newborn> newborns;
  std::vector<Body> born;

  explicit Population(const std::string& control)
      : experiment(testing::read(text(), {{"development.control", control, "--set"}})),
        individuals(breed(experiment, {}, 0, 0, 8)) {
    for (const Individual& individual : individuals)
      newborns.push_back({individual.id, individual.born, &individual.genome});
  }

  static std::string text() {
    std::string text = testing::small_experiment;
    const auto replace = [&](const std::string& from, const std::string& to, const std::string& by) {
      const std::size_t begin = text.find(from);
      text.replace(begin, text.find(to) - begin, by);
    };
    replace("[encoding]", "[[mutation]]", "[encoding]\nname = 'neural'\npoints = 100\nneighbours = 12\n");
    replace("[[development.operator]]", "[[fitness]]",
            "[[development.operator]]\nname = 'spring-turnover'\nsprings = 60\n"
            "[[development.operator]]\nname = 'mass-turnover'\nthreshold = 14\nlimit = 2\nsprings = 12\n");
    replace("cycles = 2", "cycle_time", "cycles = 4\n");
    return text;
  }

  std::vector<Life> matured() {
    const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
    const Evaluation evaluation(experiment, *simulator);
    std::vector<Life> lives = evaluation.birth.of(newborns);
    for (const Life& life : lives) born.push_back(life.living.body);
    evaluation.development.run(lives, [](double) {});
    return lives;
  }
};

TEST(Control, RandomPlacesChangeAsMuchInEachCycleAsTheOperatorsDo) {
  Population off("off"), random("random-places");
  const std::vector<Life> developed = off.matured(), moved = random.matured();
  Total all;
  for (std::size_t i = 0; i < developed.size(); ++i) {
    if (!developed[i].alive() || !moved[i].alive()) continue;
    SCOPED_TRACE(i);
    const auto expected = totals(off.born[i], developed[i].result.record);
    EXPECT_EQ(totals(random.born[i], moved[i].result.record), expected);
    EXPECT_FALSE(moved[i].result.record == developed[i].result.record);
    for (const auto& [cycle, total] : expected) {
      all.springs_gone += total.springs_gone;
      all.masses_gone += total.masses_gone;
    }
  }
  EXPECT_GT(all.springs_gone, 100u) << "there must be something to compare";
  EXPECT_GT(all.masses_gone, 20u);
}

TEST(Control, YokedLivesDoNotDependOnThreadsOrCompany) {
  const Population population("random-places");
  const Experiment& experiment = population.experiment;
  const auto one = make_cpu_simulator(experiment.scene, experiment.stepping, 1),
             three = make_cpu_simulator(experiment.scene, experiment.stepping, 3);
  const auto unwatched = [](double) {};
  const std::vector<Result> together = Evaluation(experiment, *three).evaluate(population.newborns, unwatched);
  for (std::size_t i = 0; i < together.size(); ++i) {
    const Result alone =
        Evaluation(experiment, *one).evaluate(std::span(population.newborns).subspan(i, 1), unwatched).front();
    EXPECT_EQ(alone.status, together[i].status);
    EXPECT_EQ(alone.objectives, together[i].objectives);
    EXPECT_TRUE(alone.record == together[i].record);
  }
}

TEST(Control, NothingMoreChangesAfterTheYokesEnd) {
  /// A simulator in whose second run a body diverges. That run simulates the second cycle of the life that serves as
  /// yoke.
  class Breaking final : public Simulator {
   public:
    explicit Breaking(std::unique_ptr<Simulator> simulator) : simulator_(std::move(simulator)) {}
    void run(std::span<Task> tasks, Recording recording) override {
      simulator_->run(tasks, recording);
      if (++runs_ == 2) tasks.front().status = Status::diverged;
    }
    NeighbourSearch& neighbours() override { return simulator_->neighbours(); }
    Workers& workers() override { return simulator_->workers(); }
    std::string device() const override { return simulator_->device(); }

   private:
    std::unique_ptr<Simulator> simulator_;
    int runs_ = 0;
  };
  Experiment experiment = with_control("random-places");
  experiment.devo[0].op = std::make_unique<Fixed>(Edits{.removed_springs = {4}});
  experiment.development.cycles = 3;
  Breaking simulator(make_cpu_simulator(experiment.scene, experiment.stepping, 1));
  const Life life = matured(experiment, simulator);
  EXPECT_EQ(life.result.status, Status::ok);
  EXPECT_EQ(life.living.body.springs.size(), 49u);
  ASSERT_EQ(life.result.record.changes().size(), 1u);
  EXPECT_EQ(life.result.record.changes()[0].cycle, 1u);
}

// schedules ----------------------------------------------------------------------------------------------------------

/// Returns what an operator with this schedule saw in a life of eight cycles.
Seen scheduled(std::vector<Override> overrides) {
  overrides.insert(overrides.begin(), {{"development.cycles", "8", "--set"}, {"development.cycle_time", "0.001", ""}});
  return watch(testing::read(testing::small_experiment, std::move(overrides)));
}

TEST(Schedule, EarlyLateOnceAndNowAndThen) {
  using ::testing::ElementsAre;
  const std::string key = "development.operator.0.";
  EXPECT_THAT(scheduled({}).cycles, ElementsAre(1, 2, 3, 4, 5, 6, 7, 8));
  EXPECT_THAT(scheduled({{key + "to", "3", ""}}).cycles, ElementsAre(1, 2, 3));
  EXPECT_THAT(scheduled({{key + "from", "7", ""}}).cycles, ElementsAre(7, 8));
  EXPECT_THAT(scheduled({{key + "from", "5", ""}, {key + "to", "5", ""}}).cycles, ElementsAre(5));
  EXPECT_THAT(scheduled({{key + "every", "3", ""}}).cycles, ElementsAre(1, 4, 7));
  EXPECT_THAT(scheduled({{key + "from", "2", ""}, {key + "every", "3", ""}, {key + "to", "7", ""}}).cycles,
              ElementsAre(2, 5));
}

TEST(Schedule, OperatorsKnowTheirTurns) {
  const std::string key = "development.operator.0.";
  using Turns = std::vector<std::pair<int, int>>;
  EXPECT_EQ(scheduled({{key + "every", "3", ""}}).applications, (Turns{{1, 3}, {2, 3}, {3, 3}}));
  EXPECT_EQ(scheduled({{key + "from", "7", ""}, {key + "to", "100", ""}}).applications, (Turns{{1, 2}, {2, 2}}));
}

// torn bodies --------------------------------------------------------------------------------------------------------

TEST(Development, TheLargestPieceGoesOn) {
  Experiment experiment = with_control("off");
  // removes all springs of a corner mass, which tears off the mass
  const Body newborn = matured(with_control("no-change")).living.body;
  Edits edits;
  for (std::uint32_t s = 0; s < newborn.springs.size(); ++s)
    if (newborn.springs[s].a == 0 || newborn.springs[s].b == 0) edits.removed_springs.push_back(s);
  ASSERT_EQ(edits.removed_springs.size(), 7u);
  experiment.devo[0].op = std::make_unique<Fixed>(edits);
  experiment.development.cycles = 1;
  const Life life = matured(experiment);
  EXPECT_EQ(life.result.status, Status::ok);
  EXPECT_EQ(life.living.body.masses.size(), newborn.masses.size() - 1);
  EXPECT_EQ(life.living.state.position.size(), newborn.masses.size() - 1);
  EXPECT_EQ(life.living.body.springs.size(), newborn.springs.size() - 7);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
