// Checks that every error message about an experiment contains the place, the value and the remedy.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <fstream>
#include <tuple>

#include "experiment/tables/reference.hpp"
#include "experiment/toml_reader.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using testing::small_experiment;

/// Returns the error message of reading `text`.
std::string complaint(const std::string& text, std::vector<Override> overrides = {}) {
  try {
    testing::read(text, std::move(overrides));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no complaint";
}

/// Returns the small experiment with the first occurrence of `from` replaced.
std::string with(const std::string& from, const std::string& to) {
  std::string text = small_experiment;
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("the small experiment has no " + from);
  return text.replace(at, from.size(), to);
}

TEST(Configuration, TheSmallExperimentIsRead) {
  const Experiment experiment = testing::read(small_experiment);
  EXPECT_EQ(experiment.seed, 7);
  EXPECT_EQ(experiment.evaluations, 24);
  EXPECT_EQ(experiment.name, "test");
  EXPECT_EQ(experiment.layout.first_size(), 2u);
  EXPECT_EQ(experiment.mutations.at(0).probability, 0.8);
  EXPECT_TRUE(experiment.scene.floor.has_value());
  EXPECT_FALSE(experiment.scene.drag.has_value());
  EXPECT_EQ(experiment.development.cycles, 2);
  ASSERT_EQ(experiment.objectives.size(), 2u);
  EXPECT_EQ(experiment.objectives[0].name, "distance");
  EXPECT_FALSE(experiment.objectives[1].maximise);
}

/// Returns the section of the reference under a heading.
std::string reference_under(const std::string& heading) {
  const std::string reference = experiment_reference(), whole = "### `" + heading + "`\n";
  const std::size_t begin = reference.find(whole);
  if (begin == std::string::npos) return "";
  return reference.substr(begin, reference.find("\n### ", begin) - begin);
}

TEST(Configuration, TheReferenceHasEveryKeyThatARunRecords) {
  const Experiment experiment =
      testing::read(small_experiment + "[scene.drag]\n[scene.payload]\n[[scenario]]\nname = 'uphill'\n");
  const toml::table recorded = toml::parse(experiment.resolved);
  int keys = 0;
  const auto expect_keys = [&](const toml::table& table, const std::string& heading, const std::string& prefix = "") {
    for (const auto& [key, value] : table) {
      if (value.is_table() || value.is_array_of_tables()) continue;
      EXPECT_THAT(reference_under(heading), ::testing::HasSubstr("\n| `" + prefix + std::string(key.str()) + "` | `"));
      ++keys;
    }
  };
  for (const std::string name : {"experiment", "simulation", "development"})
    expect_keys(*recorded[name].as_table(), "[" + name + "]");
  for (const auto& [force, table] : *recorded["scene"].as_table())
    expect_keys(*table.as_table(), "[scene]", std::string(force.str()) + ".");
  expect_keys(*recorded["materials"]["bone"].as_table(), "[materials.NAME]");
  toml::table scenario = *recorded["scenario"][0].as_table();
  scenario.erase("name");
  expect_keys(scenario, "[[scenario]]");
  EXPECT_GE(keys, 8 + 9 + 6 + 11 + 5 + 5);
}

TEST(Configuration, DevelopmentHasSchedulesAndAControl) {
  const Experiment plain = testing::read(small_experiment);
  EXPECT_EQ(plain.development.control, Control::off);
  const Schedule& always = plain.devo.at(0).schedule;
  EXPECT_EQ(std::tuple(always.from, always.to, always.every), std::tuple(1, 2, 1));
  for (const auto& [name, control] : {std::pair{"off", Control::off},
                                      {"no-change", Control::no_change},
                                      {"random-places", Control::random_places},
                                      {"shuffled-stress", Control::shuffled_stress}})
    EXPECT_EQ(testing::read(small_experiment, {{"development.control", name, ""}}).development.control, control);
  EXPECT_THAT(complaint(with("cycles = 2", "cycles = 2\ncontrol = \"shuffled\"")),
              testing::at_place("test.toml:31:11: development.control = \"shuffled\": ",
                                "off, no-change, random-places, shuffled-stress"));
  EXPECT_THAT(complaint(with("springs = 2", "every = 0")),
              testing::at_place("test.toml:35:9: development.operator.0.every = 0: ", "1 to 16777215"));
  const Experiment never = testing::read(small_experiment, {{"development.operator.0.from", "3", ""}});
  ASSERT_EQ(never.warnings.size(), 1u);
  EXPECT_THAT(never.warnings[0], testing::at_place("development.operator.0.from = 3", "2", "never applied"));
}

TEST(Configuration, GrowthWithoutSizesWarns) {
  const std::string encoding = "name = \"voxel\"\nsize = [2, 1, 1]\nedge = 0.5";
  const auto warnings = [&](const std::string& other, std::vector<Override> overrides = {}) {
    std::string text = with("name = \"spring-turnover\"\nsprings = 2", "name = \"ballistic-growth\"");
    text.replace(text.find(encoding), encoding.size(), "name = \"" + other + "\"");
    return testing::read(text, std::move(overrides)).warnings;
  };
  for (const char* name : {"voxel", "direct", "neural", "cppn"})
    EXPECT_THAT(warnings(name), ::testing::ElementsAre(testing::at_place(
                                    "development.operator.0.name = \"ballistic-growth\": ", "encoding.size_range")))
        << name;
  for (const char* name : {"voxel", "neural", "cppn"})
    EXPECT_THAT(warnings(name, {{"encoding.size_range", "0.25", ""}}), ::testing::IsEmpty()) << name;
}

TEST(Configuration, DevelopmentWithoutOperatorsWarnsAndHasNoControl) {
  std::string text = small_experiment;
  const std::size_t first = text.find("[[development.operator]]");
  text.erase(first, text.find("[[fitness]]") - first);
  const Experiment still = testing::read(text);
  ASSERT_EQ(still.warnings.size(), 1u);
  EXPECT_THAT(still.warnings[0],
              testing::at_place("development.cycles = 2: ", "[[development.operator]]", "[development]"));
  EXPECT_TRUE(testing::read(text, {{"development.cycles", "0", "--set"}}).warnings.empty());
  for (const char* control : {"no-change", "random-places", "shuffled-stress"})
    EXPECT_THAT(complaint(text, {{"development.control", control, "--set"}}),
                testing::naming("development.control = \"" + std::string(control) + "\": ", "[[development.operator]]",
                                "control = \"off\""));
}

TEST(Configuration, DevelopmentHasAProbe) {
  const Experiment exact = testing::read(small_experiment);
  EXPECT_EQ(exact.development.probe, Probe::exact);
  const std::string tallied = with("cycles = 2", "cycles = 2\nprobe = \"skip-shift\"");
  const Experiment paper = testing::read(tallied);
  EXPECT_EQ(paper.development.probe, Probe::skip_shift);
  EXPECT_EQ(paper.development.skip, 100);
  EXPECT_THAT(complaint(with("cycles = 2", "cycles = 2\nprobe = \"skip-shift\"\nskip = 101")),
              testing::at_place("test.toml:32:8: development.skip = 101: ", "100 steps"));
  EXPECT_THAT(complaint(tallied, {{"development.operator.0.by", "peak", ""}}),
              testing::naming("development.operator.0.name", "skip-shift", "development.probe = \"exact\""));
}

TEST(Configuration, WhatDoesNotGoTogetherIsReportedAtItsKey) {
  EXPECT_THAT(complaint(with("springs = 2", "low = 0.9\nhigh = 0.8"),
                        {{"development.operator.0.name", "length-adaptation", ""}}),
              testing::at_place("test.toml:35:7: development.operator.0.low = 0.9: ", "high"));
}

TEST(Configuration, ResolvedTextReadsBackAsItself) {
  const Experiment experiment = testing::read(small_experiment, {{"simulation.dt", "0.00025", "--set"}});
  const Experiment again = testing::read(experiment.resolved);
  EXPECT_EQ(again.resolved, experiment.resolved);
  EXPECT_EQ(again.step.dt, 0.00025);
  EXPECT_EQ(again.seed, experiment.seed);
  EXPECT_EQ(again.context.materials, experiment.context.materials);
}

TEST(Configuration, ResolvedTextHoldsEveryDefault) {
  const std::string resolved = testing::read(small_experiment).resolved;
  for (const char* key :
       {"stiffness = 1000000", "coefficient = 0.5", "rate = 20.1", "acceleration = 9.8", "dt = 0.0005",
        "precision = 'float'", "method = 'paper-euler'", "reset = false", "mass = 0.2"})
    EXPECT_NE(resolved.find(key), std::string::npos) << key << " is not in\n" << resolved;
}

TEST(Configuration, AMethodByItsName) {
  for (const std::string_view method : method_names) {
    const Experiment experiment =
        testing::read(small_experiment, {{"simulation.method", std::string(method), "--set"}});
    EXPECT_EQ(name(experiment.stepping.method), method);
    EXPECT_NE(experiment.resolved.find("method = '" + std::string(method) + "'"), std::string::npos);
  }
  EXPECT_THAT(complaint(with("[simulation]", "[simulation]\nmethod = \"rk5\"")),
              testing::at_place("test.toml:27:10: simulation.method = \"rk5\": ", "\"rk4\""));
}

TEST(Configuration, AccuracyChoosesWhatIsLeftOut) {
  const auto read = [](const std::string& keys) {
    return testing::read(with("[simulation]", "[simulation]\n" + keys));
  };
  const auto expect = [](const Experiment& e, Method method, Precision precision, std::optional<double> dt) {
    EXPECT_EQ(e.stepping.method, method);
    EXPECT_EQ(e.stepping.precision, precision);
    EXPECT_EQ(e.step.dt, dt);
    const Experiment again = testing::read(e.resolved);
    EXPECT_EQ(again.resolved, e.resolved);
    EXPECT_EQ(again.stepping.method, method);
    EXPECT_EQ(again.step.dt, dt);
  };
  expect(read(""), Method::paper_euler, Precision::float32, 0.0005);
  expect(read("accuracy = \"fast\""), Method::symplectic_euler, Precision::float32, std::nullopt);
  expect(read("accuracy = \"balanced\""), Method::velocity_verlet, Precision::float32, std::nullopt);
  expect(read("accuracy = \"reference\""), Method::rk4, Precision::float64, std::nullopt);
  EXPECT_EQ(read("accuracy = \"reference\"").step.refine, 4);
  expect(read("accuracy = \"reference\"\nmethod = \"velocity-verlet\"\ndt = 0.00025"), Method::velocity_verlet,
         Precision::float64, 0.00025);
  EXPECT_NE(read("accuracy = \"fast\"").resolved.find("dt = 'auto'"), std::string::npos);
  EXPECT_NE(read("accuracy = \"fast\"").resolved.find("method = 'symplectic-euler'"), std::string::npos);
  EXPECT_THAT(
      complaint(with("[simulation]", "[simulation]\naccuracy = \"best\"")),
      testing::at_place("test.toml:27:12: simulation.accuracy = \"best\": ", "paper, fast, balanced, reference"));
}

TEST(Configuration, MaterialsAreComputedWhereThatIsAskedForAndPossible) {
  const auto with_keys = [](const std::string& keys) { return with("[simulation]", "[simulation]\n" + keys); };
  EXPECT_EQ(testing::read(small_experiment).stepping.materials, Materials::table);
  const Experiment computed = testing::read(with_keys("materials = \"computed\"\naccuracy = \"fast\""));
  EXPECT_EQ(computed.stepping.materials, Materials::computed);
  EXPECT_EQ(computed.stepping.method, Method::symplectic_euler);
  EXPECT_EQ(testing::read(computed.resolved).stepping.materials, Materials::computed);
  EXPECT_THAT(complaint(with_keys("materials = \"computer\"")),
              testing::at_place("test.toml:27:13: simulation.materials = \"computer\": ", "table, computed"));
  for (const char* other : {"precision = \"double\"", "method = \"xpbd\"", "accuracy = \"reference\""})
    EXPECT_THAT(complaint(with_keys("materials = \"computed\"\n" + std::string(other))),
                testing::at_place("test.toml:27:13: simulation.materials = \"computed\": ", "\"table\"", "method",
                                  "precision", "accuracy"));
}

TEST(Configuration, AStepOfItsOwnForEveryBody) {
  const std::string automatic = with("[simulation]", "[simulation]\ndt = \"auto\"");
  const Experiment experiment =
      testing::read(automatic, {{"scene.floor.stiffness", "1e11", ""}, {"development.cycle_time", "0.0507", ""}});
  EXPECT_FALSE(experiment.step.dt.has_value()) << "whatever the scene, and for any duration";
  EXPECT_EQ(testing::read(small_experiment, {{"simulation.dt", "auto", "--set"}}).resolved.find("dt = 0"),
            std::string::npos);
  EXPECT_THAT(complaint(with("[simulation]", "[simulation]\ndt = \"automatic\"")),
              testing::at_place("test.toml:27:6: simulation.dt = \"automatic\": ", "number", "\"auto\""));
  EXPECT_THAT(complaint(automatic, {{"simulation.method", "implicit", ""}}),
              testing::at_place("test.toml:27:6: simulation.dt = \"auto\": ", "\"implicit\"", "number"));
  EXPECT_EQ(complaint(with("[simulation]", "[simulation]\ndt = 0.001\nrefine = 2")), "no complaint")
      << "half of it is borne";
}

TEST(Configuration, TheLargestStepIsThatOfTheMethod) {
  // for two masses on a spring of bone, without a floor, dt may be up to 6.3 ms for methods with a limit of omega dt =
  // 2, and 8.9 ms for 2 sqrt(2)
  const std::string airborne = with("[scene.floor]\n[scene.friction]\n", "");
  const auto objection = [&](const char* method, const char* dt) {
    std::vector<Override> overrides{{"simulation.method", method, "--set"}, {"simulation.dt", dt, "--set"}};
    for (const char* time :
         {"development.cycle_time", "fitness.0.settle", "fitness.0.window", "fitness.1.settle", "fitness.1.window"})
      overrides.push_back({time, "0.4", "--set"});
    return complaint(airborne, overrides);
  };
  EXPECT_EQ(objection("velocity-verlet", "0.005"), "no complaint");
  EXPECT_THAT(objection("velocity-verlet", "0.008"),
              testing::naming("simulation.dt = 0.008: ", "stiffness", "at most"));
  EXPECT_EQ(objection("rk4", "0.008"), "no complaint");
  EXPECT_THAT(objection("rk4", "0.01"), testing::naming("simulation.dt = 0.01: ", "stiffness", "at most"));
  EXPECT_EQ(objection("implicit", "0.01"), "no complaint");
  EXPECT_EQ(objection("xpbd", "0.01"), "no complaint");
}

TEST(Configuration, UnknownKeys) {
  EXPECT_THAT(complaint(with("evaluations", "evalutions")),
              testing::at_place("test.toml:4:1: experiment.evalutions: ", "\"evaluations\""));
  EXPECT_THAT(complaint(with("[selection]", "[sellection]")),
              testing::at_place("test.toml:47:2: sellection: ", "\"selection\""));
  EXPECT_THAT(
      complaint(small_experiment + "\n[wind]\n"),
      testing::at_place("test.toml:50:2: wind: ",
                        "experiment, encoding, mutation, crossover, scene, simulation, development, fitness, scenario, "
                        "selection, materials, islands, island, plugins"));
  EXPECT_THAT(complaint(with("[scene.floor]", "[scene.flor]")),
              testing::at_place("test.toml:22:8: scene.flor: ", "[scene]", "\"floor\""));
  EXPECT_THAT(complaint(with("edge = 0.5", "edgy = 0.5")),
              testing::at_place("test.toml:11:1: encoding.edgy: ", "[encoding]", "\"edge\""));
  EXPECT_THAT(
      complaint(with("springs = 2", "spring = 2")),
      testing::at_place("test.toml:35:1: development.operator.0.spring: ", "[development.operator.0]", "\"springs\""));
}

TEST(Configuration, WrongTypes) {
  EXPECT_THAT(complaint(with("seed = 7", "seed = \"7\"")),
              testing::at_place("test.toml:3:8: experiment.seed = \"7\": ", "whole number", "0 to 9007199254740991"));
  EXPECT_THAT(complaint(with("seed = 7", "seed = 7.5")),
              testing::at_place("test.toml:3:8: experiment.seed = 7.5: ", "whole number", "0 to 9007199254740991"));
  EXPECT_THAT(complaint(with("edge = 0.5", "edge = true")),
              testing::at_place("test.toml:11:8: encoding.edge = true: ", "number", "0.001 to 100 m"));
  EXPECT_THAT(complaint(with("size = [2, 1, 1]", "size = [2, 1]")),
              testing::at_place("test.toml:10:8: encoding.size = [ 2, 1 ]: ", "three numbers"));
  EXPECT_THAT(complaint(with("cycles = 2", "reset = 1")),
              testing::at_place("test.toml:30:9: development.reset = 1: ", "true or false"));
  EXPECT_THAT(complaint(with("[scene.gravity]\n[scene.floor]", "[scene]\nfloor = 3\n[scene.gravity]")),
              testing::at_place("test.toml:22:9: scene.floor = 3: ", "[scene.floor]"));
  EXPECT_THAT(complaint(with("[[mutation]]", "[mutation]")),
              testing::at_place("test.toml:13:1: mutation = a table: ", "[[mutation]]"));
  EXPECT_THAT(complaint(with("name = \"voxel\"", "name = 1")),
              testing::at_place("test.toml:9:8: encoding.name = 1: ", "quotes"));
}

TEST(Configuration, OutOfRange) {
  EXPECT_THAT(complaint(with("evaluations = 24", "evaluations = 0")),
              testing::at_place("test.toml:4:15: experiment.evaluations = 0: ", "1 to 1000000000"));
  EXPECT_THAT(complaint(with("edge = 0.5", "edge = -1")),
              testing::at_place("test.toml:11:8: encoding.edge = -1: ", "0.001 to 100 m"));
  EXPECT_THAT(complaint(with("probability = 0.8", "probability = 1.1")),
              testing::at_place("test.toml:15:15: mutation.0.probability = 1.1: ", "0 to 1"));
  EXPECT_THAT(complaint(with("probability = 0.8", "probability = nan")),
              testing::at_place("test.toml:15:15: mutation.0.probability = nan: ", "0 to 1"));
  EXPECT_THAT(complaint(with("[simulation]", "[simulation]\ndt = 0.2")),
              testing::at_place("test.toml:27:6: simulation.dt = 0.2: ", "1e-07 to 0.1 s"));
  EXPECT_THAT(complaint(with("random_individuals = 1", "random_individuals = 7")),
              testing::at_place("test.toml:6:22: experiment.random_individuals = 7: ", "population", "6"));
  EXPECT_THAT(complaint(with("[simulation]", "[simulation]\ndevice = \"tpu\"")),
              testing::at_place("test.toml:27:10: simulation.device = \"tpu\": ", "auto, cpu, cuda"));
}

TEST(Configuration, AtMostAThousandMaterialsAndPaths) {
  std::string materials, paths = "'a'";
  for (int i = 0; i < 1001; ++i) materials += "[materials.m" + std::to_string(i) + "]\nstiffness = 100\n";
  for (int i = 0; i < 1000; ++i) paths += ", 'a'";
  EXPECT_THAT(complaint(std::string(small_experiment) + materials), testing::naming("materials", "at most 1000"));
  EXPECT_THAT(complaint(std::string(small_experiment) + "[plugins]\npaths = [" + paths + "]\n"),
              testing::naming("plugins.paths", "at most 1000"));
}

TEST(Configuration, WholeNumbersMayHaveAPointOrAnExponent) {
  const auto read = [](const std::string& key, const std::string& value) {
    return testing::read(testing::small_experiment, {{key, value, "--set"}});
  };
  EXPECT_EQ(read("experiment.population", "7.0").population, 7);
  EXPECT_EQ(read("experiment.evaluations", "1e3").evaluations, 1000);
  EXPECT_EQ(read("experiment.random_individuals", "-0.0").random_individuals, 0);
  EXPECT_EQ(read("experiment.seed", "9007199254740991.0").seed, 9007199254740991);
  EXPECT_EQ(read("experiment.population", "7.0").resolved, read("experiment.population", "7").resolved);
  EXPECT_EQ(read("encoding.size", "[3.0, 2, 1e0]").layout.first_size(), 6u);
  EXPECT_THAT(complaint(with("population = 6", "population = 6.5")),
              testing::at_place("test.toml:5:14: experiment.population = 6.5: ", "whole number", "1 to 1000000"));
  EXPECT_THAT(complaint(with("size = [2, 1, 1]", "size = [2, 1.5, 1]")),
              testing::at_place("test.toml:10:12: encoding.size = 1.5: ", "whole number", "1 to 32"));
  EXPECT_THAT(complaint(small_experiment, {{"experiment.population", "99999999999999999999", "--set"}}),
              ::testing::AllOf(::testing::HasSubstr("experiment.population"),
                               ::testing::HasSubstr("99999999999999999999"), ::testing::HasSubstr("64 bits")));
  EXPECT_THAT(complaint(with("population = 6", "population = 1e300")),
              testing::at_place("test.toml:5:14: experiment.population = 1e+300: ", "1 to 1000000"));
  EXPECT_THAT(complaint(with("population = 6", "population = \"6\"")),
              testing::at_place("test.toml:5:14: experiment.population = \"6\": ", "whole number", "1 to 1000000"));
}

TEST(Configuration, NumbersThatAreNotFiniteAreRefusedWhereverTheyStand) {
  for (const char* value : {"nan", "-nan", "+nan", "inf", "-inf"})
    for (const char* key : {"experiment.population", "experiment.spring_evaluations", "encoding.edge", "encoding.size",
                            "mutation.0.probability", "mutation.0.genes", "scene.gravity.slope", "simulation.dt",
                            "simulation.refine", "development.cycle_time", "development.operator.0.from",
                            "fitness.0.window", "fitness.0.direction", "materials.bone.phase"}) {
      const bool is_list = std::string(key).ends_with("size") || std::string(key).ends_with("direction");
      const std::string text = is_list ? "[1, " + std::string(value) + ", 1]" : value;
      try {
        testing::read(testing::small_experiment, {{key, text, "--set"}});
        ADD_FAILURE() << key << " = " << text << " was accepted";
      } catch (const ConfigError& error) {
        EXPECT_THAT(error.what(), ::testing::HasSubstr(std::string("--set: ") + key + " = "));
        EXPECT_THAT(error.what(), ::testing::ContainsRegex(": expected (a|[0-9-])")) << "what would be right";
        EXPECT_THAT(error.what(), ::testing::Not(::testing::ContainsRegex("nan +[a-zA-Z]|at (least|most) $")));
      }
    }
}

/// Tests a parameter that may have any finite value, and parameters with a bound on one side.
TEST(Configuration, ARangeWithoutAnEndAsksForAFiniteNumber) {
  const auto complaint_of = [](const std::string& text, Range range) -> std::string {
    const toml::table table = parse_toml(text, "x");
    TomlReader reader(table, "t");
    double value = 0;
    try {
      reader.real(value, "a", range, "");
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "accepted";
  };
  const double none = std::numeric_limits<double>::infinity();
  EXPECT_THAT(complaint_of("a = nan", {}), testing::at_place("x:1:5: t.a = nan: ", "finite number"));
  EXPECT_THAT(complaint_of("a = inf", {0, none, "s"}),
              testing::at_place("x:1:5: t.a = inf: ", "finite number", "at least 0 s"));
  EXPECT_THAT(complaint_of("a = -inf", {-none, 3}),
              testing::at_place("x:1:5: t.a = -inf: ", "finite number", "at most 3"));
  EXPECT_EQ(complaint_of("a = -1e308", {}), "accepted");
}

TEST(Configuration, UnknownOperators) {
  EXPECT_THAT(complaint(with("\"voxel\"", "\"voxels\"")),
              testing::at_place("test.toml:9:8: encoding.name = \"voxels\": ", "encoding operator", "\"voxel\""));
  EXPECT_THAT(complaint(with("\"two-point\"", "\"blend\"")),
              testing::at_place("test.toml:18:8: crossover.0.name = \"blend\": ", "crossover operator",
                                "swap-neuron, two-point", "[plugins] paths", "--plugin-path"));
}

TEST(Configuration, UnknownMaterials) {
  EXPECT_THAT(
      complaint(with("edge = 0.5", "materials = [\"muscle\", \"bones\"]")),
      testing::at_place("test.toml:11:13: encoding.materials = [ \"muscle\", \"bones\" ]: ", "\"bones\"", "\"bone\""));
}

TEST(Configuration, AMaterialNamedTwice) {
  EXPECT_THAT(complaint(with("edge = 0.5", "materials = [\"bone\", \"bone\"]")),
              testing::at_place("test.toml:11:13: encoding.materials = [ \"bone\", \"bone\" ]: ", "\"bone\" twice"));
}

TEST(Configuration, WarnsOfWhatMayNotBeMeant) {
  EXPECT_TRUE(testing::read(small_experiment).warnings.empty());
  EXPECT_THAT(testing::read(small_experiment + "\n[materials.muscel]\nstiffness = 3\n").warnings,
              ::testing::ElementsAre(testing::naming("[materials.muscel]", "new material", "\"muscle\"")));
  const testing::Scratch scratch;
  const std::string library = scratch.write("junk.evodevo.so", "this is no library");
  const auto warnings =
      testing::read(small_experiment + "\n[plugins]\npaths = ['" + (scratch / "").string() + "']\n").warnings;
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0], testing::naming(library + ": "));
}

TEST(Configuration, MaterialsOfOnesOwn) {
  const std::string own =
      small_experiment + "\n[materials.rubber]\nstiffness = 800\n[materials.muscle]\namplitude = 0\n";
  const Experiment experiment = testing::read(own);
  const auto index = experiment.context.material_indices({"rubber", "muscle"});
  ASSERT_EQ(index.size(), 2u);
  EXPECT_EQ(experiment.context.materials[static_cast<std::size_t>(index[0])], (Material{5000, 0, 1, 0}));
  EXPECT_EQ(experiment.context.materials[static_cast<std::size_t>(index[1])], (Material{800, 0, 0, 0}));
  EXPECT_THAT(complaint(small_experiment + "\n[materials.rubber]\nstifness = 800\n"),
              testing::at_place("test.toml:51:1: materials.rubber.stifness: ", "[materials.rubber]", "\"stiffness\""));
}

TEST(Configuration, MissingParts) {
  EXPECT_THAT(complaint(""), testing::at_place("test.toml:1:1: experiment: ", "missing", "[experiment]"));
  EXPECT_THAT(complaint(with("name = \"voxel\"", "")), testing::at_place("test.toml:8:1: encoding.name: ", "missing"));
  const std::string begun = "[experiment]\n[encoding]\nname = 'voxel'\n";
  EXPECT_THAT(complaint(begun), testing::at_place("test.toml:1:1: fitness: ", "missing", "[[fitness]]"));
  const std::string scored = begun + "[[fitness]]\nname = 'distance'\n";
  EXPECT_THAT(complaint(scored), testing::at_place("test.toml:1:1: selection: ", "missing", "[selection]"));
  EXPECT_THAT(complaint(scored + "[selection]\nname = 'elitist'\n"),
              testing::at_place("test.toml:1:1: mutation: ", "missing", "[[mutation]]", "[[crossover]]"));
}

TEST(Configuration, ItsOwnOperatorsComeBeforeThoseBuiltIn) {
  const std::string folder = std::string(EVODEVO_FAULTY_PLUGINS) + "/taken_name";
  const Experiment experiment = testing::read(small_experiment + "\n[plugins]\npaths = ['" + folder + "']\n");
  EXPECT_EQ(experiment.uses.at(2).name, "reset-weight");
  EXPECT_EQ(experiment.uses.at(2).file.parent_path(), folder);
  ASSERT_EQ(experiment.warnings.size(), 1u);
  EXPECT_THAT(experiment.warnings[0],
              testing::naming("reset-weight.evodevo.so: ", "mutation operator \"reset-weight\""));
}

TEST(Configuration, ContradictoryParts) {
  EXPECT_THAT(complaint(small_experiment + "\n[plugins]\npaths = ['/no/such/folder']\n"),
              testing::at_place("test.toml:51:9: plugins.paths = [ \"/no/such/folder\" ]: ", "folder", "library"));
  EXPECT_THAT(complaint(small_experiment, {{"mutation.0.probability", "0", ""}, {"crossover.0.probability", "0", ""}}),
              testing::at_place("test.toml:13:1: mutation = a list with tables: ", "probability above 0"));
  EXPECT_THAT(
      complaint(with("[scene.floor]", "")),
      testing::at_place("test.toml:23:1: scene.friction = a table: ", "add [scene.floor]", "remove [scene.friction]"));
  EXPECT_THAT(complaint(with("[scene.friction]", "[scene.friction]\nstatic = 0.4")),
              testing::at_place("test.toml:24:10: scene.friction.static = 0.4: ", "at least", "0.5"));
  EXPECT_THAT(complaint(with("\"actuation-work\"", "\"distance\"")),
              testing::at_place("test.toml:43:8: fitness.1.name = \"distance\": ", "\"distance\"", "label"));
}

TEST(Configuration, StepsThatTheSceneOrAMaterialCannotBear) {
  EXPECT_THAT(complaint(with("[simulation]", "[simulation]\ndt = 0.001")),
              testing::at_place("test.toml:27:6: simulation.dt = 0.001: ", "scene.floor.stiffness = 1000000 N/m",
                                "masses of 0.2 kg", "at most 0.0005366563145999495 s"));
  EXPECT_TRUE(testing::read(with("[simulation]", "[simulation]\ndt = 0.001"), {{"scene.floor.restitution", "0.2", ""}})
                  .scene.floor->rigid())
      << "contact with a rigid floor limits no step";
  EXPECT_THAT(complaint(with("[simulation]", "[materials.bone]\nstiffness = 1e7\n[simulation]\ndt = 0.0005")),
              testing::at_place("test.toml:29:6: simulation.dt = 0.0005: ", "materials.bone.stiffness = 10000000 N/m",
                                "masses of 0.2 kg", "at most 0.0002 s"));
  EXPECT_THAT(
      complaint(with("[simulation]\nthreads = 2", "[scene.drag]"), {{"scene.floor.stiffness", "1e9", ""}}),
      testing::at_place("test.toml:1:1: simulation.dt: ", "0.0005 s", "scene.floor.stiffness = 1000000000 N/m"));
  EXPECT_THAT(complaint(with("[simulation]", "[materials.muscle]\nfrequency = 1999\n[simulation]\ndt = 0.0005")),
              testing::at_place("test.toml:29:6: simulation.dt = 0.0005: ", "materials.muscle.frequency = 1999 Hz",
                                "at most 0.0002501250625312656 s"));
  EXPECT_THAT(complaint(with("cycle_time = 0.05", "cycle_time = 0.0507")),
              testing::at_place("test.toml:31:14: development.cycle_time = 0.0507: ", "0.0005 s", "0.0505 s"));
}

TEST(Configuration, AFloorIsElasticOrRigidAndAScenarioMayChangeThat) {
  EXPECT_THAT(complaint(with("[scene.floor]", "[scene.floor]\nstiffness = 1e4\nrestitution = 0.2")),
              testing::at_place("test.toml:24:15: scene.floor.restitution = 0.2: ", "scene.floor.stiffness"));
  const auto scenario_of = [](const std::string& floor, const std::string& scenario) {
    const std::string other = "\n[[scenario]]\nname = \"other\"\n[scenario.floor]\n" + scenario;
    return testing::read(with("[scene.floor]", "[scene.floor]\n" + floor) + other).scenarios.at(0).scene.floor.value();
  };
  EXPECT_EQ(scenario_of("restitution = 0.2", "roughness = 0.1").restitution, 0.2);
  const Floor soft = scenario_of("restitution = 0.2", "stiffness = 1e4");
  EXPECT_FALSE(soft.rigid());
  EXPECT_EQ(soft.stiffness, 1e4);
  EXPECT_EQ(scenario_of("stiffness = 1e4", "restitution = 0.3").restitution, 0.3);
}

TEST(Configuration, SyntaxAndFiles) {
  EXPECT_EQ(complaint(with("seed = 7", "seed = ")).substr(0, 14), "test.toml:3:8:");
  const auto from_file = [](const std::string& file) -> std::string {
    try {
      read_experiment(ExperimentSource{file, {}});
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "no complaint";
  };
  EXPECT_THAT(from_file("no/such/file.toml"),
              testing::at_place("no/such/file.toml: cannot be read: ", "No such file or directory"));
  EXPECT_THAT(from_file("/"), testing::at_place("/: cannot be read: ", "folder"));
}

TEST(Configuration, TheSeedOfRoughGroundHas32Bits) {
  const auto seeded = [](const std::string& seed) { return with("[scene.floor]", "[scene.floor]\nseed = " + seed); };
  EXPECT_EQ(testing::read(seeded("4294967295")).scene.floor->seed, 4294967295);
  EXPECT_THAT(complaint(seeded("4294967296")),
              testing::at_place("test.toml:23:8: scene.floor.seed = 4294967296: ", "4294967295"));
}

TEST(Configuration, Overrides) {
  const auto read = [](const std::string& key, const std::string& value) {
    return testing::read(small_experiment, {{key, value, "--set " + key + "=" + value}});
  };
  EXPECT_EQ(read("experiment.population", "9").population, 9);
  EXPECT_EQ(read("mutation.0.probability", "0.25").mutations[0].probability, 0.25);
  EXPECT_EQ(read("selection.name", "elitist").uses.back().name, "elitist") << "a text needs no quotes";
  EXPECT_EQ(read("scene.drag.coefficient", "2").scene.drag->coefficient, 2) << "a table may come into being";
  EXPECT_EQ(read("fitness.1.name", "actuation-work").fitness.size(), 2u) << "and so may the next item of a list";

  EXPECT_THAT(complaint(small_experiment, {{"experiment.population", "-1", "--set experiment.population=-1"}}),
              testing::at_place("--set experiment.population=-1: experiment.population = -1: ", "1 to 1000000"));
  EXPECT_THAT(complaint(small_experiment, {{"experiment.size", "3", "--set experiment.size=3"}}),
              testing::at_place(
                  "--set experiment.size=3: experiment.size: ", "[experiment]",
                  "seed, evaluations, spring_evaluations, hours, population, children, random_individuals, verify"));
  EXPECT_THAT(complaint(small_experiment, {{"fitness.7.window", "3", "--set fitness.7.window=3"}}),
              testing::at_place("--set fitness.7.window=3: fitness.7.window: ", "item 7"));
  EXPECT_THAT(complaint(small_experiment, {{"fitness.0", "3", "--set fitness.0=3"}}),
              testing::at_place("test.toml:37:1: fitness = a list with tables: ", "[[fitness]]"));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
