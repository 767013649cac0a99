// evodevo environments: develops bodies of one genome in several scenes, and compares them.
#include <fmt/ostream.h>

#include <algorithm>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>

#include "archive/record_check.hpp"
#include "archive/recorded_experiment.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "commands/commands.hpp"
#include "commands/shell/options.hpp"
#include "commands/shell/output/notices.hpp"
#include "environments/experiment_difference.hpp"
#include "environments/scene_study.hpp"
#include "evolution/breeding.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;

void print(const std::optional<SceneEffect>& effect) {
  if (!effect)
    fmt::print(std::cout, "  {:>20}", "-");
  else if (!effect->p)
    fmt::print(std::cout, "  {:13.4f}/{:>6}", effect->between, "-");
  else
    fmt::print(std::cout, "  {:6.4f}/{:6.4f} {:6.4f}", effect->between, *effect->within, *effect->p);
}

/// The cycles, counted from 0, whose distances are printed.
struct Cycles {
  std::size_t first, end;
};

void print(const SceneStudy& study, std::size_t measure, const Cycles& cycles) {
  std::size_t width = 15;
  for (const Environment& environment : study.environments) width = std::max(width, environment.name.size());
  fmt::print(std::cout, "\n{}\n{:<{}}", body_distances[measure].title, "", 2 * width + 2);
  for (std::size_t cycle = cycles.first; cycle < cycles.end; ++cycle)
    fmt::print(std::cout, "        after cycle {:2}", cycle + 1);
  std::cout << '\n';
  for (const ScenePair& pair : study.pairs) {
    fmt::print(std::cout, "{:<{}} {:<{}}", study.environments[pair.a].name, width, study.environments[pair.b].name,
               width + 1);
    for (std::size_t cycle = cycles.first; cycle < cycles.end; ++cycle) print(pair.effects[measure].at(cycle));
    std::cout << '\n';
  }
}

void print(const std::vector<SceneStudy>& studies, const Cycles& cycles) {
  std::cout << "mean distance between two scenes / mean distance by start noise within a scene, and p of a permutation "
               "test\n";
  for (const SceneStudy& study : studies) {
    std::cout << "\nindividual " << study.individual << '\n';
    for (const Environment& environment : study.environments)
      for (std::size_t start = 0; start < environment.grown.size(); ++start)
        if (const Grown& grown = environment.grown[start]; grown.status != Status::ok)
          fmt::print(std::cout, "{:<15} {} from start {}: {}\n", environment.name, name(grown.status), start,
                     grown.reason);
    for (std::size_t measure = 0; measure < body_distances.size(); ++measure) print(study, measure, cycles);
  }
}

Json to_json(const Environment& environment) {
  Json starts = Json::array();
  for (const Grown& grown : environment.grown) {
    Json start = {{"status", name(grown.status)}, {"reason", grown.reason}};
    if (grown.status == Status::ok) start["body"] = Json::parse(body_to_json(grown.matured, environment.materials));
    starts.push_back(std::move(start));
  }
  return {{"name", environment.name}, {"slope", environment.slope}, {"starts", std::move(starts)}};
}

Json to_json(const std::optional<SceneEffect>& effect) {
  if (!effect) return nullptr;
  const auto known = [](const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); };
  return {{"between", effect->between}, {"within", known(effect->within)}, {"p", known(effect->p)}};
}

Json to_json(const SceneStudy& study) {
  Json scenes = Json::array(), pairs = Json::array();
  for (const Environment& environment : study.environments) scenes.push_back(to_json(environment));
  for (const ScenePair& pair : study.pairs) {
    Json& written = pairs.emplace_back(Json{{"scenes", {pair.a, pair.b}}});
    for (std::size_t measure = 0; measure < body_distances.size(); ++measure)
      for (const auto& effect : pair.effects[measure]) written[body_distances[measure].name].push_back(to_json(effect));
  }
  return {{"individual", study.individual}, {"scenes", std::move(scenes)}, {"pairs", std::move(pairs)}};
}

/// Throws ConfigError if the encoding, the materials or the genes of operators differ from those of the first
/// experiment, because a genome must encode the same body in all scenes.
void expect_same_meaning(const Experiment& experiment, const std::string& title, const Experiment& first) {
  if (const auto other = difference(experiment, first, {"encoding", "materials"}); !other.empty())
    throw ConfigError(title + ": " + other + "; the same genome would encode another body: make the values equal");
  if (experiment.layout != first.layout)
    throw ConfigError(title +
                      ": its operators have other genes of their own than those of the first experiment, so it "
                      "cannot read the same genome; give both the same operators");
}

void warn_of_other_differences(const Experiment& experiment, const std::string& title, const Experiment& first) {
  for (const char* table : {"development", "simulation"})
    if (const auto other = difference(experiment, first, {table}); !other.empty())
      std::cerr << "warning: " << printable(title + ": " + other, 2000)
                << "; this alone may make bodies differ, whatever the scene\n";
}

bool is_same_environment(const Experiment& a, const Experiment& b) {
  return a.scene == b.scene && a.payload == b.payload && difference(a, b, {"development", "simulation"}).empty();
}

/// Returns an experiment with the scene of one of its scenarios in place of its own.
Experiment in_scene_of(const Scenario& scenario, const Experiment& experiment, const std::string& file,
                       const Given& given) {
  Experiment other =
      read_experiment(experiment.resolved, {.file = file,
                                            .overrides = {},
                                            .plugin_path = given_plugin_path(given),
                                            .gpus = experiment.gpus,
                                            .files = experiment.files});  // what it was read from may be a pipe
  other.scene = scenario.scene;
  other.payload = scenario.payload;
  return other;
}

/// Adds an experiment in the scene of each scenario of the last experiment, unless there is already one in an equal
/// scene.
void add_scenes_of_scenarios(std::vector<Experiment>& experiments, const std::string& file, bool is_only_file,
                             const Given& given) {
  const std::size_t last = experiments.size() - 1;
  for (const Scenario& scenario : std::vector(experiments[last].scenarios)) {
    Experiment other = in_scene_of(scenario, experiments[last], file, given);
    if (std::any_of(experiments.begin(), experiments.end(),
                    [&](const Experiment& experiment) { return is_same_environment(experiment, other); }))
      continue;
    other.name = is_only_file ? scenario.name : experiments[last].name + ": " + scenario.name;
    experiments.push_back(std::move(other));
  }
}

/// Returns the experiments in all of their scenes: each file's own scene, and then the scenes of its scenarios.
std::vector<Experiment> read_experiments(const std::vector<std::string>& files, const Given& given) {
  std::vector<Experiment> experiments;
  for (const std::string& file : files) {
    experiments.push_back(given_experiment(file, given));
    if (experiments.back().development.cycles == 0)
      throw ConfigError(file + ": development.cycles: is 0, so no body develops; set 1 or more");
    expect_same_meaning(experiments.back(), file, experiments.front());
    warn_of_other_differences(experiments.back(), file, experiments.front());
    add_scenes_of_scenarios(experiments, file, files.size() == 1, given);
  }
  return experiments;
}

/// Returns one of the random individuals with which an experiment begins.
Individual random_individual(const Experiment& experiment, std::int64_t id) {
  if (id < 0 || id > std::numeric_limits<std::uint32_t>::max())
    throw UsageError("--individual " + std::to_string(id) + ": expected 0 or more");
  return breed(experiment, {}, 0, static_cast<std::uint32_t>(id), 1).front();
}

/// Returns the individuals that the user chose: those of a run if --run is given, otherwise random ones. Sets the seed
/// of all experiments to that of the run or of the first experiment, so that development draws the same random numbers
/// in all scenes.
std::vector<Individual> chosen_genomes(std::vector<Experiment>& experiments, const Given& given) {
  const auto ids =
      given.contains("individual") ? given["individual"].as<std::vector<std::int64_t>>() : std::vector<std::int64_t>();
  std::vector<Individual> genomes;
  if (given.contains("run")) {
    const Archive archive = Archive::read(given["run"].as<std::string>());
    const Experiment recorded = recorded_experiment(archive, given_plugin_path(given));
    expect_same_meaning(recorded, archive.folder().string(), experiments.front());
    for (Experiment& experiment : experiments) experiment.seed = recorded.seed;
    for (const std::int64_t id : ids) genomes.push_back(individual_named(archive, id));
    if (ids.empty()) genomes.push_back(chosen_individual(archive, given));
    for (const Individual& individual : genomes) check_genes(archive, recorded, individual);
    return genomes;
  }
  for (Experiment& experiment : experiments) experiment.seed = experiments.front().seed;
  for (const std::int64_t id : ids) genomes.push_back(random_individual(experiments.front(), id));
  if (ids.empty()) genomes.push_back(random_individual(experiments.front(), 0));
  return genomes;
}

int environments(const Given& given) {
  const auto starts = given["starts"].as<std::int64_t>();
  if (starts < 1 || starts > 50) throw UsageError("--starts " + std::to_string(starts) + ": expected 1 to 50");
  auto experiments = read_experiments(given["EXPERIMENT.toml"].as<std::vector<std::string>>(), given);
  std::size_t cycles = std::numeric_limits<std::size_t>::max();  // smallest number of cycles of any experiment
  for (const Experiment& experiment : experiments)
    cycles = std::min(cycles, static_cast<std::size_t>(experiment.development.cycles));
  std::vector<SceneStudy> studies;
  for (const Individual& individual : chosen_genomes(experiments, given))
    studies.push_back(timed("growing individual " + std::to_string(individual.id) + " in all scenes", [&] {
      return study_scenes(experiments, {individual.id, individual.born, &individual.genome},
                          static_cast<std::uint32_t>(starts), cycles);
    }));
  if (!given.contains("json")) {
    print(studies, {given.contains("all") ? 0 : cycles - 1, cycles});
    return 0;
  }
  Json written = Json::array();
  for (const SceneStudy& study : studies) written.push_back(to_json(study));
  std::cout << json_text(written) << '\n';
  return 0;
}

}  // namespace

Command environments_command() {
  Options options;
  options.add_options()("run", value<std::string>("DIR"),
                        "the run that the genome comes from; default: a random genome")(
      "individual", values<std::int64_t>("ID"),
      "the individual of the run; default: the best. Without --run, the number of a random individual; default: 0. May "
      "be repeated")("starts", value<std::int64_t>("N")->default_value(6),
                     "number of starts in each scene: one with the body as it is born, the others with its masses "
                     "moved at random by up "
                     "to 1e-4 of its size")("all", "print the distances after every cycle instead of the last")(
      "json", "print JSON, with all cycles and all bodies");
  add_experiment_options(options);
  return {
      .name = "environments",
      .arguments = {{"EXPERIMENT.toml", Count::one_or_more}},
      .summary = "Compare the bodies that one genome grows in several scenes",
      .text = {"The genome develops in the scene of each experiment, several times with start noise. An experiment "
               "with scenarios adds the scene of each scenario that differs from the scenes so far. For each pair of "
               "scenes, a table gives the mean distance between bodies of the two scenes, the mean "
               "distance by start noise between bodies of the same scene, and p of a permutation test, after the last "
               "cycle or, "
               "with --all, after each. All experiments "
               "need the same [encoding] and [materials]."},
      .examples = {"environments experiments/environments/*.toml --individual 1 --individual 2",
                   "environments experiments/environments/*.toml --run runs/quickstart-1 --json > environments.json"},
      .options = options,
      .function = environments};
}

}  // namespace evodevo
