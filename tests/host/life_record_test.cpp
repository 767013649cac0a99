// Records of lives: edits that are written can be read again, re-simulation gives a bit-identical matured body, and
// runs keep the records of individuals on the front.
#include "life/life_record.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "evodevo/helpers/rows.hpp"
#include "evolution/resimulation.hpp"
#include "life/edits.hpp"
#include "support/edits.hpp"
#include "support/elsewhere.hpp"
#include "support/experiments.hpp"
#include "support/lives.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"
#include "support/scratch.hpp"
#include "support/told.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using namespace testing;

/// An experiment with as many operators as possible, on bodies of some dozens of masses.
Experiment all_operators(bool reset) {
  return read(
      small_experiment,
      {{"development.operator.1", "{name='mass-turnover', threshold=100, limit=2, springs=4}", ""},
       {"development.operator.2", "{name='mass-growth', masses=1, springs=5, where='by-stress', join='nearest'}", ""},
       {"development.operator.3", "{name='length-adaptation', springs=3}", ""},
       {"development.operator.4", "{name='stiffness-adaptation', springs=3}", ""},
       {"development.operator.5", "{name='amplitude-adaptation', springs=3}", ""},
       {"development.operator.6", "{name='ballistic-growth'}", ""},
       {"encoding.size", "[3, 2, 2]", ""},
       {"scene.payload.share", "0.5", ""},
       {"encoding.size_range", "0.2", ""},
       {"development.cycles", "4", ""},
       {"development.reset", reset ? "true" : "false", ""}});
}

auto fields(const Mass& m) { return std::tuple(m.rest, m.mass, m.material, m.air_contacts, m.payload); }
auto fields(const Spring& s) {
  return std::tuple(s.a, s.b, s.rest_length, s.material, s.first_length, s.stiffness_factor);
}
/// The cause of an edit, if it has one.
std::optional<double> cause(double number) { return std::isnan(number) ? std::nullopt : std::optional(number); }
auto fields(const Removal& r) { return std::tuple(r.index, cause(r.cause)); }
auto fields(const NewMass& m) {
  return std::tuple(m.position, m.mass, m.material, m.mother, m.identity, cause(m.cause));
}
auto fields(const NewSpring& s) {
  return std::tuple(s.a, s.b, s.material, s.rest_length, s.stiffness_factor, s.like, cause(s.cause));
}
auto fields(const ChangedSpring& s) {
  return std::tuple(s.spring, s.rest_length, s.material, s.stiffness_factor, cause(s.cause));
}
auto fields(const Scaling& s) { return std::tuple(s.number, s.from, s.to, s.whole); }

template <class T>
void expect_same(const std::vector<T>& a, const std::vector<T>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(fields(a[i]), fields(b[i])) << i;
}

void expect_same(const Body& a, const Body& b) {
  EXPECT_EQ(a.materials, b.materials);
  expect_same(a.masses, b.masses);
  expect_same(a.springs, b.springs);
}

TEST(LifeRecord, ReplayedFromTheBodyAtBirthGivesTheMaturedOneToTheBit) {
  for (const bool reset : {false, true}) {
    const Experiment experiment = all_operators(reset);
    std::size_t alive = 0, removed_masses = 0, new_masses = 0, changed = 0, new_springs = 0, scaled = 0;
    Developed developed(experiment, 6);
    for (std::size_t i = 0; i < 6; ++i) {
      const Life& life = developed.lives[i];
      if (!life.alive()) continue;
      ++alive;
      LivingBody& living = developed.born[i];
      for (const Change& change : LifeRecord(life.record.bytes()).changes()) {
        apply(change.edits, living, change.op);
        removed_masses += change.edits.removed_masses.size();
        new_masses += change.edits.new_masses.size();
        changed += change.edits.changed_springs.size();
        new_springs += change.edits.new_springs.size();
        scaled += change.edits.scaling.has_value();
      }
      expect_same(living.body, life.living.body);
    }
    EXPECT_GE(alive, 3u);
    EXPECT_GT(std::min({removed_masses, new_masses, changed, new_springs, scaled}), 10u)
        << "there must be something to replay";
  }
}

Change change_of_all_kinds() {
  Change change;
  change.cycle = 300;
  change.op = 2;
  change.lengths_given = true;
  change.edits.scale_lengths({.number = 5, .from = 0.1, .to = 2, .whole = 3});
  for (const std::uint32_t mass : {0, 7, 100'000}) change.edits.remove_mass(mass);
  change.edits.removed_springs = {{3, 0}, {4, 1.5}, {70'000, 0x1p100}};
  const Material one{5000, 0.14, 1, 0.1 + 0.2}, other{1, 0, 0, 0};
  change.edits.change_spring(9, {.rest_length = 1e-300, .cause = 2});
  change.edits.change_spring(8, {.material = one, .cause = -3});
  change.edits.change_spring(7, {.material = one, .stiffness_factor = 0.1 + 0.2});
  change.edits.change_spring(6, {.stiffness_factor = 1e300, .cause = 5});
  change.edits.divide(3, {-1, 0.1, 2}, {.mass = 0.2, .identity = 0xfffffffffffffffe});
  change.edits.add_mass({0, 0, 0}, {.mass = 0.3, .material = 4, .identity = 0});
  change.edits.join(1, 200, one, {.rest_length = 0.1, .like = 0});
  change.edits.join(2, 0xfffffffe, other, {.rest_length = 0.0});
  change.edits.join(5, 6, other, {.rest_length = 7.0, .stiffness_factor = 0.1 + 0.2, .like = 0xfffffffe});
  change.edits.join(7, 6, other, {.rest_length = 7.0, .stiffness_factor = 0.1 + 0.2});
  return change;
}

void expect_same(const Change& a, const Change& b) {
  EXPECT_EQ(std::tie(a.cycle, a.op, a.lengths_given), std::tie(b.cycle, b.op, b.lengths_given));
  const Edits &one = a.edits, &other = b.edits;
  EXPECT_EQ(fields(one.scaling.value_or(Scaling{.from = -1})), fields(other.scaling.value_or(Scaling{.from = -1})));
  expect_same(one.removed_masses, other.removed_masses);
  expect_same(one.removed_springs, other.removed_springs);
  expect_same(one.changed_springs, other.changed_springs);
  expect_same(one.new_masses, other.new_masses);
  expect_same(one.new_springs, other.new_springs);
}

TEST(LifeRecord, GivesBackWhatItWasGivenAndRefusesADamagedOne) {
  Change torn_off{.cycle = 301}, of_masses{.cycle = 301, .op = 1};
  torn_off.edits.remove_mass(5);
  of_masses.edits.remove_mass(5, {.cause = 0.25});
  of_masses.edits.divide(0, {1, 2, 3}, {.mass = 0.2, .material = 1, .identity = 9, .cause = 7});
  of_masses.edits.join(1, 2, Material{1, 0, 0, 0}, {.rest_length = 0.5, .cause = 8});
  const std::vector<Change> given = {change_of_all_kinds(), torn_off, change_of_all_kinds(), of_masses};
  LifeRecord record;
  EXPECT_TRUE(record.empty());
  for (const Change& change : given) record.add(change);
  const std::vector<Change> back = LifeRecord(record.bytes()).changes();
  ASSERT_EQ(back.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) expect_same(back[i], given[i]);
  LifeRecord one;
  one.add(change_of_all_kinds());
  for (std::size_t length = 1; length < one.bytes().size(); ++length)
    EXPECT_THROW(LifeRecord(one.bytes().substr(0, length)), std::invalid_argument) << length;
  EXPECT_THROW(LifeRecord(std::string(20, '\xff')), std::invalid_argument);
}

TEST(LifeRecord, ASpringThatGoesAndOneThatComesTakeSome20BytesAndAScalingSome30) {
  const Experiment turnover =
      small({"encoding.size=[4, 4, 4]", "development.cycles=8", "development.operator.0.springs=50"});
  for (const Life& life : Developed(turnover, 2).lives) {
    ASSERT_TRUE(life.alive());
    EXPECT_LT(life.record.bytes().size(), 8 * 50 * 22u + 1000) << "and a few materials";
  }
  const Experiment growth =
      small({"encoding.size=[4, 4, 4]", "encoding.size_range=0.25", "development.operator.0={name='ballistic-growth'}",
             "development.cycles=100", "development.cycle_time=0.002"});
  for (const Life& life : Developed(growth, 2).lives) {
    ASSERT_TRUE(life.alive());
    ASSERT_GT(life.living.body.springs.size(), 100u);
    EXPECT_EQ(life.record.changes().size(), 100u);
    EXPECT_LE(life.record.bytes().size(), 100 * 34u);
  }
}

TEST(LifeRecord, CausesStayWithTheirEdits) {
  Edits edits;
  edits.removed_springs = {{7, 70}, {2, 20}, {7, 71}, {5, 50}};
  edits.removed_masses = {{3}, {1}};
  const Developed developed(read(small_experiment), 1);
  const LivingBody& living = developed.lives.front().living;
  const Genome genome;
  const Layout layout;
  const DevoContext context{living.body, living.state, 4, 9, 1, 1, 0, {}, 0.2, false, genome, layout};
  const Change change = change_by(edits, 1, context);
  EXPECT_EQ(change.cycle, 4u);
  EXPECT_THAT(indices(change.edits.removed_springs), ::testing::ElementsAre(2, 5, 7));
  EXPECT_THAT(causes(change.edits.removed_springs), ::testing::ElementsAre(20, 50, 70));
  EXPECT_THAT(indices(change.edits.removed_masses), ::testing::ElementsAre(1, 3));
  EXPECT_TRUE(causes(change.edits.removed_masses).empty());
}

TEST(LifeRecord, WhatComesAboutAtRandomPlacesHasNoCause) {
  Experiment experiment = all_operators(false);
  const auto causes_named = [&] {
    std::size_t count = 0;
    for (const Life& life : Developed(experiment, 6).lives)
      for (const Change& change : life.record.changes()) count += all_causes(change.edits).size();
    return count;
  };
  EXPECT_GT(causes_named(), 100u);
  experiment.development.control = Control::random_places;
  EXPECT_EQ(causes_named(), 0u);
}

void expect_same_life(const Life& a, const Life& b) {
  expect_same(a.living.body, b.living.body);
  EXPECT_EQ(a.living.state.position, b.living.state.position);
  EXPECT_EQ(a.living.state.velocity, b.living.state.velocity);
  EXPECT_EQ(a.living.state.start_energy, b.living.state.start_energy) << "the guard is to allow the same, to the bit";
  EXPECT_EQ(a.record, b.record);
}

TEST(LifeRecord, ALifeLivedAgainIsAllowedTheEnergyThatItHadThen) {
  std::vector<double> energies;
  for (const std::optional<double> stretch : {std::optional<double>(), std::optional(1.5)}) {
    // the first spring goes and another one comes in its place, without force or stretched
    const auto exchange = [&](const DevoContext& context, Edits& edits) {
      const Spring& spring = context.body.springs.front();
      edits.join(spring.a, spring.b, context.body.materials[spring.material]);
      if (stretch) edits.new_springs[0].rest_length = *stretch * spring.rest_length;
      edits.remove_spring(0);
    };
    const Experiment experiment = with({Told({}, exchange)});
    const Life life = matured(experiment);
    expect_same_life(matured(experiment, {LifeRecord(life.record.bytes())}), life);
    energies.push_back(life.living.state.start_energy);
  }
  EXPECT_GT(energies[1], energies[0]) << "what an operator strains is allowed";
}

/// An encoding of a row of masses, each joined to the next two, whose springs remember 0.1, -0.2 and 0 in turns under
/// the name "x".
std::unique_ptr<Encoding> row_of(std::uint32_t masses) {
  Blueprint blueprint;
  for (std::uint32_t i = 0; i < masses; ++i) blueprint.body.masses.push_back({{0.5 * i, 0, 0}, 0.2, 1, 0});
  for (std::uint32_t i = 0; i < masses; ++i)
    for (std::uint32_t j = i + 1; j < std::min(i + 3, masses); ++j) {
      blueprint.spring_memory["x"].push_back(std::array{0.1, -0.2, 0.0}[blueprint.body.springs.size() % 3]);
      blueprint.body.springs.push_back({i, j, 0.5 * (j - i), 1});
    }
  return std::make_unique<GivenBlueprint>(std::move(blueprint));
}

/// An operator that in each application multiplies what it remembers about springs by a factor, and brings all springs
/// a part of the way to 1 + x times their lengths.
Told scaler(double factor) {
  Told told({}, [=](const DevoContext& context, Edits& edits) {
    for (std::uint32_t s = 0; factor != 1 && s < context.body.springs.size(); ++s)
      edits.remember_spring(s, {factor * context.spring_memory[s][0]});
    edits.scale_lengths({.from = context.application - 1.0,
                         .to = static_cast<double>(context.application),
                         .whole = static_cast<double>(context.applications)});
  });
  told.of_springs = {"x"};
  return told;
}

TEST(LifeRecord, AScalingIsShortForAnyNumberOfSpringsUnlessTheOperatorHasChangedWhatItRemembers) {
  const auto expect_closed_form = [](const Life& life, double factor) {
    const std::vector<Spring>& springs = life.living.body.springs;
    for (std::size_t s = 0; s < springs.size(); ++s) {
      const double first = factor * std::array{0.1, -0.2, 0.0}[s % 3], second = factor * first;
      const double expected = (1 + first / 2) * (1 + second) / (1 + second / 2);
      EXPECT_NEAR(springs[s].rest_length / springs[s].first_length, expected, 1e-12) << s;
    }
  };
  for (const std::uint32_t masses : {5u, 80u})
    for (const double factor : {1.0, 0.75}) {
      SCOPED_TRACE(std::to_string(masses) + " masses, times " + std::to_string(factor));
      Experiment experiment = with({scaler(factor)});
      experiment.encoding = row_of(masses);
      const Life life = matured(experiment);
      expect_closed_form(life, factor);
      const std::vector<Change> changes = life.record.changes();
      ASSERT_EQ(changes.size(), 2u);
      const std::size_t springs = life.living.body.springs.size();
      for (const Change& change : changes) {
        EXPECT_EQ(only_scales(change.edits), factor == 1);
        EXPECT_EQ(change.edits.changed_springs.size(), factor == 1 ? 0 : springs - springs / 3)
            << "a third of the springs has nowhere to go";
      }
      if (factor == 1) {
        EXPECT_LE(life.record.bytes().size(), 2 * 40u);
      }
      experiment.devo[0].op = std::make_unique<Told>(scaler(3));  // what it would do now does not matter
      expect_same_life(matured(experiment, {LifeRecord(life.record.bytes())}), life);
    }
}

TEST(LifeRecord, SpringsThatAreLikeOthersAreScaledLikeThemAlsoInALifeLivedAgain) {
  const auto exchange = [](const DevoContext& context, Edits& edits) {
    if (context.cycle != 1) return;
    const Material& material = context.body.materials[context.body.springs[0].material];
    edits.remove_spring(4);  // the model of a new one, of masses 2 and 3
    edits.join(0, 3, material, {.like = 1, .cause = 4});
    edits.join(1, 4, material, {.like = 0});
    edits.join(2, 3, material, {.like = 4});
    edits.join(2, 5, material);
    edits.remove_mass(7);
  };
  Experiment experiment = with({Told({}, exchange), scaler(1)});
  experiment.encoding = row_of(8);
  const Life life = matured(experiment);
  const std::vector<Spring>& springs = life.living.body.springs;
  ASSERT_EQ(springs.size(), 13u - 1 - 2 + 4);
  const auto scaled = [&](std::size_t spring) { return springs[spring].rest_length / springs[spring].first_length; };
  // the new ones are there before the first turn of the scaling
  EXPECT_NEAR(scaled(10), 0.8, 1e-12);
  EXPECT_NEAR(scaled(11), 1.1, 1e-12);
  EXPECT_NEAR(scaled(12), 0.8, 1e-12);
  EXPECT_EQ(scaled(13), 1) << "like no other";
  EXPECT_NEAR(scaled(0), 1.1, 1e-12);
  const std::vector<Change> changes = LifeRecord(life.record.bytes()).changes();
  ASSERT_EQ(changes.size(), 3u);
  std::vector<std::optional<std::uint32_t>> models;
  for (const NewSpring& spring : changes[0].edits.new_springs) models.push_back(spring.like);
  EXPECT_THAT(models, ::testing::ElementsAre(1u, 0u, 4u, std::nullopt));
  EXPECT_TRUE(only_scales(changes[1].edits) && only_scales(changes[2].edits));
  const Life again = matured(experiment, {LifeRecord(life.record.bytes())});
  expect_same_life(again, life);
  EXPECT_EQ(again.living.memory.at(1).springs.values, life.living.memory.at(1).springs.values);
}

/// Simulates lives with and without a record in one batch. Development decides differently in this batch than in the
/// records.
TEST(LifeRecord, LivesFollowTheirsWhateverTheOperatorsWouldDoAndThoseWithoutOneGoTheirOwnWays) {
  for (const auto& [control, reset] : {std::pair(Control::off, false),
                                       {Control::off, true},
                                       {Control::random_places, false},
                                       {Control::random_places, true}}) {
    Experiment experiment = all_operators(reset);
    experiment.development.control = control;
    const std::vector<Individual> individuals = breed(experiment, {}, 0, 0, 6);
    std::vector<Newborn> newborns = newborns_of(individuals);
    const std::vector<Life> recorded = Developed(experiment, newborns).lives;
    experiment.development.seed += 1;  // development draws other numbers
    const std::vector<Life> free = Developed(experiment, newborns).lives;
    for (const std::size_t i : {1, 3, 5}) newborns[i].records = {recorded[i].record};
    const std::vector<Life> mixed = Developed(experiment, newborns).lives;
    std::size_t alive[2] = {};  // without and with a record
    for (std::size_t i = 0; i < individuals.size(); ++i) {
      SCOPED_TRACE(i);
      if (!recorded[i].alive() || !free[i].alive()) continue;
      ++alive[i % 2];
      EXPECT_FALSE(free[i].record == recorded[i].record);
      expect_same_life(mixed[i], i % 2 == 1 ? recorded[i] : free[i]);
    }
    EXPECT_GT(std::min(alive[0], alive[1]), 0u);
  }
}

Experiment run_of_60() {
  return small(
      {"experiment.evaluations=60", "development.draws=individual", "development.operator.0.name=length-adaptation"});
}

std::vector<ArchivedIndividual> individuals_of(const Archive& archive) {
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

bool ever_on_front(const ArchivedIndividual& one, const std::vector<ArchivedIndividual>& all, std::uint32_t from,
                   std::uint32_t to) {
  for (std::uint32_t generation = std::max(from, one.born); generation < to; ++generation)
    if (on_front(one, all, generation, false) || on_front(one, all, generation, true)) return true;
  return false;
}

/// A selection operator that drops the best individuals, so that others come to the front.
class Levelling final : public Selection {
 public:
  std::vector<Couple> parents(const SelectionContext& context, std::uint32_t count, Rng& rng) const override {
    std::vector<Couple> couples;
    const auto draw = [&] { return rng.below(static_cast<std::uint32_t>(context.rows.size())); };
    while (couples.size() < count) {
      const std::uint32_t mate = draw(), parent = draw();
      couples.push_back({parent, mate});
    }
    return couples;
  }

  Survival survivors(const SelectionContext& context, std::uint32_t population, Rng&) const override {
    const auto rows = context.rows;
    std::vector<std::uint32_t> order(rows.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto score = [&](std::uint32_t row) { return rows[row].ok() ? rows[row].scores[0] : 1e300; };
    std::ranges::stable_sort(order, {}, score);
    return first_rows(order, population);
  }
};

TEST(LifeRecord, ARunKeepsThoseOfTheFrontAloneAlsoOfThoseWhoReachItLater) {
  for (const bool levelling : {false, true}) {
    Experiment experiment = run_of_60();
    if (levelling) experiment.selection = std::make_unique<Levelling>();
    const FinishedRun run(std::move(experiment));
    const std::vector<ArchivedIndividual> all = individuals_of(run.archive);
    int kept = 0, late = 0;
    for (const ArchivedIndividual& one : all) {
      SCOPED_TRACE(one.id);
      const std::vector<LifeRecord> records = run.archive.lives(one.id);
      EXPECT_EQ(records.size(), ever_on_front(one, all, one.born, 10) ? 1u : 0u);
      if (records.empty()) continue;
      ++kept;
      late += !on_front(one, all, one.born, false);
      EXPECT_EQ(records[0].changes().size(), 2u) << "two cycles";
      const std::vector<Newborn> again{{one.id, one.born, &one.genome}};
      EXPECT_EQ(records[0], Developed(run.experiment, again).lives.front().record);
    }
    EXPECT_GT(levelling ? late : kept, 3);
    EXPECT_TRUE(levelling || kept < 57) << kept;
  }
}

/// A run of ten generations that is stopped after five and resumed with another provenance.
class GoneOn : public ::testing::Test {
 protected:
  static constexpr std::uint32_t first_half = 5;

  GoneOn() { experiment_.selection = std::make_unique<Levelling>(); }

  /// Returns all individuals of a run whose second half is made by the experiment `second` on `device`.
  std::vector<ArchivedIndividual> evolved_by_two(const Experiment& second, const std::string& device) {
    Elsewhere here(experiment_, "here");
    {
      Archive archive = Archive::create(folder_, experiment_, "here");
      std::atomic<bool> stop = false;
      evolve(experiment_, here, archive, stop, {.generation_done = [&](std::int64_t, const Summary& summary) {
               stop = summary.generation + 1 == first_half;
             }});
    }
    Elsewhere there(experiment_, device);
    Archive archive = Archive::resume(folder_);
    evolve(second, there, archive, false, Observer{});
    return individuals_of(archive);
  }

  /// Expects that individuals of the first half that reach the front only in the second half do not get the record of a
  /// life that differs from their own.
  void expect_no_other_life_recorded(const std::vector<ArchivedIndividual>& all) {
    const Archive archive = Archive::read(folder_);
    int without_record = 0, late = 0;
    for (const ArchivedIndividual& one : all) {
      const bool in_first = ever_on_front(one, all, 0, first_half), in_second = ever_on_front(one, all, first_half, 10);
      const bool recorded = one.born < first_half ? in_first : in_second;
      EXPECT_EQ(!archive.lives(one.id).empty(), recorded) << "individual " << one.id;
      without_record += in_second && !recorded;
      late += recorded && !on_front(one, all, one.born, false);
    }
    EXPECT_GT(without_record, 0);
    EXPECT_GT(late, 0) << "those who reach the front late by the same provenance have a record all the same";
  }

  /// Returns the warning about individuals that are to be simulated again on `device`.
  static std::string warning(const Archive& archive, const Experiment& experiment, const auto& individuals,
                             const std::string& device) {
    return warnings_of([&] { for_resimulation(archive, experiment, individuals, device); });
  }

  Scratch scratch_;
  std::filesystem::path folder_ = scratch_ / "run";
  Experiment experiment_ = run_of_60();
};

TEST_F(GoneOn, OnAnotherDeviceWarnsByTheGenerationOfBirthAndNamesUpToSix) {
  const std::vector<ArchivedIndividual> all = evolved_by_two(experiment_, "there");
  expect_no_other_life_recorded(all);
  const Archive archive = Archive::read(folder_);
  int warned_here = 0;
  std::vector<const Individual*> everyone, unrecorded;  // of the first half
  for (const ArchivedIndividual& one : all) {
    everyone.push_back(&one);
    const std::string here = warning(archive, experiment_, one, "here");
    const std::string there = warning(archive, experiment_, one, "there");
    const bool of_first = one.born < first_half, recorded = !archive.lives(one.id).empty();
    EXPECT_EQ(here.empty(), of_first || recorded) << "individual " << one.id;
    EXPECT_EQ(there.empty(), !of_first || recorded) << "individual " << one.id;
    warned_here += !here.empty();
    if (!of_first || recorded) continue;
    unrecorded.push_back(&one);
    EXPECT_THAT(there, at_place("warning: individual " + std::to_string(one.id) + " ", "on there", "on here"));
  }
  EXPECT_GT(warned_here, 0);
  const std::string of_all =
      warnings_of([&] { EXPECT_EQ(for_resimulation(archive, experiment_, everyone, "elsewhere").size(), all.size()); });
  EXPECT_EQ(std::ranges::count(of_all, '\n'), 2) << "one line for each device of the run: " << of_all;
  ASSERT_GE(unrecorded.size(), 7u);
  unrecorded.resize(7);
  EXPECT_THAT(warning(archive, experiment_, unrecorded, "elsewhere"),
              naming(std::to_string(unrecorded[4]->id) + " and 2 others were"));
  unrecorded.resize(6);
  EXPECT_THAT(warning(archive, experiment_, unrecorded, "elsewhere"),
              naming(std::to_string(unrecorded[5]->id) + " were"))
      << "one more is no longer";
}

TEST_F(GoneOn, WithAnotherOperatorWarnsToo) {
  Experiment second = run_of_60();
  second.selection = std::make_unique<Levelling>();
  second.uses.front().hash = "another";
  const std::vector<ArchivedIndividual> all = evolved_by_two(second, "here");
  expect_no_other_life_recorded(all);
  const Archive archive = Archive::read(folder_);
  const auto unrecorded =
      std::find_if(all.begin(), all.end(), [&](const auto& one) { return archive.lives(one.id).empty(); });
  ASSERT_NE(unrecorded, all.end());
  ASSERT_LT(unrecorded->born, first_half);
  EXPECT_EQ(warning(archive, experiment_, *unrecorded, "here"), "") << "by those that made it";
  EXPECT_THAT(
      warning(archive, second, *unrecorded, "here"),
      at_place("warning: individual " + std::to_string(unrecorded->id) + " ", "build of evodevo or of an operator"));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
