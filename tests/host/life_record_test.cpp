// Records of lives: edits that are written can be read again, re-simulation gives a bit-identical matured body, and
// runs keep the records of individuals on the front.
#include "life/life_record.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <stdexcept>

#include "evolution/breeding.hpp"
#include "evolution/evolution.hpp"
#include "evolution/resimulation.hpp"
#include "support/elsewhere.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

/// An experiment with as many operators as possible, on bodies of some dozens of masses.
Experiment all_operators(bool reset) {
  std::string text = testing::small_experiment;
  const std::string operators = R"(
[[development.operator]]
name = "mass-turnover"
threshold = 100
limit = 2
springs = 4
[[development.operator]]
name = "mass-growth"
masses = 1
springs = 5
where = "by-stress"
join = "nearest"
[[development.operator]]
name = "length-adaptation"
springs = 3
[[development.operator]]
name = "stiffness-adaptation"
springs = 3
[[development.operator]]
name = "amplitude-adaptation"
springs = 3
[[development.operator]]
name = "ballistic-growth"
)";
  text.insert(text.find("[[fitness]]"), operators);
  return testing::read(text, {{"encoding.size", "[3, 2, 2]", ""},
                              {"scene.payload.share", "0.5", ""},
                              {"encoding.size_range", "0.2", ""},
                              {"development.cycles", "4", ""},
                              {"development.reset", reset ? "true" : "false", ""}});
}

struct Lived {
  Body born;
  Life life;
};

std::vector<Lived> matured(const Experiment& experiment, std::size_t count) {
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
  const std::vector<Individual> individuals = breed(experiment, {}, 0, 0, count);
  std::vector<Newborn> newborns;
  for (const Individual& individual : individuals) newborns.push_back({individual.id, 0, &individual.genome});
  const Evaluation evaluation(experiment, *simulator);
  std::vector<Life> lives = evaluation.birth.of(newborns);
  std::vector<Lived> lived;
  for (const Life& life : lives) lived.push_back({life.living.body, {}});
  evaluation.development.run(lives, [](double) {});
  for (std::size_t i = 0; i < count; ++i) lived[i].life = std::move(lives[i]);
  return lived;
}

void expect_same(const Body& a, const Body& b) {
  EXPECT_EQ(a.materials, b.materials);
  ASSERT_EQ(a.masses.size(), b.masses.size());
  for (std::size_t i = 0; i < a.masses.size(); ++i) {
    const Mass &m = a.masses[i], &n = b.masses[i];
    ASSERT_EQ(std::tie(m.rest, m.mass, m.material, m.air_contacts, m.payload),
              std::tie(n.rest, n.mass, n.material, n.air_contacts, n.payload))
        << "mass " << i;
  }
  ASSERT_EQ(a.springs.size(), b.springs.size());
  for (std::size_t i = 0; i < a.springs.size(); ++i) {
    const Spring &s = a.springs[i], &t = b.springs[i];
    ASSERT_EQ(std::tie(s.a, s.b, s.rest_length, s.material, s.growth, s.first_length, s.stiffness_factor),
              std::tie(t.a, t.b, t.rest_length, t.material, t.growth, t.first_length, t.stiffness_factor))
        << "spring " << i;
  }
}

TEST(LifeRecord, ReplayedFromTheBodyAtBirthGivesTheMaturedOneToTheBit) {
  for (const bool reset : {false, true}) {
    const Experiment experiment = all_operators(reset);
    std::size_t alive = 0, removed_masses = 0, new_masses = 0, changed = 0, new_springs = 0, growth = 0;
    for (const Lived& lived : matured(experiment, 6)) {
      if (!lived.life.alive()) continue;
      ++alive;
      Body body = lived.born;
      for (const Change& change : LifeRecord(lived.life.result.record.bytes()).changes()) {
        apply(change.edits, body);
        removed_masses += change.edits.removed_masses.size();
        new_masses += change.edits.new_masses.size();
        changed += change.edits.changed_springs.size();
        new_springs += change.edits.new_springs.size();
        growth += change.edits.growth.has_value();
      }
      expect_same(body, lived.life.living.body);
    }
    EXPECT_GE(alive, 3u);
    EXPECT_GT(std::min({removed_masses, new_masses, changed, new_springs, growth}), 10u)
        << "there must be something to replay";
  }
}

Change change_of_all_kinds() {
  Change change;
  change.cycle = 300;
  change.op = 2;
  change.lengths_given = true;
  change.edits.growth = {0.1, 2, 3};
  change.edits.removed_masses = {0, 7, 100'000};
  change.edits.removed_springs = {3, 4, 70'000};
  change.edits.causes.removed_springs = {0, 1.5, 0x1p100};
  const Material one{5000, 0.14, 1, 0.1 + 0.2}, other{1, 0, 0, 0};
  change.edits.changed_springs = {{.spring = 9, .rest_length = 1e-300},
                                  {.spring = 8, .material = one},
                                  {.spring = 7, .material = one, .stiffness_factor = 0.1 + 0.2},
                                  {.spring = 6, .stiffness_factor = 1e300}};
  change.edits.causes.changed_springs = {2, -3, 4, 5};
  change.edits.new_masses = {{{-1, 0.1, 2}, 0.2, no_material}, {{0, 0, 0}, 0.3, 4}};
  change.edits.new_springs = {{1, 200, one, 0.1}, {2, 0xfffffffe, other, 0.0}, {5, 6, other, 7.0, 0.1 + 0.2}};
  return change;
}

void expect_same(const Change& a, const Change& b) {
  EXPECT_EQ(a.cycle, b.cycle);
  EXPECT_EQ(a.op, b.op);
  EXPECT_EQ(a.lengths_given, b.lengths_given);
  const auto growth_of = [](const Change& change) {
    const Growth growth = change.edits.growth.value_or(Growth{-1});
    return std::tuple(growth.from, growth.to, growth.whole);
  };
  EXPECT_EQ(growth_of(a), growth_of(b));
  EXPECT_EQ(a.edits.removed_masses, b.edits.removed_masses);
  EXPECT_EQ(a.edits.removed_springs, b.edits.removed_springs);
  EXPECT_EQ(a.edits.causes.removed_springs, b.edits.causes.removed_springs);
  EXPECT_EQ(a.edits.causes.removed_masses, b.edits.causes.removed_masses);
  EXPECT_EQ(a.edits.causes.changed_springs, b.edits.causes.changed_springs);
  EXPECT_EQ(a.edits.causes.new_masses, b.edits.causes.new_masses);
  EXPECT_EQ(a.edits.causes.new_springs, b.edits.causes.new_springs);
  ASSERT_EQ(a.edits.changed_springs.size(), b.edits.changed_springs.size());
  for (std::size_t i = 0; i < a.edits.changed_springs.size(); ++i) {
    const ChangedSpring &s = a.edits.changed_springs[i], &t = b.edits.changed_springs[i];
    EXPECT_EQ(std::tie(s.spring, s.rest_length, s.material, s.stiffness_factor),
              std::tie(t.spring, t.rest_length, t.material, t.stiffness_factor));
  }
  ASSERT_EQ(a.edits.new_masses.size(), b.edits.new_masses.size());
  for (std::size_t i = 0; i < a.edits.new_masses.size(); ++i) {
    const NewMass &m = a.edits.new_masses[i], &n = b.edits.new_masses[i];
    EXPECT_EQ(std::tie(m.position, m.mass, m.material), std::tie(n.position, n.mass, n.material));
  }
  ASSERT_EQ(a.edits.new_springs.size(), b.edits.new_springs.size());
  for (std::size_t i = 0; i < a.edits.new_springs.size(); ++i) {
    const NewSpring &s = a.edits.new_springs[i], &t = b.edits.new_springs[i];
    EXPECT_EQ(std::tie(s.a, s.b, s.material, s.rest_length, s.stiffness_factor),
              std::tie(t.a, t.b, t.material, t.rest_length, t.stiffness_factor));
  }
}

TEST(LifeRecord, GivesBackWhatItWasGiven) {
  const Change change = change_of_all_kinds();
  Change torn_off;
  torn_off.cycle = 301;
  torn_off.edits.removed_masses = {5};
  Change of_masses = torn_off;
  of_masses.op = 1;
  of_masses.edits.causes.removed_masses = {0.25};
  of_masses.edits.new_masses = {{{1, 2, 3}, 0.2, 1}};
  of_masses.edits.causes.new_masses = {7};
  of_masses.edits.new_springs = {{1, 2, {1, 0, 0, 0}, 0.5}};
  of_masses.edits.causes.new_springs = {8};
  LifeRecord record;
  EXPECT_TRUE(record.empty());
  for (const Change& each : {change, torn_off, change, of_masses}) record.add(each);
  const std::vector<Change> back = LifeRecord(record.bytes()).changes();
  ASSERT_EQ(back.size(), 4u);
  expect_same(back[0], change);
  expect_same(back[1], torn_off);
  expect_same(back[2], change);
  expect_same(back[3], of_masses);
}

TEST(LifeRecord, RefusesADamagedOne) {
  LifeRecord record;
  record.add(change_of_all_kinds());
  for (std::size_t length = 1; length < record.bytes().size(); ++length)
    EXPECT_THROW(LifeRecord(record.bytes().substr(0, length)), std::invalid_argument) << length;
  EXPECT_THROW(LifeRecord(std::string(20, '\xff')), std::invalid_argument);
}

TEST(LifeRecord, ASpringThatGoesAndOneThatComesTakeSome20Bytes) {
  const Experiment experiment =
      testing::read(testing::small_experiment, {{"encoding.size", "[4, 4, 4]", ""},
                                                {"development.cycles", "8", ""},
                                                {"development.operator.0.springs", "50", ""}});
  for (const Lived& lived : matured(experiment, 2)) {
    ASSERT_TRUE(lived.life.alive());
    EXPECT_LT(lived.life.result.record.bytes().size(), 8 * 50 * 22u + 1000) << "and a few materials";
  }
}

/// An experiment of voxel robots whose only development is ballistic growth, in each of `cycles` short cycles.
Experiment growing(int cycles) {
  std::string text = testing::small_experiment;
  const std::string turnover = "name = \"spring-turnover\"\nsprings = 2";
  text.replace(text.find(turnover), turnover.size(), "name = \"ballistic-growth\"");
  return testing::read(text, {{"encoding.size", "[4, 4, 4]", ""},
                              {"encoding.size_range", "0.25", ""},
                              {"development.cycles", std::to_string(cycles), ""},
                              {"development.cycle_time", "0.002", ""}});
}

TEST(LifeRecord, ATurnOfGrowthTakesSome30BytesHoweverManySpringsGrow) {
  for (const Lived& lived : matured(growing(100), 2)) {
    ASSERT_TRUE(lived.life.alive());
    ASSERT_GT(lived.born.springs.size(), 100u);
    const LifeRecord& record = lived.life.result.record;
    EXPECT_EQ(record.changes().size(), 100u);
    EXPECT_LE(record.bytes().size(), 100 * 34u);
    Body body = lived.born;
    for (const Change& change : record.changes()) apply(change.edits, body);
    expect_same(body, lived.life.living.body);
  }
}

TEST(LifeRecord, CausesStayWithTheirEdits) {
  Edits edits;
  edits.removed_springs = {7, 2, 7, 5};
  edits.causes.removed_springs = {70, 20, 71, 50};
  edits.removed_masses = {3, 1};
  const Lived lived = std::move(matured(testing::read(testing::small_experiment), 1).front());
  const LivingBody& living = lived.life.living;
  const Genome genome;
  const Layout layout;
  const DevoContext context{living.body, living.state, 4, 9, 1, 1, 0, {}, 0.2, false, genome, layout};
  const Change change = change_by(edits, 1, context);
  EXPECT_EQ(change.cycle, 4u);
  EXPECT_EQ(change.edits.removed_springs, (std::vector<std::uint32_t>{2, 5, 7}));
  EXPECT_EQ(change.edits.causes.removed_springs, (std::vector<double>{20, 50, 70}));
  EXPECT_EQ(change.edits.removed_masses, (std::vector<std::uint32_t>{1, 3}));
  EXPECT_TRUE(change.edits.causes.removed_masses.empty());
}

/// The number of causes named in the records of several lives.
std::size_t causes_named(const Experiment& experiment) {
  std::size_t count = 0;
  for (const Lived& lived : matured(experiment, 6))
    for (const Change& change : lived.life.result.record.changes()) {
      const Causes& causes = change.edits.causes;
      count += causes.removed_springs.size() + causes.removed_masses.size() + causes.changed_springs.size() +
               causes.new_masses.size() + causes.new_springs.size();
    }
  return count;
}

TEST(LifeRecord, WhatComesAboutAtRandomPlacesHasNoCause) {
  Experiment experiment = all_operators(false);
  EXPECT_GT(causes_named(experiment), 100u);
  experiment.development.control = Control::random_places;
  EXPECT_EQ(causes_named(experiment), 0u);
}

void expect_same_life(const Life& a, const Life& b) {
  expect_same(a.living.body, b.living.body);
  EXPECT_EQ(a.living.state.position, b.living.state.position);
  EXPECT_EQ(a.living.state.velocity, b.living.state.velocity);
  EXPECT_EQ(a.living.state.start_energy, b.living.state.start_energy) << "the guard is to allow the same, to the bit";
  EXPECT_EQ(a.result.record, b.result.record);
}

/// Re-simulates the last of several lives under `control` from its record, in an experiment in which development would
/// decide differently.
void expect_that_a_life_follows_its_record(Control control) {
  const auto experiment = [&] {
    Experiment all = all_operators(true);
    all.development.control = control;
    return all;
  };
  const Lived lived = std::move(matured(experiment(), 3).back());
  ASSERT_TRUE(lived.life.alive());
  Experiment other = experiment();
  other.seed += 1;  // development would draw other numbers
  const auto simulator = make_cpu_simulator(other.scene, other.stepping, 1);
  const Evaluation evaluation(other, *simulator);
  const Experiment first = all_operators(true);
  const Individual individual = breed(first, {}, 0, 0, 3).back();
  const Newborn newborn{individual.id, 0, &individual.genome, lived.life.result.record};
  std::vector<Life> lives = evaluation.birth.of({&newborn, 1});
  evaluation.development.run(lives, [](double) {});
  expect_same_life(lives.front(), lived.life);
}

TEST(LifeRecord, ALifeFollowsItsRecordWhateverTheOperatorsWouldDo) {
  expect_that_a_life_follows_its_record(Control::off);
}

TEST(LifeRecord, ALifeAtRandomPlacesFollowsItsRecordWhicheverOperatorComesFirst) {
  expect_that_a_life_follows_its_record(Control::random_places);
}

/// Replaces the first spring with a new one between the same masses. The rest length of the new spring is `stretch`
/// times that of the first one or, without `stretch`, such that the new spring starts without force.
class Exchange final : public Devo {
 public:
  explicit Exchange(std::optional<double> stretch) : stretch_(stretch) {}
  void develop(const DevoContext& context, Edits& edits, Rng&) const override {
    const Spring& spring = context.body.springs.front();
    NewSpring& other = edits.new_springs.emplace_back(
        NewSpring{spring.a, spring.b, context.body.materials[spring.material], std::nullopt});
    if (stretch_) other.rest_length = *stretch_ * spring.rest_length;
    edits.removed_springs = {0};
  }

 private:
  std::optional<double> stretch_;
};

TEST(LifeRecord, ALifeLivedAgainIsAllowedTheEnergyThatItHadThen) {
  Experiment experiment = testing::read(testing::small_experiment);
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
  const Individual individual = breed(experiment, {}, 0, 0, 1).front();
  const Evaluation evaluation(experiment, *simulator);
  const auto lived = [&](std::optional<LifeRecord> record) {
    const Newborn newborn{individual.id, 0, &individual.genome, std::move(record)};
    std::vector<Life> lives = evaluation.birth.of({&newborn, 1});
    evaluation.development.run(lives, [](double) {});
    return std::move(lives.front());
  };
  std::vector<double> energies;
  for (const std::optional<double> stretch : {std::optional<double>(), std::optional(1.5)}) {
    experiment.devo[0].op = std::make_unique<Exchange>(stretch);
    const Life life = lived(std::nullopt);
    ASSERT_TRUE(life.alive());
    expect_same_life(lived(LifeRecord(life.result.record.bytes())), life);
    energies.push_back(life.living.state.start_energy);
  }
  EXPECT_GT(energies[1], energies[0]) << "what an operator strains is allowed";
}

/// Simulates lives with and without a record in one batch. Development decides differently in this batch than in the
/// records.
void expect_that_each_life_goes_its_own_way(Control control) {
  Experiment experiment = all_operators(false);
  experiment.development.control = control;
  const std::vector<Lived> recorded = matured(experiment, 6);
  experiment.seed += 1;
  const std::vector<Individual> individuals = breed(all_operators(false), {}, 0, 0, 6);
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 2);
  const Evaluation evaluation(experiment, *simulator);
  const auto lived = [&](bool with_records) {
    std::vector<Newborn> newborns;
    for (const Individual& individual : individuals) {
      Newborn& newborn = newborns.emplace_back(Newborn{individual.id, 0, &individual.genome});
      if (with_records && individual.id % 2 == 1) newborn.record = recorded[individual.id].life.result.record;
    }
    std::vector<Life> lives = evaluation.birth.of(newborns);
    evaluation.development.run(lives, [](double) {});
    return lives;
  };
  const std::vector<Life> mixed = lived(true), free = lived(false);
  std::size_t alive = 0;
  for (std::size_t i = 0; i < individuals.size(); ++i) {
    SCOPED_TRACE(i);
    if (!recorded[i].life.alive() || !free[i].alive()) continue;
    ++alive;
    EXPECT_FALSE(free[i].result.record == recorded[i].life.result.record);
    expect_same_life(mixed[i], i % 2 == 1 ? recorded[i].life : free[i]);
  }
  EXPECT_GE(alive, 4u);
}

TEST(LifeRecord, LivesWithAndWithoutOneGoTheirOwnWaysTogether) { expect_that_each_life_goes_its_own_way(Control::off); }

TEST(LifeRecord, LivesAtRandomPlacesWithAndWithoutOneGoTheirOwnWaysTogether) {
  expect_that_each_life_goes_its_own_way(Control::random_places);
}

Experiment run_of_60() {
  return testing::read(testing::small_experiment, {{"experiment.evaluations", "60", ""},
                                                   {"development.operator.0.name", "length-adaptation", ""}});
}

/// Evolves a run; returns all of its individuals.
std::vector<ArchivedIndividual> evolved(const Experiment& experiment, Archive& archive, Simulator& simulator) {
  const std::atomic<bool> stop = false;
  evolve(experiment, simulator, archive, stop, Observer{});
  std::vector<ArchivedIndividual> all;
  for (std::uint32_t id = 0; id < 60; ++id) all.push_back(archive.individual(id).value());
  return all;
}

bool surpasses(const ArchivedIndividual& a, const ArchivedIndividual& b) {
  const std::vector<double>&x = a.result.objectives, &y = b.result.objectives;
  if (x.empty() || x[0] < y[0] || x[1] > y[1] || a.origin < b.origin) return false;  // distance, work, youth
  return x[0] > y[0] || x[1] < y[1] || a.origin > b.origin;
}

/// Whether an individual is on the front before or after the selection of a generation in which it is alive.
bool on_front(const ArchivedIndividual& one, const std::vector<ArchivedIndividual>& all, std::uint32_t generation,
              bool after_selection) {
  const auto is_there = [&](const ArchivedIndividual& other) {
    return other.born <= generation && (!other.died || *other.died >= generation + (after_selection ? 1 : 0));
  };
  return one.result.status == Status::ok && is_there(one) &&
         std::none_of(all.begin(), all.end(),
                      [&](const ArchivedIndividual& other) { return is_there(other) && surpasses(other, one); });
}

TEST(LifeRecord, ARunKeepsThoseOfTheFrontAlone) {
  const testing::Scratch scratch;
  const Experiment experiment = run_of_60();
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
  Archive archive = Archive::create(scratch / "run", experiment, simulator->device());
  const std::vector<ArchivedIndividual> all = evolved(experiment, archive, *simulator);
  int kept = 0;
  for (const ArchivedIndividual& one : all) {
    const std::optional<LifeRecord> record = archive.life(one.id);
    EXPECT_EQ(record.has_value(), on_front(one, all, one.born, false)) << "individual " << one.id;
    if (!record) continue;
    ++kept;
    EXPECT_EQ(record->changes().size(), 2u) << "two cycles";
  }
  EXPECT_GT(kept, 3);
  EXPECT_LT(kept, 57);
}

/// A selection operator that drops the best individuals, so that others come to the front.
class Levelling final : public Selection {
 public:
  std::vector<std::pair<std::uint32_t, std::uint32_t>> parents(std::span<const Candidate> rows, std::uint32_t count,
                                                               Rng& rng) const override {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    const auto draw = [&] { return rng.below(static_cast<std::uint32_t>(rows.size())); };
    while (pairs.size() < count) pairs.emplace_back(draw(), draw());
    return pairs;
  }

  std::vector<std::uint32_t> survivors(std::span<const Candidate> rows, std::uint32_t population, Rng&) const override {
    std::vector<std::uint32_t> order(rows.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto score = [&](std::uint32_t row) { return rows[row].ok() ? rows[row].scores[0] : 1e300; };
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return score(a) < score(b); });
    order.resize(std::min<std::size_t>(order.size(), population));
    return order;
  }
};

TEST(LifeRecord, ARunKeepsThoseWhoReachTheFrontLaterToo) {
  const testing::Scratch scratch;
  Experiment experiment = run_of_60();
  experiment.selection = std::make_unique<Levelling>();
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
  Archive archive = Archive::create(scratch / "run", experiment, simulator->device());
  const std::vector<ArchivedIndividual> all = evolved(experiment, archive, *simulator);
  const Evaluation evaluation(experiment, *simulator);
  int late = 0;
  for (const ArchivedIndividual& one : all) {
    bool ever = on_front(one, all, one.born, false), at_birth = ever;
    for (std::uint32_t generation = one.born; generation < 10; ++generation)
      ever = ever || on_front(one, all, generation, false) || on_front(one, all, generation, true);
    const std::optional<LifeRecord> record = archive.life(one.id);
    EXPECT_EQ(record.has_value(), ever) << "individual " << one.id;
    if (!record) continue;
    late += !at_birth;
    const Newborn newborn{one.id, one.born, &one.genome};
    std::vector<Life> lives = evaluation.birth.of({&newborn, 1});
    evaluation.development.run(lives, [](double) {});
    EXPECT_EQ(*record, lives.front().result.record) << "individual " << one.id;
  }
  EXPECT_GT(late, 3);
}

/// A run of ten generations that is stopped after five and resumed with another provenance.
class GoneOn : public ::testing::Test {
 protected:
  static constexpr std::uint32_t first_half = 5;

  GoneOn() { experiment_.selection = std::make_unique<Levelling>(); }

  /// Returns all individuals of a run whose second half is made by the experiment `second` on `device`.
  std::vector<ArchivedIndividual> evolved_by_two(const Experiment& second, const std::string& device) {
    std::atomic<bool> stop = false;
    const Observer observer{
        .generation_done = [&](const Summary& summary) { stop = summary.generation + 1 == first_half; }};
    testing::Elsewhere here(experiment_, "here");
    {
      Archive archive = Archive::create(folder_, experiment_, "here");
      evolve(experiment_, here, archive, stop, observer);
    }
    testing::Elsewhere there(experiment_, device);
    Archive archive = Archive::resume(folder_);
    return evolved(second, archive, there);
  }

  /// Expects that individuals of the first half that reach the front only in the second half do not get the record of a
  /// life that differs from their own.
  void expect_no_other_life_recorded(const std::vector<ArchivedIndividual>& all) {
    const Archive archive = Archive::read(folder_);
    int without_record = 0, late = 0;
    for (const ArchivedIndividual& one : all) {
      const auto ever = [&](std::uint32_t from, std::uint32_t to) {
        for (std::uint32_t generation = std::max(from, one.born); generation < to; ++generation)
          if (on_front(one, all, generation, false) || on_front(one, all, generation, true)) return true;
        return false;
      };
      const bool in_first = ever(0, first_half), in_second = ever(first_half, 10);
      const bool recorded = one.born < first_half ? in_first : in_second;
      EXPECT_EQ(archive.life(one.id).has_value(), recorded) << "individual " << one.id;
      without_record += in_second && !recorded;
      late += recorded && !on_front(one, all, one.born, false);
    }
    EXPECT_GT(without_record, 0);
    EXPECT_GT(late, 0) << "those who reach the front late by the same provenance have a record all the same";
  }

  testing::Scratch scratch_;
  std::filesystem::path folder_ = scratch_ / "run";
  Experiment experiment_ = run_of_60();
};

TEST_F(GoneOn, OnAnotherDeviceWarnsByTheGenerationOfBirth) {
  const std::vector<ArchivedIndividual> all = evolved_by_two(experiment_, "there");
  expect_no_other_life_recorded(all);
  const Archive archive = Archive::read(folder_);
  int warned_here = 0, warned_there = 0;
  for (const ArchivedIndividual& one : all) {
    const auto warning = [&](const std::string& device) {
      ::testing::internal::CaptureStderr();
      for_resimulation(archive, experiment_, one, device);
      return ::testing::internal::GetCapturedStderr();
    };
    const bool of_first = one.born < first_half, recorded = archive.life(one.id).has_value();
    EXPECT_EQ(warning("here").empty(), of_first || recorded) << "individual " << one.id;
    EXPECT_EQ(warning("there").empty(), !of_first || recorded) << "individual " << one.id;
    warned_here += !warning("here").empty();
    warned_there += !warning("there").empty();
    if (of_first && !recorded) {
      EXPECT_THAT(warning("there"),
                  testing::at_place("warning: individual " + std::to_string(one.id) + " ", "on there", "on here"));
    }
  }
  ::testing::internal::CaptureStderr();
  std::vector<const Individual*> everyone;
  for (const ArchivedIndividual& one : all) everyone.push_back(&one);
  EXPECT_EQ(for_resimulation(archive, experiment_, everyone, "elsewhere").size(), all.size());
  const std::string warning = ::testing::internal::GetCapturedStderr();
  EXPECT_EQ(std::count(warning.begin(), warning.end(), '\n'), 2) << "one line for each device of the run: " << warning;
  EXPECT_GT(warned_here, 0);
  EXPECT_GT(warned_there, 0);
}

TEST_F(GoneOn, OnAnotherDeviceNamesUpToSix) {
  const std::vector<ArchivedIndividual> all = evolved_by_two(experiment_, "there");
  const Archive archive = Archive::read(folder_);
  std::vector<const Individual*> unrecorded;
  for (const ArchivedIndividual& one : all)
    if (one.born < first_half && !archive.life(one.id)) unrecorded.push_back(&one);
  ASSERT_GE(unrecorded.size(), 7u);
  const auto warning = [&](std::size_t count) {
    unrecorded.resize(count);
    ::testing::internal::CaptureStderr();
    for_resimulation(archive, experiment_, unrecorded, "elsewhere");
    return ::testing::internal::GetCapturedStderr();
  };
  EXPECT_THAT(warning(7), testing::naming(std::to_string(unrecorded[4]->id) + " and 2 others were"));
  EXPECT_THAT(warning(6), testing::naming(std::to_string(unrecorded[5]->id) + " were")) << "one more is no longer";
}

TEST_F(GoneOn, WithAnotherOperatorWarnsToo) {
  Experiment second = run_of_60();
  second.selection = std::make_unique<Levelling>();
  second.uses.front().hash = "another";
  const std::vector<ArchivedIndividual> all = evolved_by_two(second, "here");
  expect_no_other_life_recorded(all);
  const Archive archive = Archive::read(folder_);
  const auto unrecorded = std::find_if(all.begin(), all.end(), [&](const auto& one) { return !archive.life(one.id); });
  ASSERT_NE(unrecorded, all.end());
  ASSERT_LT(unrecorded->born, first_half);
  ::testing::internal::CaptureStderr();
  for_resimulation(archive, experiment_, *unrecorded, "here");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "") << "by those that made it";
  ::testing::internal::CaptureStderr();
  for_resimulation(archive, second, *unrecorded, "here");
  EXPECT_THAT(::testing::internal::GetCapturedStderr(),
              testing::at_place("warning: individual " + std::to_string(unrecorded->id) + " ",
                                "build of evodevo or of an operator"));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
