// Checks that every error message about an experiment contains the place, the value and the remedy, and that all errors
// are reported at once: each once, in the order of the file, and without errors that an earlier one has caused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <tuple>

#include "experiment/config_errors.hpp"
#include "experiment/tables/reference.hpp"
#include "experiment/toml_reader.hpp"
#include "support/changed.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using testing::at_place;
using ::testing::ElementsAre;
using testing::small_experiment;
using testing::small_with;

/// Returns the error message of reading `text`.
std::string complaint(const std::string& text, const std::vector<Override>& overrides = {}) {
  return testing::refusal<ConfigError>([&] { testing::read(text, overrides); });
}

/// Returns the small experiment with the first occurrence of `from` replaced.
std::string with(const std::string& from, const std::string& to) { return small_with({{from, to}}); }

/// Checks the message about the small experiment with the first occurrence of `from` replaced, at a line and column.
template <class... Parts>
void expect_fault(const std::string& from, const std::string& to, const std::string& place, const Parts&... parts) {
  EXPECT_THAT(complaint(with(from, to)), at_place("test.toml:" + place, parts...));
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
    EXPECT_EQ(testing::small({std::string("development.control=") + name}).development.control, control);
  expect_fault("cycles = 2", "cycles = 2\ncontrol = 'shuffled'",
               "31:11: development.control = \"shuffled\": ", "off, no-change, random-places, shuffled-stress");
  expect_fault("springs = 2", "every = 0", "35:9: development.operator.0.every = 0: ", "1 to 16777215");
  EXPECT_THAT(testing::small({"development.operator.0.from=3"}).warnings,
              ElementsAre(at_place("development.operator.0.from = 3", "2", "never applied")));
}

TEST(Configuration, GrowthWithoutSizesWarns) {
  const std::string encoding = "name = \"voxel\"\nsize = [2, 1, 1]\nedge = 0.5";
  const auto warnings = [&](const std::string& other, std::vector<Override> overrides = {},
                            const std::string& op = "ballistic-growth") {
    return testing::read(small_with({{"name = \"spring-turnover\"\nsprings = 2", "name = \"" + op + "\""},
                                     {encoding, "name = \"" + other + "\""}}),
                         std::move(overrides))
        .warnings;
  };
  for (const char* name : {"voxel", "direct", "neural", "cppn"})
    EXPECT_THAT(warnings(name), ElementsAre(at_place("development.operator.0.name = \"ballistic-growth\": ",
                                                     "\"growth\"", "[encoding]", "evodevo describe")))
        << name;
  for (const char* name : {"voxel", "neural", "cppn"})
    EXPECT_THAT(warnings(name, {{"encoding.size_range", "0.25", ""}}), ::testing::IsEmpty()) << name;
  const Override sizes{"encoding.size_range", "0.25", ""}, phases{"encoding.phase_range", "1.0", ""},
      still{"encoding.grows", "false", ""};
  const std::string place = "development.operator.0.name = \"ballistic-phase\": ";
  EXPECT_THAT(warnings("voxel", {sizes}, "ballistic-phase"), ElementsAre(at_place(place, "\"turn\"", "[encoding]")));
  EXPECT_THAT(warnings("voxel", {phases}, "ballistic-phase"), ::testing::IsEmpty());
  EXPECT_THAT(warnings("voxel", {phases, still}, "ballistic-phase"), ElementsAre(at_place(place, "\"turn\"")));
}

TEST(Configuration, DevelopmentWithoutOperatorsWarnsAndHasNoControl) {
  const std::string text = with("[[development.operator]]\nname = \"spring-turnover\"\nsprings = 2\n", "");
  EXPECT_THAT(testing::read(text).warnings,
              ElementsAre(at_place("development.cycles = 2: ", "[[development.operator]]", "[development]")));
  EXPECT_TRUE(testing::read(text, {{"development.cycles", "0", "--set"}}).warnings.empty());
  for (const char* control : {"no-change", "random-places", "shuffled-stress"})
    EXPECT_THAT(complaint(text, {{"development.control", control, "--set"}}),
                testing::naming("development.control = \"" + std::string(control) + "\": ", "[[development.operator]]",
                                "control = \"off\""));
}

TEST(Configuration, DevelopmentHasAProbe) {
  EXPECT_EQ(testing::small().development.probe, Probe::exact);
  const std::string tallied = with("cycles = 2", "cycles = 2\nprobe = \"skip-shift\"");
  const Experiment paper = testing::read(tallied);
  EXPECT_EQ(paper.development.probe, Probe::skip_shift);
  EXPECT_EQ(paper.development.skip, 100);
  EXPECT_THAT(complaint(tallied, {{"development.skip", "101", "--set"}}),
              testing::naming("development.skip = 101: ", "100 steps"));
  EXPECT_THAT(complaint(tallied, {{"development.operator.0.by", "peak", ""}}),
              testing::naming("development.operator.0.name", "skip-shift", "development.probe = \"exact\""));
}

TEST(Configuration, ResolvedTextHoldsEveryDefaultAndReadsBackAsItself) {
  const Experiment experiment = testing::small({"simulation.dt=0.00025"}), again = testing::read(experiment.resolved);
  EXPECT_EQ(experiment.name, "test");
  EXPECT_EQ(again.resolved, experiment.resolved);
  EXPECT_EQ(again.step.dt, 0.00025);
  EXPECT_EQ(again.seed, 7);
  EXPECT_FALSE(again.scene.drag.has_value());
  EXPECT_EQ(again.development.cycles, 2);
  EXPECT_EQ(again.context.materials, experiment.context.materials);
  ASSERT_EQ(again.objectives.size(), 2u);
  EXPECT_EQ(again.objectives[0].name, "distance");
  EXPECT_FALSE(again.objectives[1].maximise);
  EXPECT_THAT(testing::small().resolved, testing::naming("stiffness = 1000000", "coefficient = 0.5", "rate = 20.1",
                                                         "acceleration = 9.8", "dt = 0.0005", "precision = 'float'",
                                                         "method = 'paper-euler'", "reset = false", "mass = 0.2"));
}

TEST(Configuration, AMethodByItsName) {
  for (const std::string_view method : method_names)
    EXPECT_EQ(name(testing::small({"simulation.method=" + std::string(method)}).stepping.method), method);
}

TEST(Configuration, AccuracyChoosesWhatIsLeftOut) {
  const auto read = [](const std::string& keys) { return testing::read(with("threads = 2", keys)); };
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
  EXPECT_THAT(read("accuracy = \"fast\"").resolved, testing::naming("dt = 'auto'", "method = 'symplectic-euler'"));
}

TEST(Configuration, MaterialsAreComputedWhereThatIsAskedForAndPossible) {
  const auto with_keys = [](const std::string& keys) { return with("threads = 2", keys); };
  EXPECT_EQ(testing::read(small_experiment).stepping.materials, Materials::table);
  const Experiment computed = testing::read(with_keys("materials = \"computed\"\naccuracy = \"fast\""));
  EXPECT_EQ(computed.stepping.materials, Materials::computed);
  EXPECT_EQ(computed.stepping.method, Method::symplectic_euler);
  EXPECT_EQ(testing::read(computed.resolved).stepping.materials, Materials::computed);
  for (const char* other : {"precision = \"double\"", "method = \"xpbd\"", "accuracy = \"reference\""})
    EXPECT_THAT(complaint(with_keys("materials = \"computed\"\n" + std::string(other))),
                at_place("test.toml:27:13: simulation.materials = \"computed\": ", "\"table\"", "method", "precision",
                         "accuracy"));
}

TEST(Configuration, AStepOfItsOwnForEveryBody) {
  const std::string automatic = with("threads = 2", "dt = \"auto\"");
  const Experiment experiment =
      testing::read(automatic, {{"scene.floor.stiffness", "1e11", ""}, {"development.cycle_time", "0.0507", ""}});
  EXPECT_FALSE(experiment.step.dt.has_value()) << "whatever the scene, and for any duration";
  EXPECT_THAT(testing::small({"simulation.dt=auto"}).resolved, ::testing::Not(::testing::HasSubstr("dt = 0")));
  EXPECT_THAT(complaint(automatic, {{"simulation.method", "implicit", ""}}),
              at_place("test.toml:27:6: simulation.dt = \"auto\": ", "\"implicit\"", "number"));
  EXPECT_EQ(complaint(with("threads = 2", "dt = 0.001\nrefine = 2")), "no refusal") << "half of it is borne";
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
  EXPECT_EQ(objection("velocity-verlet", "0.005"), "no refusal");
  EXPECT_THAT(objection("velocity-verlet", "0.008"),
              testing::naming("simulation.dt = 0.008: ", "stiffness", "at most"));
  EXPECT_EQ(objection("rk4", "0.008"), "no refusal");
  EXPECT_THAT(objection("rk4", "0.01"), testing::naming("simulation.dt = 0.01: ", "stiffness", "at most"));
  EXPECT_EQ(objection("implicit", "0.01"), "no refusal");
  EXPECT_EQ(objection("xpbd", "0.01"), "no refusal");
}

TEST(Configuration, UnknownKeys) {
  expect_fault(
      "[selection]", "[wind]\n[selection]", "47:2: wind: ",
      "experiment, encoding, mutation, crossover, scene, simulation, development, fitness, scenario, selection, "
      "materials, islands, island, plugins");
  expect_fault("[scene.floor]", "[scene.flor]", "22:8: scene.flor: ", "[scene]", "\"floor\"");
  expect_fault("edge = 0.5", "edgy = 0.5", "11:1: encoding.edgy: ", "[encoding]", "\"edge\"");
  expect_fault("[selection]", "[materials.rubber]\nstifness = 800\n[selection]",
               "48:1: materials.rubber.stifness: ", "[materials.rubber]", "\"stiffness\"");
}

TEST(Configuration, ValuesOfTheWrongTypeOrOutOfRange) {
  expect_fault("cycles = 2", "reset = 1", "30:9: development.reset = 1: ", "true or false");
  expect_fault("[scene.gravity]\n[scene.floor]", "[scene]\nfloor = 3\n[scene.gravity]",
               "22:9: scene.floor = 3: ", "[scene.floor]");
  expect_fault("[[mutation]]", "[mutation]", "13:1: mutation = a table: ", "[[mutation]]");
  expect_fault("name = \"voxel\"", "name = 1", "9:8: encoding.name = 1: ", "quotes");
  expect_fault("threads = 2", "dt = 'automatic'", "27:6: simulation.dt = \"automatic\": ", "number", "\"auto\"");
  expect_fault("evaluations = 24", "evaluations = 0", "4:15: experiment.evaluations = 0: ", "1 to 1000000000");
  expect_fault("threads = 2", "dt = 0.2", "27:6: simulation.dt = 0.2: ", "1e-07 to 0.1 s");
  expect_fault("[scene.floor]", "[scene.floor]\nseed = 4294967296",
               "23:8: scene.floor.seed = 4294967296: ", "4294967295");
  EXPECT_EQ(testing::small({"scene.floor.seed=4294967295"}).scene.floor->seed, 4294967295) << "32 bits";
}

TEST(Configuration, UnknownNames) {
  expect_fault("threads = 2", "device = 'tpu'", "27:10: simulation.device = \"tpu\": ", "auto, cpu, cuda");
  expect_fault("threads = 2", "method = 'rk5'", "27:10: simulation.method = \"rk5\": ", "\"rk4\"");
  expect_fault("threads = 2", "accuracy = 'best'",
               "27:12: simulation.accuracy = \"best\": ", "paper, fast, balanced, reference");
  expect_fault("threads = 2", "materials = 'computer'",
               "27:13: simulation.materials = \"computer\": ", "table, computed");
  expect_fault("\"voxel\"", "'voxels'", "9:8: encoding.name = \"voxels\": ", "encoding operator", "\"voxel\"");
  expect_fault("\"two-point\"", "'blend'", "18:8: crossover.0.name = \"blend\": ", "crossover operator",
               "swap-neuron, two-point", "[plugins] paths", "--plugin-path");
  expect_fault("edge = 0.5", "materials = ['muscle', 'bones']",
               "11:13: encoding.materials = [ \"muscle\", \"bones\" ]: ", "\"bones\"", "\"bone\"");
  expect_fault("edge = 0.5", "materials = ['bone', 'bone']",
               "11:13: encoding.materials = [ \"bone\", \"bone\" ]: ", "\"bone\" twice");
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
  EXPECT_EQ(testing::small({"experiment.population=7.0"}).resolved,
            testing::small({"experiment.population=7"}).resolved);
  EXPECT_EQ(testing::small({"experiment.evaluations=1e3"}).evaluations, 1000);
  EXPECT_EQ(testing::small({"experiment.random_individuals=-0.0"}).random_individuals, 0);
  EXPECT_EQ(testing::small({"experiment.seed=9007199254740991.0"}).seed, 9007199254740991);
  EXPECT_EQ(testing::small({"encoding.size=[3.0, 2, 1e0]"}).layout.first_size(), 6u);
  expect_fault("population = 6", "population = 6.5", "5:14: experiment.population = 6.5: ", "whole number",
               "1 to 1000000");
  expect_fault("size = [2, 1, 1]", "size = [2, 1.5, 1]", "10:12: encoding.size = 1.5: ", "whole number", "1 to 32");
  expect_fault("population = 6", "population = 1e300", "5:14: experiment.population = 1e+300: ", "1 to 1000000");
  EXPECT_THAT(complaint(small_experiment, {{"experiment.population", "99999999999999999999", "--set"}}),
              testing::naming("experiment.population", "99999999999999999999", "64 bits"));
}

TEST(Configuration, NumbersThatAreNotFiniteAreRefusedWhereverTheyStand) {
  for (const char* value : {"nan", "-nan", "+nan", "inf", "-inf"})
    for (const char* key : {"experiment.population", "experiment.spring_evaluations", "encoding.edge", "encoding.size",
                            "mutation.0.probability", "mutation.0.genes", "scene.gravity.slope", "simulation.dt",
                            "simulation.refine", "development.cycle_time", "development.operator.0.from",
                            "fitness.0.window", "fitness.0.direction", "materials.bone.phase"}) {
      const bool is_list = std::string(key).ends_with("size") || std::string(key).ends_with("direction");
      const std::string text = is_list ? "[1, " + std::string(value) + ", 1]" : value;
      const std::string said = complaint(small_experiment, {{key, text, "--set"}});
      EXPECT_THAT(said, ::testing::HasSubstr(std::string("--set: ") + key + " = "));
      EXPECT_THAT(said, ::testing::ContainsRegex(": expected (a|[0-9-])")) << "what would be right";
      EXPECT_THAT(said, ::testing::Not(::testing::ContainsRegex("nan +[a-zA-Z]|at (least|most) $")));
    }
}

/// Tests a parameter that may have any finite value, and parameters with a bound on one side.
TEST(Configuration, ARangeWithoutAnEndAsksForAFiniteNumber) {
  const auto complaint_of = [](const std::string& text, Range range) {
    const toml::table table = parse_toml(text, "x");
    TomlReader reader(table, "t");
    double value = 0;
    return testing::refusal<ConfigError>([&] { reader.real(value, "a", range, ""); });
  };
  const double none = std::numeric_limits<double>::infinity();
  EXPECT_THAT(complaint_of("a = nan", {}), at_place("x:1:5: t.a = nan: ", "finite number"));
  EXPECT_THAT(complaint_of("a = inf", {0, none, "s"}), at_place("x:1:5: t.a = inf: ", "finite number", "at least 0 s"));
  EXPECT_THAT(complaint_of("a = -inf", {-none, 3}), at_place("x:1:5: t.a = -inf: ", "finite number", "at most 3"));
  EXPECT_EQ(complaint_of("a = -1e308", {}), "no refusal");
}

TEST(Configuration, WarnsOfWhatMayNotBeMeant) {
  EXPECT_TRUE(testing::read(small_experiment).warnings.empty());
  EXPECT_THAT(testing::read(small_experiment + "\n[materials.muscel]\nstiffness = 3\n").warnings,
              ElementsAre(testing::naming("[materials.muscel]", "new material", "\"muscle\"")));
}

TEST(Configuration, MaterialsOfOnesOwn) {
  const Experiment experiment =
      testing::read(small_experiment + "\n[materials.rubber]\nstiffness = 800\n[materials.muscle]\namplitude = 0\n");
  const auto index = experiment.context.material_indices({"rubber", "muscle"});
  ASSERT_EQ(index.size(), 2u);
  EXPECT_EQ(experiment.context.materials[static_cast<std::size_t>(index[0])], (Material{5000, 0, 1, 0}));
  EXPECT_EQ(experiment.context.materials[static_cast<std::size_t>(index[1])], (Material{800, 0, 0, 0}));
}

TEST(Configuration, MissingParts) {
  EXPECT_THAT(complaint(""), at_place("test.toml:1:1: experiment: ", "missing", "[experiment]"));
  EXPECT_THAT(complaint(with("name = \"voxel\"", "")), at_place("test.toml:8:1: encoding.name: ", "missing"));
  const std::string begun = "[experiment]\n[encoding]\nname = 'voxel'\n";
  EXPECT_THAT(complaint(begun), at_place("test.toml:1:1: fitness: ", "missing", "[[fitness]]"));
  const std::string scored = begun + "[[fitness]]\nname = 'distance'\n";
  EXPECT_THAT(complaint(scored), at_place("test.toml:1:1: selection: ", "missing", "[selection]"));
}

TEST(Configuration, ItsOwnOperatorsComeBeforeThoseBuiltIn) {
  const std::string folder = std::string(EVODEVO_FAULTY_PLUGINS) + "/taken_name";
  const Experiment experiment = testing::read(small_experiment + "\n[plugins]\npaths = ['" + folder + "']\n");
  EXPECT_EQ(experiment.uses.at(2).name, "reset-weight");
  EXPECT_EQ(experiment.uses.at(2).file.parent_path(), folder);
  EXPECT_THAT(experiment.warnings,
              ElementsAre(testing::naming("reset-weight.evodevo.so: ", "mutation operator \"reset-weight\"")));
}

TEST(Configuration, ContradictoryParts) {
  EXPECT_THAT(complaint(small_experiment, {{"mutation.0.probability", "0", ""}, {"crossover.0.probability", "0", ""}}),
              at_place("test.toml:13:1: mutation = a list with tables: ", "probability above 0"));
  expect_fault("[selection]", "[plugins]\npaths = ['/no/such/folder']\n[selection]",
               "48:9: plugins.paths = [ \"/no/such/folder\" ]: ", "folder", "library");
  expect_fault("\"spring-turnover\"\nsprings = 2", "'length-adaptation'\nlow = 0.9\nhigh = 0.8",
               "35:7: development.operator.0.low = 0.9: ", "high");
  expect_fault("[scene.friction]", "[scene.friction]\nstatic = 0.4", "24:10: scene.friction.static = 0.4: ", "at least",
               "0.5");
}

TEST(Configuration, StepsThatTheSceneOrAMaterialCannotBear) {
  expect_fault("threads = 2", "dt = 0.001", "27:6: simulation.dt = 0.001: ", "scene.floor.stiffness = 1000000 N/m",
               "masses of 0.2 kg", "at most 0.0005366563145999495 s");
  expect_fault("[simulation]", "[materials.bone]\nstiffness = 1e7\n[simulation]\ndt = 0.0005",
               "29:6: simulation.dt = 0.0005: ", "materials.bone.stiffness = 10000000 N/m", "masses of 0.2 kg",
               "at most 0.0002 s");
  expect_fault("[simulation]", "[materials.muscle]\nfrequency = 1999\n[simulation]\ndt = 0.0005",
               "29:6: simulation.dt = 0.0005: ", "materials.muscle.frequency = 1999 Hz",
               "at most 0.0002501250625312656 s");
  EXPECT_THAT(complaint(with("[simulation]\nthreads = 2", "[scene.drag]"), {{"scene.floor.stiffness", "1e9", ""}}),
              at_place("test.toml:1:1: simulation.dt: ", "0.0005 s", "scene.floor.stiffness = 1000000000 N/m"));
  EXPECT_TRUE(
      testing::read(with("threads = 2", "dt = 0.001"), {{"scene.floor.restitution", "0.2", ""}}).scene.floor->rigid())
      << "contact with a rigid floor limits no step";
}

TEST(Configuration, AFloorIsElasticOrRigidAndAScenarioMayChangeThat) {
  expect_fault("[scene.floor]", "[scene.floor]\nstiffness = 1e4\nrestitution = 0.2",
               "24:15: scene.floor.restitution = 0.2: ", "scene.floor.stiffness");
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

TEST(Configuration, Overrides) {
  EXPECT_EQ(testing::small({"experiment.population=9"}).population, 9);
  EXPECT_EQ(testing::small({"mutation.0.probability=0.25"}).mutations[0].probability, 0.25);
  EXPECT_EQ(testing::small({"selection.name=elitist"}).uses.back().name, "elitist") << "a text needs no quotes";
  EXPECT_EQ(testing::small({"scene.drag.coefficient=2"}).scene.drag->coefficient, 2) << "a table may come into being";
  EXPECT_EQ(testing::small({"fitness.1.name=actuation-work"}).fitness.size(), 2u)
      << "and so may the next item of a list";

  const auto refused = [](const std::string& key, const std::string& value) {
    return complaint(small_experiment, {{key, value, "--set " + key + "=" + value}});
  };
  EXPECT_THAT(
      refused("experiment.size", "3"),
      at_place("--set experiment.size=3: experiment.size: ", "[experiment]",
               "seed, evaluations, spring_evaluations, hours, population, children, random_individuals, lives"));
  EXPECT_THAT(refused("fitness.7.window", "3"), at_place("--set fitness.7.window=3: fitness.7.window: ", "item 7"));
  EXPECT_THAT(refused("fitness.0", "3"), at_place("test.toml:37:1: fitness = a list with tables: ", "[[fitness]]"));
}

/// Returns the messages of all errors of an experiment.
std::vector<std::string> errors_of(const std::string& text, std::vector<Override> overrides = {},
                                   bool complete = true) {
  std::vector<std::string> messages;
  try {
    testing::read(text, std::move(overrides));
  } catch (const ConfigErrors& errors) {
    EXPECT_EQ(errors.is_complete, complete);
    for (const ConfigError& error : errors.all) messages.emplace_back(error.what());
    EXPECT_EQ(errors.what(), messages.at(0));
  }
  return messages;
}

TEST(ConfigErrors, AllOfAFileInItsOrder) {
  EXPECT_THAT(errors_of(small_with({{"evaluations = 24", "evalutions = 24"},
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
              ElementsAre(at_place("test.toml:1:1: mutation: ", "missing", "[[mutation]]", "[[crossover]]"),
                          at_place("test.toml:5:8: fitness.0.name = \"distanse\": ", "\"distance\"")));
  EXPECT_THAT(errors_of(small_with({{"random_individuals = 1", "random_individuals = 7"},
                                    {"probability = 0.8", "probability = 0.8\nsections = [\"tissue\"]"},
                                    {"[scene.floor]\n", ""},
                                    {"threads = 2", "threads = -1\n[materials.muscel]\ndensity = 1"},
                                    {"name = \"actuation-work\"", "name = \"distance\""}})),
              ElementsAre(at_place("test.toml:6:22: experiment.random_individuals = 7: ", "population, 6"),
                          at_place("test.toml:16:12: mutation.0.sections = [ \"tissue\" ]: ", "voxel"),
                          at_place("test.toml:23:1: scene.friction = a table: ", "add [scene.floor]",
                                   "remove [scene.friction]"),
                          at_place("test.toml:27:11: simulation.threads = -1: ", "0 to 4096"),
                          at_place("test.toml:29:1: materials.muscel.density: ", "[materials.muscel]"),
                          at_place("test.toml:45:8: fitness.1.name = \"distance\": ", "label")));
  EXPECT_THAT(errors_of(small_with({{"cycle_time = 0.05", "cycle_time = 0.0507"},
                                    {"settle = 0.05\nwindow = 0.1", "settle = 0.0502\nwindow = 0.1002"}})),
              ElementsAre(at_place("test.toml:31:14: development.cycle_time = 0.0507: ", "0.0005 s", "0.0505 s"),
                          at_place("test.toml:39:10: fitness.0.settle = 0.0502: ", "0.0005 s"),
                          at_place("test.toml:40:10: fitness.0.window = 0.1002: ", "0.0005 s")));
  EXPECT_THAT(errors_of(small_with({{"[[mutation]]\nname = \"reset-weight\"\nprobability = 0.8\n", ""},
                                    {"\"age-fitness-pareto\"", "\"cma-es\""}})),
              ElementsAre(at_place("test.toml:14:1: crossover = a list with tables: ", "cma-es"),
                          at_place("test.toml:45:8: selection.name = \"cma-es\": ", "voxel")));
}

/// Each of these has one error. Others would follow from it if the reader knew no better.
TEST(ConfigErrors, NoneThatAnotherOneHasCaused) {
  const std::string mutation = "[[mutation]]\nname = \"reset-weight\"\nprobability = 0.8\n",
                    crossover = "[[crossover]]\nname = \"two-point\"\nprobability = 0.5\n",
                    selection = "[selection]\nname = \"age-fitness-pareto\"",
                    first = "[experiment]\nseed = 7\nevaluations = 24\npopulation = 6\nrandom_individuals = 1\n",
                    scenario = "[[scenario]]\nname = \"icy\"\n";
  const std::pair<std::string, std::string> odd_cycle{"cycle_time = 0.05", "cycle_time = 0.0507"},
      over_icy{"settle = 0.05", "over = \"icy\"\nsettle = 0.05"};
  const struct {
    std::vector<std::pair<std::string, std::string>> changes;
    std::string place, before, behind;
  } cases[] = {
      {{{"\"voxel\"", "\"voxels\""}, {"probability = 0.8", "probability = 0.8\nsections = [\"voxel\"]"}},
       "9:8: encoding.name"},
      {{{"[encoding]", "[encodin]"}}, "8:2: encodin: "},
      {{{"[[fitness]]", "[[fitnes]]"}, {"[[fitness]]", "[[fitnes]]"}}, "37:3: fitnes: "},
      {{{"name = \"distance\"", "name = \"distant\""}, {"\"actuation-work\"", "\"descriptor\""}},
       "38:8: fitness.0.name"},
      {{{"population = 6", "populatoin = 60"}, {"random_individuals = 1", "random_individuals = 55"}},
       "5:1: experiment.populatoin: "},
      {{{"[scene.floor]", "[scene.flor]"}}, "22:8: scene.flor: "},
      {{{"[scene.floor]\n", ""}}, "22:1: scene.friction", "", scenario},
      {{{"threads = 2", "dt = \"0.0001\""}, odd_cycle}, "27:6: simulation.dt"},
      {{{"[simulation]", "[simulaton]"}, odd_cycle}, "26:2: simulaton: "},
      {{{"[scene.floor]", "[scene.floor]\nstiffness = \"1e4\""}, {"threads = 2", "dt = 0.001"}},
       "23:13: scene.floor.stiffness"},
      {{over_icy}, "52:10: scenario.0.repeat", "", scenario + "repeat = 0\n"},
      {{over_icy}, "50:3: scenari: ", "", "[[scenari]]\nname = \"icy\"\n"},
      {{over_icy}, "51:1: scenario.0.nmae: ", "", "[[scenario]]\nnmae = \"icy\"\n"},
      {{{"\"two-point\"", "\"of-my-own\""}}, "50:9: plugins.paths", "", "[plugins]\npaths = [\"/no/such/folder\"]\n"},
      {{{"edge = 0.5", "materials = [\"rubber\"]"}}, "50:10: materials.rubber", "", "[materials]\nrubber = 3\n"},
      {{{"springs = 2", "low = 2\nhigh = 1\nspring = 2"}, {"spring-turnover", "length-adaptation"}},
       "37:1: development.operator.0.spring: "},
      {{{selection, ""}, {mutation, ""}, {crossover, ""}, {"seed = 7", "seed = 7\n"}}, "1:1: selection: "},
      {{{selection, ""}}, "1:13: selection", "selection = 3\n"},
      {{{first, ""}}, "1:14: experiment", "experiment = 3\n"}};
  for (const auto& [changes, place, before, behind] : cases) {
    const std::string text = before + small_with(changes) + behind;
    EXPECT_THAT(errors_of(text), ElementsAre(at_place("test.toml:" + place))) << text;
  }
}

TEST(ConfigErrors, ThoseOfOptionsComeFirst) {
  EXPECT_THAT(errors_of(small_with({{"seed = 7", "seed = -1"}}), {{"fitness.0.window", "0", "--set fitness.0.window=0"},
                                                                  {"scene.wind", "1", "--set scene.wind=1"}}),
              ElementsAre(at_place("--set scene.wind=1: scene.wind: ", "[scene]"),
                          at_place("--set fitness.0.window=0: fitness.0.window = 0: "),
                          at_place("test.toml:3:8: experiment.seed = -1: ")));
}

TEST(ConfigErrors, ASyntaxErrorEndsReading) {
  EXPECT_THAT(
      [] {
        errors_of(small_with({{"seed = 7", "seed = -1"}, {"edge = 0.5", "edge = "}}));
      },
      ::testing::ThrowsMessage<ConfigError>(at_place("test.toml:11:8:")));
}

TEST(ConfigErrors, VeryManyEndReading) {
  std::string text = testing::small_experiment;
  for (int i = 0; i < 1000; ++i) text += "unknown" + std::to_string(i) + " = 1\n";
  EXPECT_THAT(errors_of(text, {}, false), ::testing::SizeIs(ErrorCollector::most));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
