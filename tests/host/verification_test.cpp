// Verification of champions: fitness that is an artefact is detected.
#include "life/verification/verification.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "commands/shell/verification_report.hpp"
#include "support/changed.hpp"
#include "support/elsewhere.hpp"
#include "support/experiments.hpp"
#include "support/lives.hpp"
#include "support/messages.hpp"
#include "support/pairs.hpp"
#include "support/refusals.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

/// An experiment of random walking robots with about thirty masses.
const std::string walkers =
    testing::small_with({{"\"voxel\"\nsize = [2, 1, 1]\nedge = 0.5", "\"neural\"\npoints = 40\nneighbours = 8"},
                         {"[development]\ncycles = 2\ncycle_time = 0.05\n", ""},
                         {"[[development.operator]]\nname = \"spring-turnover\"\nsprings = 2\n", ""},
                         {"settle = 0.05\nwindow = 0.1", "settle = 14\nwindow = 5"},
                         {"[[fitness]]\nname = \"actuation-work\"\nsettle = 0.05\nwindow = 0.1\n", ""}});

std::unique_ptr<Simulator> simulator_for(const Experiment& experiment) {
  return make_cpu_simulator(experiment.scene, experiment.stepping, 2);
}

std::vector<Individual> evaluated(const Experiment& experiment, std::vector<Individual> individuals) {
  const auto simulator = simulator_for(experiment);
  const std::vector<Newborn> newborns = testing::newborns_of(individuals);
  std::vector<Result> results = Evaluation(experiment, *simulator).evaluate(newborns, [](double) {});
  for (std::size_t i = 0; i < results.size(); ++i) individuals[i].result = std::move(results[i]);
  return individuals;
}

/// Returns those of so many random individuals that have a fitness, evaluated.
std::vector<Individual> living(const Experiment& experiment, std::uint32_t count) {
  std::vector<Individual> individuals = evaluated(experiment, breed(experiment, {}, 0, 0, count));
  std::erase_if(individuals, [](const Individual& i) { return i.result.status != Status::ok; });
  return individuals;
}

std::vector<Champion> champions_of(std::span<const Individual> individuals) {
  std::vector<Champion> champions;
  for (const Individual& individual : individuals)
    champions.push_back({{individual.id, individual.born, &individual.genome}, individual.result.objectives.front()});
  return champions;
}

std::vector<Verification> verified(const Experiment& experiment, std::span<const Individual> individuals) {
  return verify(experiment, *simulator_for(experiment), champions_of(individuals));
}

/// Verifies the best of 24 random individuals.
Verification verified_best(const Experiment& experiment) {
  const std::vector<Individual> individuals = living(experiment, 24);
  const Individual best =
      *std::ranges::max_element(individuals, {}, [](const Individual& i) { return i.result.objectives[0]; });
  EXPECT_GT(best.result.objectives[0], 0.01) << "there must be something to verify";
  return verified(experiment, {&best, 1}).front();
}

double value(const Verification& verification, const std::string& trial) {
  for (const Trial& t : verification.trials)
    if (t.name == trial) return t.value.value();
  throw std::out_of_range("no trial " + trial);
}

using Marks = std::vector<std::string>;

TEST(Verify, AWalkerIsOne) {
  const Verification walker = verified_best(testing::read(walkers));
  EXPECT_EQ(value(walker, "again"), walker.fitness) << "the same bits";
  for (const Trial& trial : walker.trials)
    EXPECT_EQ(held(walker, trial, true), trial.name != "no-muscles") << trial.name;
  EXPECT_EQ(marks(walker, true), Marks{});
  EXPECT_THROW(value(walker, "reborn-1"), std::out_of_range) << "that is what perturbed-1 to -3 are";
}

TEST(Verify, AVerdictSaysWhatOtherLivesSay) {
  Verification verification{.individual = 1, .fitness = 3, .trials = {}};
  const auto add = [&](const std::string& name, double value) {
    verification.trials.push_back({.name = name, .reason = "", .value = value});
  };
  for (const char* name : {"quarter-step", "other-method", "settled"}) add(name, 3);
  add("no-muscles", 0);
  EXPECT_EQ(verdict_text(verification, true), "verified") << "it was not born again";
  add("reborn-1", 1.4);
  add("reborn-2", 1.6);
  add("reborn-3", -3);
  EXPECT_EQ(verdict_text(verification, true), "verified, kept in 1 of 3 lives to come");
  verification.trials.front().value = 0;
  EXPECT_EQ(verdict_text(verification, true), "artefact, kept in 1 of 3 lives to come");
}

TEST(Verify, BeforeTheFrontMakesTheSameTrialsToTheFirstMark) {
  const Experiment experiment = testing::read(walkers);
  const auto simulator = simulator_for(experiment);
  const std::vector<Individual> individuals = living(experiment, 6);
  const std::vector<Champion> champions = champions_of(individuals);
  ASSERT_GT(champions.size(), 1u);
  const auto all = verify(experiment, *simulator, champions);
  const ExactSimulators exact = exact_simulators(experiment, *simulator);
  std::set<std::string> firsts;  // the trials from which marks were found
  for (const std::size_t most_at_once : {std::size_t{0}, champions.size()}) {
    const auto before = verify_marks(experiment, *simulator, exact, champions, most_at_once);
    ASSERT_EQ(before.size(), champions.size());
    for (std::size_t i = 0; i < before.size(); ++i) {
      EXPECT_EQ(before[i].individual, all[i].individual);
      for (const Trial& trial : before[i].trials) {
        const auto same = std::ranges::find(all[i].trials, trial.name, &Trial::name);
        ASSERT_NE(same, all[i].trials.end()) << trial.name;
        EXPECT_EQ(trial.value, same->value) << trial.name << ": the same bits";
        EXPECT_EQ(trial.status, same->status) << trial.name;
      }
      const std::optional<Mark> mark = first_mark(before[i], true), of_all = first_mark(all[i], true);
      ASSERT_EQ(mark.has_value(), of_all.has_value());
      if (!mark) {
        EXPECT_EQ(before[i].trials.size(), 4u);
        continue;
      }
      EXPECT_EQ(mark->trial.name, of_all->trial.name);
      EXPECT_LT(before[i].trials.size(), 4u + (most_at_once > 0)) << "it was tried further";
      firsts.insert(mark->trial.name);
    }
  }
  EXPECT_FALSE(firsts.empty());
}

TEST(Verify, WhatFallsIsPassive) {
  const Experiment experiment = testing::read(
      walkers,
      testing::overrides({"encoding.materials=['tissue', 'bone']", "fitness.0.settle=0", "fitness.0.window=2"}));
  const Verification faller = verified_best(experiment);
  EXPECT_EQ(value(faller, "no-muscles"), faller.fitness) << "it has none";
  EXPECT_LT(std::abs(value(faller, "settled")), 0.1 * faller.fitness) << "it has come to rest";
  EXPECT_EQ(marks(faller, true), Marks{"passive"});
}

/// A step just below the limit increases the amplitude of an oscillation; the exact amplitude is the strain.
TEST(Verify, WhatOnlyTheStepBringsForthIsAnArtefact) {
  const Experiment experiment = testing::pairs();
  Individual exaggerated;
  exaggerated.genome = {static_cast<float>(testing::exaggerated(2.5)), 0};
  const auto individuals = evaluated(experiment, {exaggerated});
  ASSERT_EQ(individuals[0].result.status, Status::ok) << individuals[0].result.reason;
  ASSERT_GT(individuals[0].result.objectives[0], 2.4 * testing::strain);
  const Verification verification = verified(experiment, individuals).front();
  EXPECT_LT(value(verification, "quarter-step"), 1.2 * testing::strain);
  EXPECT_LT(value(verification, "other-method"), 1.2 * testing::strain);
  EXPECT_THAT(marks(verification, true), ::testing::Contains("artefact"));
}

TEST(Verify, TheSameEveryTimeWhateverElseIsVerifiedAndRobotsThatDevelopAreBornAgain) {
  const Experiment experiment = testing::small();  // with an operator that draws random numbers
  const std::vector<Individual> individuals = living(experiment, 12);
  ASSERT_GE(individuals.size(), 2u);
  const auto together = verified(experiment, individuals);
  for (std::size_t i = 0; i < individuals.size(); ++i) {
    const auto alone = verified(experiment, {&individuals[i], 1});
    for (std::size_t t = 0; t < alone[0].trials.size(); ++t)
      EXPECT_EQ(alone[0].trials[t].value, together[i].trials[t].value) << alone[0].trials[t].name;
    EXPECT_EQ(value(together[i], "again"), individuals[i].result.objectives[0]) << "developed as in the run";
    EXPECT_NE(value(together[i], "perturbed-1"), value(together[i], "perturbed-2"));
  }
  EXPECT_NE(value(together[0], "reborn-1"), value(together[0], "reborn-2"));
  EXPECT_NE(value(together[0], "reborn-2"), value(together[0], "reborn-3"));
}

/// Without ground, the posture of a body determines its time step, as dashpots do.
TEST(Verify, ABodyThatNoOperatorChangesKeepsItsFitnessToo) {
  std::string swimmers = walkers;
  const std::size_t scene = swimmers.find("[scene.gravity]");
  swimmers.replace(scene, swimmers.find("[[fitness]]") - scene, "[scene.drag]\n[development]\ncycles = 3\n");
  for (const std::string damping : {"0", "0.8"}) {
    const Experiment experiment =
        testing::read(swimmers, testing::overrides({"simulation.accuracy=balanced", "fitness.0.settle=0",
                                                    "fitness.0.window=2", "materials.muscle.damping=" + damping}));
    const std::vector<Individual> individuals = living(experiment, 6);
    ASSERT_GE(individuals.size(), 3u);
    for (const Verification& swimmer : verified(experiment, individuals))
      EXPECT_EQ(value(swimmer, "again"), swimmer.fitness) << "the same bits, with damping " << damping;
  }
}

/// The cycles of its development change nothing.
TEST(Verify, AWalkerThatDrawsNoNumbersIsBornAgainAsOne) {
  const Verification walker = verified_best(testing::read(walkers + "[development]\ncycles = 2\n"));
  for (const char* trial : {"reborn-1", "reborn-2", "reborn-3"}) {
    EXPECT_NE(value(walker, trial), walker.fitness) << "it is perturbed";
    EXPECT_GT(value(walker, trial), walker.fitness / 2) << trial;
  }
}

TEST(Verify, WhatWasRecordedOfALifeHappensAgain) {
  testing::FinishedRun run(testing::small());
  run.experiment.seed += 1;  // operators would draw other numbers
  std::size_t recorded = 0;
  for (const Verification& verification : verify_best(run.experiment, *run.simulator, run.archive, 24)) {
    if (run.archive.lives(verification.individual).empty()) continue;
    ++recorded;
    EXPECT_EQ(value(verification, "again"), verification.fitness) << verification.individual;
  }
  EXPECT_GE(recorded, 2u);
}

TEST(Verify, WarnsOfLivesThatMayHaveDevelopedOtherwise) {
  testing::FinishedRun run(testing::small());
  const auto warnings = [&](Simulator& simulator) {
    return testing::warnings_of([&] { verify_best(run.experiment, simulator, run.archive, 24); });
  };
  EXPECT_EQ(warnings(*run.simulator), "");
  testing::Elsewhere elsewhere(run.experiment, "another device");
  const std::string warned = warnings(elsewhere);
  EXPECT_THAT(warned, testing::naming("on another device", "on " + run.simulator->device()));
  for (const std::uint32_t id : run.archive.best(24)) {
    const bool warns = warned.find("warning: individual " + std::to_string(id) + " ") != std::string::npos;
    EXPECT_EQ(warns, run.archive.lives(id).empty()) << warned;
  }
}

TEST(Verify, ThresholdsAreAtHalf) {
  const auto found = [](double fitness, const std::string& trial, std::optional<double> value, bool maximise = true) {
    const Verification verification{0, fitness, {{trial, value ? Status::ok : Status::diverged, "", value}}};
    return marks(verification, maximise);
  };
  EXPECT_EQ(found(2, "quarter-step", 1), Marks{});
  EXPECT_EQ(found(2, "quarter-step", 0.99), Marks{"artefact"});
  EXPECT_EQ(found(2, "other-method", std::nullopt), Marks{"artefact"});
  EXPECT_EQ(found(2, "other-method", std::nan("")), Marks{"artefact"});
  EXPECT_EQ(found(2, "perturbed-1", 0), Marks{}) << "chance, not the step";
  EXPECT_EQ(found(2, "no-muscles", 1), Marks{});
  EXPECT_EQ(found(2, "no-muscles", 1.01), Marks{"passive"});
  EXPECT_EQ(found(2, "no-muscles", std::nullopt), Marks{});
  EXPECT_EQ(found(2, "settled", 1), Marks{});
  EXPECT_EQ(found(2, "settled", 0.99), Marks{"passive"});
  EXPECT_EQ(found(2, "settled", std::nullopt), Marks{});
  EXPECT_EQ(found(-2, "quarter-step", -3), Marks{});
  EXPECT_EQ(found(-2, "quarter-step", -3.1), Marks{"artefact"});
  EXPECT_EQ(found(-1e-9, "quarter-step", 0), Marks{}) << "nothing is lost";
  EXPECT_EQ(found(2, "quarter-step", 7), Marks{}) << "nothing is lost";
  EXPECT_EQ(found(2, "quarter-step", 0, false), Marks{}) << "nothing is lost";
  EXPECT_EQ(found(-2, "no-muscles", -2), Marks{}) << "nothing to keep";
  EXPECT_EQ(found(2, "quarter-step", 3, false), Marks{});
  EXPECT_EQ(found(2, "quarter-step", 3.1, false), Marks{"artefact"});
  EXPECT_EQ(found(2, "no-muscles", 0, false), Marks{}) << "rest costs nothing";
}

TEST(Verify, TheFirstMarkNamesItsTrial) {
  const auto trial = [](const char* name, double value) { return Trial{name, Status::ok, "", value}; };
  Verification verification{0, 2, {trial("quarter-step", 2), trial("other-method", 0.1), trial("settled", 0.2)}};
  const auto first = [&] { return first_mark(verification, true).value(); };
  EXPECT_EQ(first().status, Status::passive);
  EXPECT_EQ(first().trial.name, "settled");
  verification.trials[2].value = 2;
  EXPECT_EQ(first().status, Status::artefact);
  EXPECT_EQ(first().trial.name, "other-method");
  verification.trials[0].value = 0.3;
  EXPECT_EQ(first().trial.name, "quarter-step");
  verification.trials[2].value = 0.2;
  EXPECT_EQ(marks(verification, true), (Marks{"artefact", "passive"})) << "each once";
  verification.trials = {trial("quarter-step", 2)};
  EXPECT_FALSE(first_mark(verification, true).has_value());
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
