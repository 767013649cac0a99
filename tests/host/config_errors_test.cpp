// Checks that all errors of an experiment are reported at once: each once, in the order of the file, and without errors
// that an earlier one has caused.
#include "experiment/config_errors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/experiments.hpp"
#include "support/messages.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using testing::at_place;
using ::testing::ElementsAre;
using testing::small_experiment;

/// Returns the messages of all errors of an experiment.
std::vector<std::string> errors_of(const std::string& text, std::vector<Override> overrides = {}) {
  std::vector<std::string> messages;
  try {
    testing::read(text, std::move(overrides));
  } catch (const ConfigErrors& errors) {
    EXPECT_TRUE(errors.is_complete);
    for (const ConfigError& error : errors.all) messages.emplace_back(error.what());
    EXPECT_EQ(errors.what(), messages.at(0));
  }
  return messages;
}

/// Returns the small experiment with the first occurrence of each text replaced.
std::string with(const std::vector<std::pair<std::string, std::string>>& changes) {
  std::string text = small_experiment;
  for (const auto& [from, to] : changes) {
    const auto at = text.find(from);
    if (at == std::string::npos) throw std::logic_error("the small experiment has no " + from);
    text.replace(at, from.size(), to);
  }
  return text;
}

TEST(ConfigErrors, AllOfAFileInItsOrder) {
  EXPECT_THAT(errors_of(with({{"evaluations = 24", "evalutions = 24"},
                              {"seed = 7", "seed = \"7\""},
                              {"size = [2, 1, 1]", "size = [2, 1]"},
                              {"edge = 0.5", "edge = -1\nmass = 0"},
                              {"\"two-point\"", "\"blend\""},
                              {"probability = 0.5", "probability = 5"},
                              {"[scene.damping]", "[scene.damping]\nrate = true"},
                              {"[development]", "dt = 1\n[development]"},
                              {"springs = 2", "springs = -2\nspring = 2\nfrom = 0"},
                              {"[selection]", "[sellection]"}})),
              ElementsAre(at_place("test.toml:3:8: experiment.seed = \"7\": ", "0 to 9007199254740991"),
                          at_place("test.toml:4:1: experiment.evalutions: ", "\"evaluations\""),
                          at_place("test.toml:10:8: encoding.size = [ 2, 1 ]: ", "three numbers"),
                          at_place("test.toml:11:8: encoding.edge = -1: ", "0.001 to 100 m"),
                          at_place("test.toml:12:8: encoding.mass = 0: ", "1e-09 to 1000000000 kg"),
                          at_place("test.toml:19:8: crossover.0.name = \"blend\": ", "two-point"),
                          at_place("test.toml:20:15: crossover.0.probability = 5: ", "0 to 1"),
                          at_place("test.toml:26:8: scene.damping.rate = true: ", "number"),
                          at_place("test.toml:31:6: simulation.dt = 1: ", "0.1 s"),
                          at_place("test.toml:38:11: development.operator.0.springs = -2: ", "1 to 1000000"),
                          at_place("test.toml:39:1: development.operator.0.spring: ", "\"springs\""),
                          at_place("test.toml:40:8: development.operator.0.from = 0: ", "1 to 16777215"),
                          at_place("test.toml:52:2: sellection: ", "\"selection\"")));
}

TEST(ConfigErrors, WhatDoesNotGoTogetherIsReportedBesideOtherErrors) {
  EXPECT_THAT(errors_of("[experiment]\n[encoding]\nname = 'voxel'\n[[fitness]]\nname = 'distanse'\n"
                        "[selection]\nname = 'elitist'\n"),
              ElementsAre(at_place("test.toml:1:1: mutation: ", "[[mutation]]", "[[crossover]]"),
                          at_place("test.toml:5:8: fitness.0.name = \"distanse\": ", "\"distance\"")));
  EXPECT_THAT(errors_of(with({{"random_individuals = 1", "random_individuals = 7"},
                              {"probability = 0.8", "probability = 0.8\nsections = [\"tissue\"]"},
                              {"[scene.floor]\n", ""},
                              {"threads = 2", "threads = -1\n[materials.muscel]\ndensity = 1"},
                              {"name = \"actuation-work\"", "name = \"distance\""}})),
              ElementsAre(at_place("test.toml:6:22: experiment.random_individuals = 7: ", "6"),
                          at_place("test.toml:16:12: mutation.0.sections = [ \"tissue\" ]: ", "voxel"),
                          at_place("test.toml:23:1: scene.friction = a table: ", "[scene.floor]"),
                          at_place("test.toml:27:11: simulation.threads = -1: ", "0 to 4096"),
                          at_place("test.toml:29:1: materials.muscel.density: ", "[materials.muscel]"),
                          at_place("test.toml:45:8: fitness.1.name = \"distance\": ", "label")));
  EXPECT_THAT(errors_of(with({{"cycle_time = 0.05", "cycle_time = 0.0507"},
                              {"settle = 0.05\nwindow = 0.1", "settle = 0.0502\nwindow = 0.1002"}})),
              ElementsAre(at_place("test.toml:31:14: development.cycle_time = 0.0507: ", "0.0005 s"),
                          at_place("test.toml:39:10: fitness.0.settle = 0.0502: ", "0.0005 s"),
                          at_place("test.toml:40:10: fitness.0.window = 0.1002: ", "0.0005 s")));
  EXPECT_THAT(errors_of(with({{"[[mutation]]\nname = \"reset-weight\"\nprobability = 0.8\n", ""},
                              {"\"age-fitness-pareto\"", "\"cma-es\""}})),
              ElementsAre(at_place("test.toml:14:1: crossover = a list with tables: ", "cma-es"),
                          at_place("test.toml:45:8: selection.name = \"cma-es\": ", "voxel")));
}

/// Each of these has one error. Others would follow from it if the reader knew no better.
TEST(ConfigErrors, NoneThatAnotherOneHasCaused) {
  const std::string scenario = "[[scenario]]\nname = \"icy\"\n";
  struct Case {
    std::string text, place;
  };
  for (const auto& [text, place] : std::vector<Case>{
           {with({{"\"voxel\"", "\"voxels\""}, {"probability = 0.8", "probability = 0.8\nsections = [\"voxel\"]"}}),
            "test.toml:9:8: encoding.name"},
           {with({{"[encoding]", "[encodin]"}}), "test.toml:8:2: encodin: "},
           {with({{"[[fitness]]", "[[fitnes]]"}, {"[[fitness]]", "[[fitnes]]"}}), "test.toml:37:3: fitnes: "},
           {with({{"name = \"distance\"", "name = \"distant\""}, {"\"actuation-work\"", "\"descriptor\""}}),
            "test.toml:38:8: fitness.0.name"},
           {with({{"population = 6", "populatoin = 60"}, {"random_individuals = 1", "random_individuals = 55"}}),
            "test.toml:5:1: experiment.populatoin: "},
           {with({{"[scene.floor]", "[scene.flor]"}}), "test.toml:22:8: scene.flor: "},
           {with({{"[scene.floor]\n", ""}}) + scenario, "test.toml:22:1: scene.friction"},
           {with({{"threads = 2", "dt = \"0.0001\""}, {"cycle_time = 0.05", "cycle_time = 0.0507"}}),
            "test.toml:27:6: simulation.dt"},
           {with({{"[simulation]", "[simulaton]"}, {"cycle_time = 0.05", "cycle_time = 0.0507"}}),
            "test.toml:26:2: simulaton: "},
           {with({{"[scene.floor]", "[scene.floor]\nstiffness = \"1e4\""}, {"threads = 2", "dt = 0.001"}}),
            "test.toml:23:13: scene.floor.stiffness"},
           {with({{"settle = 0.05", "over = \"icy\"\nsettle = 0.05"}}) + scenario + "repeat = 0\n",
            "test.toml:52:10: scenario.0.repeat"},
           {with({{"settle = 0.05", "over = \"icy\"\nsettle = 0.05"}}) + "[[scenari]]\nname = \"icy\"\n",
            "test.toml:50:3: scenari: "},
           {with({{"settle = 0.05", "over = \"icy\"\nsettle = 0.05"}}) + "[[scenario]]\nnmae = \"icy\"\n",
            "test.toml:51:1: scenario.0.nmae: "},
           {with({{"\"two-point\"", "\"of-my-own\""}}) + "[plugins]\npaths = [\"/no/such/folder\"]\n",
            "test.toml:50:9: plugins.paths"},
           {with({{"edge = 0.5", "materials = [\"rubber\"]"}}) + "[materials]\nrubber = 3\n",
            "test.toml:50:10: materials.rubber"},
           {with({{"springs = 2", "low = 2\nhigh = 1\nspring = 2"}, {"spring-turnover", "length-adaptation"}}),
            "test.toml:37:1: development.operator.0.spring: "},
           {with({{"[selection]\nname = \"age-fitness-pareto\"", ""},
                  {"[[mutation]]\nname = \"reset-weight\"\nprobability = 0.8\n", ""},
                  {"[[crossover]]\nname = \"two-point\"\nprobability = 0.5\n", ""},
                  {"seed = 7", "seed = 7\n"}}),
            "test.toml:1:1: selection: "},
           {"selection = 3\n" + with({{"[selection]\nname = \"age-fitness-pareto\"", ""}}),
            "test.toml:1:13: selection"},
           {"experiment = 3\n" +
                with({{"[experiment]\nseed = 7\nevaluations = 24\npopulation = 6\nrandom_individuals = 1\n", ""}}),
            "test.toml:1:14: experiment"}})
    EXPECT_THAT(errors_of(text), ElementsAre(at_place(place))) << text;
}

TEST(ConfigErrors, ThoseOfOptionsComeFirst) {
  EXPECT_THAT(errors_of(with({{"seed = 7", "seed = -1"}}), {{"fitness.0.window", "0", "--set fitness.0.window=0"},
                                                            {"scene.wind", "1", "--set scene.wind=1"}}),
              ElementsAre(at_place("--set scene.wind=1: scene.wind: ", "[scene]"),
                          at_place("--set fitness.0.window=0: fitness.0.window = 0: "),
                          at_place("test.toml:3:8: experiment.seed = -1: ")));
}

TEST(ConfigErrors, ASyntaxErrorEndsReading) {
  try {
    testing::read(with({{"seed = 7", "seed = -1"}, {"edge = 0.5", "edge = "}}));
    FAIL() << "it was read";
  } catch (const ConfigErrors&) {
    FAIL() << "a syntax error was collected";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), at_place("test.toml:11:"));
  }
}

TEST(ConfigErrors, VeryManyEndReading) {
  std::string text = small_experiment;
  for (int i = 0; i < 1000; ++i) text += "unknown" + std::to_string(i) + " = 1\n";
  try {
    testing::read(text);
    FAIL() << "it was read";
  } catch (const ConfigErrors& errors) {
    EXPECT_EQ(errors.all.size(), ErrorCollector::most);
    EXPECT_FALSE(errors.is_complete);
  }
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
