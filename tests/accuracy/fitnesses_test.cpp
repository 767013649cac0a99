// The fitness values in the study equal those that evolution uses.
#include "fitnesses.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "life/evaluation.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/scratch.hpp"

namespace evodevo::tools::accuracy::EVODEVO_FILE {
namespace {

TEST(Fitnesses, AreThoseOfAnEvaluation) {
  const Experiment experiment =
      evodevo::testing::read(evodevo::testing::small_experiment, {{"development.cycles", "0", ""}});
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
  const Evaluation evaluation(experiment, *simulator);
  std::vector<Genome> genomes;
  std::vector<Newborn> newborns;
  std::vector<Body> bodies;
  std::vector<double> expected;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Rng rng = experiment.context.rng(seed);
    genomes.push_back(experiment.encoding->random(experiment.layout, rng));
  }
  for (const Genome& genome : genomes) newborns.push_back({0, 0, &genome});
  const std::vector<Result> results = evaluation.evaluate(newborns, [](double) {});
  const std::vector<Life> lives = evaluation.birth.of(newborns);
  for (std::size_t i = 0; i < lives.size(); ++i)
    if (results[i].status == Status::ok) {
      bodies.push_back(lives[i].living.body);
      expected.push_back(results[i].objectives.front());
    }
  ASSERT_GE(bodies.size(), 5u);
  const Setting same{experiment.stepping.method, experiment.stepping.precision, *experiment.step.dt};
  const Fitnesses measured = measure(experiment, bodies, same, {"cpu", 1});
  EXPECT_EQ(measured.values, expected);
  EXPECT_EQ(measured.diverged, 0);
  EXPECT_GT(measured.cost, 0);
}

TEST(Fitnesses, OfExperimentsThatAskForMoreAreRefused) {
  const evodevo::testing::Scratch scratch;
  const auto complaint = [&](const std::string& fitness, std::vector<Override> overrides = {}) -> std::string {
    std::string text = evodevo::testing::small_experiment;
    const std::string distance = "name = \"distance\"";
    text.replace(text.find(distance), distance.size(), fitness);
    try {
      measurable_experiment(scratch.write("robots.toml", text), std::move(overrides));
      return "";
    } catch (const ConfigError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(complaint("name = \"distance\""), "");
  for (const char* other : {"name = \"straightness\"\nrate = 100", "name = \"jump\"\nrate = 100",
                            "name = \"efficiency\"", "name = \"descriptor\"\nwhat = \"masses\""})
    EXPECT_THAT(complaint(other), evodevo::testing::naming("robots.toml", "fitness.0", "\"distance\""));
  EXPECT_THAT(complaint("name = \"distance\"", {{"encoding.pointz", "48", ""}}),
              evodevo::testing::naming("robots.toml with encoding.pointz = 48: ", "encoding.pointz"));
}

TEST(Fitnesses, OfWhatDivergesAreNoNumbers) {
  const Experiment experiment = evodevo::testing::read(evodevo::testing::small_experiment);
  Body body;
  body.materials = {{1e9, 0, 0, 0}};
  body.masses = {{{0, 0, 0}, 0.2}, {{1, 0, 0}, 0.2}};
  body.springs = {{0, 1, 1.1, 0}};
  const Fitnesses measured = measure(experiment, {&body, 1}, {}, {"cpu", 1});
  EXPECT_TRUE(std::isnan(measured.values[0]));
  EXPECT_EQ(measured.diverged, 1);
}

}  // namespace
}  // namespace evodevo::tools::accuracy::EVODEVO_FILE
