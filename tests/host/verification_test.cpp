// Verification of champions: fitness that is an artefact is detected.
#include "life/verification.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>

#include "commands/shell/verification_report.hpp"
#include "evolution/breeding.hpp"
#include "evolution/evolution.hpp"
#include "support/elsewhere.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

const Progress unwatched = [](double) {};

/// An experiment of random walking robots with about thirty masses.
const std::string walkers = R"(
[experiment]
seed = 7
[encoding]
name = "neural"
points = 40
neighbours = 8
[[mutation]]
name = "reset-weight"
[scene.gravity]
[scene.floor]
[scene.friction]
[scene.damping]
[[fitness]]
name = "distance"
settle = 14
window = 5
[selection]
name = "elitist"
)";

std::unique_ptr<Simulator> simulator_for(const Experiment& experiment) {
  return make_cpu_simulator(experiment.scene, experiment.stepping, 2);
}

std::vector<Individual> evaluated(const Experiment& experiment, Simulator& simulator,
                                  std::vector<Individual> individuals) {
  std::vector<Newborn> newborns;
  for (const Individual& individual : individuals)
    newborns.push_back({individual.id, individual.born, &individual.genome});
  std::vector<Result> results = Evaluation(experiment, simulator).evaluate(newborns, unwatched);
  for (std::size_t i = 0; i < results.size(); ++i) individuals[i].result = std::move(results[i]);
  return individuals;
}

std::vector<Verification> verified(const Experiment& experiment, Simulator& simulator,
                                   std::span<const Individual> individuals) {
  std::vector<Champion> champions;
  for (const Individual& individual : individuals)
    champions.push_back({{individual.id, individual.born, &individual.genome}, individual.result.objectives.front()});
  return verify(experiment, simulator, champions);
}

/// Verifies the best of 24 random individuals.
Verification verified_best(const Experiment& experiment) {
  const auto simulator = simulator_for(experiment);
  std::vector<Individual> individuals = evaluated(experiment, *simulator, breed(experiment, {}, 0, 0, 24));
  std::erase_if(individuals, [](const Individual& i) { return i.result.status != Status::ok; });
  const Individual best = *std::max_element(
      individuals.begin(), individuals.end(),
      [](const Individual& a, const Individual& b) { return a.result.objectives[0] < b.result.objectives[0]; });
  EXPECT_GT(best.result.objectives[0], 0.01) << "there must be something to verify";
  return verified(experiment, *simulator, {&best, 1}).front();
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
}

TEST(Verify, BeforeTheFrontMakesTheSameTrialsToTheFirstMark) {
  const Experiment experiment = testing::read(walkers);
  const auto simulator = simulator_for(experiment);
  std::vector<Champion> champions;
  const std::vector<Individual> individuals = evaluated(experiment, *simulator, breed(experiment, {}, 0, 0, 6));
  for (const Individual& individual : individuals)
    if (individual.result.status == Status::ok)
      champions.push_back({{individual.id, individual.born, &individual.genome}, individual.result.objectives.front()});
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
  const Experiment experiment = testing::read(walkers, {{"encoding.materials", "[\"tissue\", \"bone\"]", ""},
                                                        {"fitness.0.settle", "0", ""},
                                                        {"fitness.0.window", "2", ""}});
  const Verification faller = verified_best(experiment);
  EXPECT_EQ(value(faller, "no-muscles"), faller.fitness) << "it has none";
  EXPECT_LT(std::abs(value(faller, "settled")), 0.1 * faller.fitness) << "it has come to rest";
  EXPECT_EQ(marks(faller, true), Marks{"passive"});
}

constexpr double mass = 0.2, strain = 0.1;

/// An encoding of two masses 1 m apart, joined by a spring whose length without force is 1 + `strain` m.
class StrainedPair final : public Encoding {
 public:
  explicit StrainedPair(double stiffness) : stiffness_(stiffness) {}
  Layout layout(const EncodingContext&) const override { return {}; }
  Blueprint decode(const Genome&, const Layout&, const EncodingContext& context) const override {
    Blueprint blueprint;
    blueprint.body.materials = context.materials;
    const std::uint32_t own = blueprint.body.material_index({stiffness_, strain, 0, 3.14159265358979323846 / 2});
    blueprint.body.masses = {{{0, 0, 0}, mass}, {{1, 0, 0}, mass}};
    blueprint.body.springs = {{0, 1, 1, own}};
    return blueprint;
  }

 private:
  double stiffness_;
};

/// A fitness operator that returns the length of the body at a given time minus the length of its spring without force,
/// m.
class Stretch final : public Fitness {
 public:
  explicit Stretch(double time) : time_(time) {}
  Request observes() const override { return {.settle = time_, .window = 0.001}; }
  std::vector<Objective> objectives() const override { return {{"stretch", "m", true}}; }
  std::vector<double> score(const Observation& seen) const override { return {seen.box.longest_side() - (1 + strain)}; }

 private:
  double time_;
};

/// A step just below the limit increases the amplitude of an oscillation by 1/sqrt(1 - (omega dt)^2/4); the exact
/// amplitude is the strain.
TEST(Verify, WhatOnlyTheStepBringsForthIsAnArtefact) {
  constexpr double h = 1.9, dt = 0.001;  // h is omega dt; dt is in s
  double x = -strain, v = 0, furthest = 0;
  int when = 0;
  for (int step = 1; step < 200; ++step) {
    v -= h * h * x;
    x += v;
    if (x > furthest) furthest = x, when = step;
  }
  ASSERT_GT(furthest, 2.5 * strain);
  Experiment experiment = testing::read(walkers);
  experiment.scene = {};
  experiment.stepping.precision = Precision::float64;
  experiment.step = {.dt = dt};
  experiment.encoding = std::make_unique<StrainedPair>(h * h * mass / (2 * dt * dt));
  experiment.fitness.clear();
  experiment.fitness.push_back({std::make_unique<Stretch>(when * dt)});
  experiment.objectives = experiment.fitness[0].op->objectives();
  const auto simulator = simulator_for(experiment);
  const auto individuals = evaluated(experiment, *simulator, {Individual{}});
  ASSERT_EQ(individuals[0].result.status, Status::ok) << individuals[0].result.reason;
  EXPECT_NEAR(individuals[0].result.objectives[0], furthest, 1e-9);
  const Verification verification = verified(experiment, *simulator, individuals).front();
  EXPECT_LT(value(verification, "quarter-step"), 1.2 * strain);
  EXPECT_LT(value(verification, "other-method"), 1.2 * strain);
  const Marks found = marks(verification, true);
  EXPECT_NE(std::find(found.begin(), found.end(), "artefact"), found.end());
}

TEST(Verify, TheSameEveryTimeWhateverElseIsVerified) {
  const Experiment experiment = testing::read(testing::small_experiment);
  const auto simulator = simulator_for(experiment);
  std::vector<Individual> individuals = evaluated(experiment, *simulator, breed(experiment, {}, 0, 0, 12));
  std::erase_if(individuals, [](const Individual& i) { return i.result.status != Status::ok; });
  ASSERT_GE(individuals.size(), 2u);
  const auto together = verified(experiment, *simulator, individuals);
  for (std::size_t i = 0; i < individuals.size(); ++i) {
    const auto alone = verified(experiment, *simulator, {&individuals[i], 1});
    for (std::size_t t = 0; t < alone[0].trials.size(); ++t)
      EXPECT_EQ(alone[0].trials[t].value, together[i].trials[t].value) << alone[0].trials[t].name;
    EXPECT_EQ(value(together[i], "again"), individuals[i].result.objectives[0]) << "developed as in the run";
    EXPECT_NE(value(together[i], "perturbed-1"), value(together[i], "perturbed-2"));
  }
}

/// Without ground, the posture of a body determines its time step, as dashpots do.
TEST(Verify, ABodyThatNoOperatorChangesKeepsItsFitnessToo) {
  std::string swimmers = walkers;
  const std::size_t scene = swimmers.find("[scene.gravity]");
  swimmers.replace(scene, swimmers.find("[[fitness]]") - scene, "[scene.drag]\n[development]\ncycles = 3\n");
  for (const std::string damping : {"0", "0.8"}) {
    const Experiment experiment = testing::read(swimmers, {{"simulation.accuracy", "balanced", "--set"},
                                                           {"materials.muscle.damping", damping, "--set"},
                                                           {"fitness.0.settle", "0", ""},
                                                           {"fitness.0.window", "2", ""}});
    const auto simulator = simulator_for(experiment);
    std::vector<Individual> individuals = evaluated(experiment, *simulator, breed(experiment, {}, 0, 0, 6));
    std::erase_if(individuals, [](const Individual& i) { return i.result.status != Status::ok; });
    ASSERT_GE(individuals.size(), 3u);
    for (const Verification& swimmer : verified(experiment, *simulator, individuals))
      EXPECT_EQ(value(swimmer, "again"), swimmer.fitness) << "the same bits, with damping " << damping;
  }
}

TEST(Verify, RobotsThatDevelopAreBornAgain) {
  const auto reborn = [](const Verification& verification) {
    std::vector<std::optional<double>> values;
    for (const Trial& trial : verification.trials)
      if (trial.name.starts_with("reborn-")) values.push_back(trial.value);
    return values;
  };
  const auto best_of = [&](const Experiment& experiment) {
    const auto simulator = simulator_for(experiment);
    std::vector<Individual> individuals = evaluated(experiment, *simulator, breed(experiment, {}, 0, 0, 12));
    std::erase_if(individuals, [](const Individual& i) { return i.result.status != Status::ok; });
    return verified(experiment, *simulator, {&individuals.at(0), 1}).front();
  };
  const Experiment developing = testing::read(testing::small_experiment);  // with an operator that draws random numbers
  const auto values = reborn(best_of(developing));
  ASSERT_EQ(values.size(), 3u);
  EXPECT_NE(values[0], values[1]);
  EXPECT_NE(values[1], values[2]);
  EXPECT_EQ(reborn(best_of(developing)), values) << "the same every time";
  EXPECT_THAT(reborn(best_of(testing::read(walkers))), ::testing::IsEmpty()) << "that is what perturbed-1 to -3 are";
}

/// The cycles of its development change nothing.
TEST(Verify, AWalkerThatDrawsNoNumbersIsBornAgainAsOne) {
  const Verification walker = verified_best(testing::read(walkers + "[development]\ncycles = 2\n"));
  for (const char* trial : {"reborn-1", "reborn-2", "reborn-3"}) {
    EXPECT_NE(value(walker, trial), walker.fitness) << "it is perturbed";
    EXPECT_GT(value(walker, trial), walker.fitness / 2) << trial;
  }
}

/// A small run, and the folder with its archive.
struct SmallRun {
  testing::Scratch scratch;
  Experiment experiment = testing::read(testing::small_experiment);
  std::unique_ptr<Simulator> simulator = simulator_for(experiment);
  Archive archive = Archive::create(scratch / "run", experiment, simulator->device());

  SmallRun() {
    const std::atomic<bool> stop = false;
    evolve(experiment, *simulator, archive, stop, Observer{});
  }
};

TEST(Verify, WhatWasRecordedOfALifeHappensAgain) {
  SmallRun run;
  run.experiment.seed += 1;  // operators would draw other numbers
  std::size_t recorded = 0;
  for (const Verification& verification : verify_best(run.experiment, *run.simulator, run.archive, 24)) {
    if (!run.archive.life(verification.individual)) continue;
    ++recorded;
    EXPECT_EQ(value(verification, "again"), verification.fitness) << verification.individual;
  }
  EXPECT_GE(recorded, 2u);
}

TEST(Verify, WarnsOfLivesThatMayHaveDevelopedOtherwise) {
  SmallRun run;
  const auto warnings = [&](Simulator& simulator) {
    ::testing::internal::CaptureStderr();
    verify_best(run.experiment, simulator, run.archive, 24);
    return ::testing::internal::GetCapturedStderr();
  };
  EXPECT_EQ(warnings(*run.simulator), "");
  testing::Elsewhere elsewhere(run.experiment, "another device");
  const std::string warned = warnings(elsewhere);
  EXPECT_THAT(warned, testing::naming("on another device", "on " + run.simulator->device()));
  std::size_t unsure = 0, sure = 0;
  for (const std::uint32_t id : run.archive.best(24)) {
    const bool warns = warned.find("warning: individual " + std::to_string(id) + " ") != std::string::npos;
    EXPECT_EQ(warns, !run.archive.life(id).has_value()) << warned;
    ++(warns ? unsure : sure);
  }
  EXPECT_GT(unsure, 0u);
  EXPECT_GT(sure, 0u);
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
