// evodevo environments: the bodies that one genome grows in several scenes, and how far they are from each other.
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "base/json_text.hpp"
#include "base/text.hpp"
#include "commands/options.hpp"
#include "environments/body_distance.hpp"
#include "environments/scene_effect.hpp"
#include "evolution/breeding.hpp"
#include "evolution/record_check.hpp"
#include "experiment/device.hpp"
#include "experiment/toml_reader.hpp"
#include "life/body_json.hpp"
#include "life/perturbation.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;
namespace po = boost::program_options;

/// What became of the genome after one start.
struct Grown {
  Status status = Status::ok;
  std::string reason;
  std::vector<GrownBody> after;  ///< each cycle that it lived through
  GivenBody matured = {};        ///< unless it failed
};

/// A scene and what grew in it from each start, the first without noise.
struct Environment {
  std::string name;
  double slope = 0;  ///< degrees
  std::vector<std::string> materials;
  std::vector<Grown> grown;
};

Environment grow(const Experiment& experiment, const Individual& individual, std::uint32_t starts) {
  const auto simulator = make_simulator(experiment);
  const Evaluation evaluation(experiment, *simulator);
  const std::vector<Newborn> newborns(starts, {individual.id, individual.born, &individual.genome});
  std::vector<Life> lives = evaluation.birth(newborns);
  std::vector<GrowthObserver> observers(starts, GrowthObserver(lives.front().living.body));
  for (std::uint32_t start = 1; start < starts; ++start)
    if (Life& life = lives[start]; life.alive()) {
      disturb(life, experiment, start - 1);
      evaluation.choose_step(life);
    }
  Environment environment{
      .name = experiment.name, .materials = experiment.world.material_names, .grown = std::vector<Grown>(starts)};
  if (experiment.scene.gravity) environment.slope = experiment.scene.gravity->slope;
  evaluation.develop(lives, [&](double) {
    for (std::size_t i = 0; i < lives.size(); ++i)
      if (const Life& life = lives[i]; life.alive())
        environment.grown[i].after.push_back(observers[i].after_cycle(life));
  });
  for (std::size_t i = 0; i < lives.size(); ++i) {
    environment.grown[i].status = lives[i].result.status;
    environment.grown[i].reason = lives[i].result.reason;
    LivingBody& living = lives[i].living;
    environment.grown[i].matured = {std::move(living.body), std::move(living.state)};
  }
  return environment;
}

using Distance = double (*)(const GrownBody&, const GrownBody&);

struct Kind {
  const char* name;
  const char* title;
  Distance distance;
};

constexpr Kind kinds[] = {{"springs", "springs that only one body has", spring_distance},
                          {"mass", "how far mass lies apart, body lengths at birth", mass_distance}};

/// The bodies that are left after a cycle, counted from 0.
std::vector<const GrownBody*> bodies_after(std::size_t cycle, const Environment& environment) {
  std::vector<const GrownBody*> bodies;
  for (const Grown& grown : environment.grown)
    if (cycle < grown.after.size()) bodies.push_back(&grown.after[cycle]);
  return bodies;
}

/// None where a scene has no body left.
std::optional<SceneEffect> compare(const Environment& a, const Environment& b, std::size_t cycle, Distance distance) {
  std::vector<const GrownBody*> bodies = bodies_after(cycle, a);
  const std::vector<const GrownBody*> others = bodies_after(cycle, b);
  const std::size_t first = bodies.size();
  if (first == 0 || others.empty()) return std::nullopt;
  bodies.insert(bodies.end(), others.begin(), others.end());
  std::vector<std::vector<double>> distances(bodies.size(), std::vector<double>(bodies.size()));
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t j = i + 1; j < bodies.size(); ++j) distances[i][j] = distance(*bodies[i], *bodies[j]);
  return scene_effect(distances, first);
}

/// Two scenes and how far what grew in them is apart after each cycle, by each of `kinds`.
struct Pair {
  std::size_t a, b;
  std::vector<std::optional<SceneEffect>> effects[std::size(kinds)];
};

/// One genome in all scenes.
struct Answer {
  std::uint32_t individual;
  std::vector<Environment> environments;
  std::vector<Pair> pairs;
};

Answer answer_of(const std::vector<Experiment>& experiments, const Individual& individual, std::uint32_t starts,
                 std::size_t cycles) {
  Answer answer{individual.id, {}, {}};
  auto& environments = answer.environments;
  for (const Experiment& experiment : experiments) environments.push_back(grow(experiment, individual, starts));
  for (std::size_t a = 0; a < environments.size(); ++a)
    for (std::size_t b = a + 1; b < environments.size(); ++b) {
      Pair& pair = answer.pairs.emplace_back(Pair{a, b, {}});
      for (std::size_t kind = 0; kind < std::size(kinds); ++kind)
        for (std::size_t cycle = 0; cycle < cycles; ++cycle)
          pair.effects[kind].push_back(compare(environments[a], environments[b], cycle, kinds[kind].distance));
    }
  for (Environment& environment : environments)
    for (Grown& grown : environment.grown) grown.after.clear();  // there are too many to keep them all
  return answer;
}

void print(const std::optional<SceneEffect>& effect) {
  if (!effect)
    std::printf("  %20s", "-");
  else if (!effect->p)
    std::printf("  %13.4f/%6s", effect->between, "-");
  else
    std::printf("  %6.4f/%6.4f %6.4f", effect->between, *effect->within, *effect->p);
}

void print(const Answer& answer, std::size_t kind, std::size_t cycles) {
  std::printf("\n%s\n%-32s", kinds[kind].title, "");
  for (std::size_t cycle = 1; cycle <= cycles; ++cycle) std::printf("        after cycle %2zu", cycle);
  std::printf("\n");
  for (const Pair& pair : answer.pairs) {
    std::printf("%-15s %-16s", answer.environments[pair.a].name.c_str(), answer.environments[pair.b].name.c_str());
    for (const auto& effect : pair.effects[kind]) print(effect);
    std::printf("\n");
  }
}

void print(const std::vector<Answer>& answers, std::size_t cycles) {
  std::printf("between two scenes / by start noise in one of them (means), and p of a permutation test\n");
  for (const Answer& answer : answers) {
    std::printf("\nindividual %u\n", answer.individual);
    for (const Environment& environment : answer.environments)
      for (std::size_t start = 0; start < environment.grown.size(); ++start)
        if (const Grown& grown = environment.grown[start]; grown.status != Status::ok)
          std::printf("%-15s %s from start %zu: %s\n", environment.name.c_str(), name(grown.status), start,
                      grown.reason.c_str());
    for (std::size_t kind = 0; kind < std::size(kinds); ++kind) print(answer, kind, cycles);
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

Json to_json(const Answer& answer) {
  Json scenes = Json::array(), pairs = Json::array();
  for (const Environment& environment : answer.environments) scenes.push_back(to_json(environment));
  for (const Pair& pair : answer.pairs) {
    Json& written = pairs.emplace_back(Json{{"scenes", {pair.a, pair.b}}});
    for (std::size_t kind = 0; kind < std::size(kinds); ++kind)
      for (const auto& effect : pair.effects[kind]) written[kinds[kind].name].push_back(to_json(effect));
  }
  return {{"individual", answer.individual}, {"scenes", std::move(scenes)}, {"pairs", std::move(pairs)}};
}

/// Values of a resolved experiment by their full keys, as messages show them.
using Values = std::map<std::string, std::string>;

void collect(const toml::node& node, const std::string& key, Values& values) {
  if (const toml::table* table = node.as_table())
    for (const auto& [name, item] : *table) collect(item, key + "." + std::string(name.str()), values);
  else if (const toml::array* array = node.as_array(); array != nullptr && array->is_array_of_tables())
    for (std::size_t i = 0; i < array->size(); ++i) collect((*array)[i], key + "." + std::to_string(i), values);
  else
    values[key] = value_text(node);
}

Values values(const Experiment& experiment, std::initializer_list<const char*> tables) {
  const toml::table resolved = parse_toml(experiment.resolved, experiment.name);
  Values values;
  for (const char* table : tables)
    if (const toml::node* node = resolved.get(table)) collect(*node, table, values);
  return values;
}

/// "simulation.dt is 0.001, in the first experiment 0.0005" of the first value that differs; empty where none does.
std::string difference(const Experiment& experiment, const Experiment& first,
                       std::initializer_list<const char*> tables) {
  const Values here = values(experiment, tables), there = values(first, tables);
  const auto value = [](const Values& values, const std::string& key) {
    const auto found = values.find(key);
    return found == values.end() ? "absent" : found->second;
  };
  Values all = here;
  all.insert(there.begin(), there.end());
  for (const auto& [key, _] : all)
    if (value(here, key) != value(there, key))
      return key + " is " + value(here, key) + ", in the first experiment " + value(there, key);
  return {};
}

/// One genome must mean the same in all scenes.
void expect_same_meaning(const Experiment& experiment, const std::string& title, const Experiment& first) {
  if (const auto other = difference(experiment, first, {"encoding", "materials"}); !other.empty())
    throw ConfigError(title + ": " + other + "; the genome would mean another body: make them equal");
}

void warn_of_other_differences(const Experiment& experiment, const std::string& title, const Experiment& first) {
  for (const char* table : {"development", "simulation"})
    if (const auto other = difference(experiment, first, {table}); !other.empty())
      std::cerr << "warning: " << printable(title + ": " + other, 2000)
                << "; bodies may differ by it, whatever the scene\n";
}

std::vector<Experiment> read_experiments(const std::vector<std::string>& files, const po::variables_map& given) {
  std::vector<Experiment> experiments;
  for (const std::string& file : files) {
    experiments.push_back(read_experiment(experiment_source(file, given)));
    if (experiments.back().development.cycles == 0)
      throw ConfigError(file + ": development.cycles: there are none, so that nothing grows; give 1 or more");
    expect_same_meaning(experiments.back(), file, experiments.front());
    warn_of_other_differences(experiments.back(), file, experiments.front());
  }
  return experiments;
}

/// Of those that an experiment begins with.
Individual random_individual(const Experiment& experiment, std::int64_t id) {
  if (id < 0 || id > std::numeric_limits<std::uint32_t>::max())
    throw UsageError("--individual " + std::to_string(id) + ": expected 0 or more");
  return breed(experiment, {}, 0, static_cast<std::uint32_t>(id), 1).front();
}

/// Individuals of a run, or else random ones. The experiments get the seed that goes with them, so that development
/// draws the same random numbers everywhere.
std::vector<Individual> chosen_genomes(std::vector<Experiment>& experiments, const po::variables_map& given) {
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

}  // namespace

int environments_command(const Arguments& arguments) {
  CommandLine line{"environments EXPERIMENT.toml... [options]", {}, {}};
  line.options.add_options()("experiments", po::value<std::vector<std::string>>(),
                             "what the genome grows in; all with the same encoding")(
      "run", po::value<std::string>(), "folder of the run that the genome comes from; default: a random genome")(
      "individual", po::value<std::vector<std::int64_t>>(),
      "its id in the run; default: the best. Without a run, which of the random ones; default: 0. May be repeated")(
      "starts", po::value<std::int64_t>()->default_value(6),
      "starts in each scene: one as the body is born, the others with masses moved at random by up to 1e-4 of its "
      "size")("json", "machine-readable, with all bodies");
  add_experiment_options(line.options);
  line.repeated = "experiments";
  const auto given = parse(std::move(line), arguments);
  if (!given) return 0;
  if (!given->contains("experiments")) throw UsageError("environments: give experiments, FILE.toml");
  const auto starts = (*given)["starts"].as<std::int64_t>();
  if (starts < 1 || starts > 50) throw UsageError("--starts " + std::to_string(starts) + ": expected 1 to 50");
  auto experiments = read_experiments((*given)["experiments"].as<std::vector<std::string>>(), *given);
  std::size_t cycles = std::numeric_limits<std::size_t>::max();  // that all have
  for (const Experiment& experiment : experiments)
    cycles = std::min(cycles, static_cast<std::size_t>(experiment.development.cycles));
  std::vector<Answer> answers;
  for (const Individual& individual : chosen_genomes(experiments, *given))
    answers.push_back(answer_of(experiments, individual, static_cast<std::uint32_t>(starts), cycles));
  if (!given->contains("json")) {
    print(answers, cycles);
    return 0;
  }
  Json written = Json::array();
  for (const Answer& answer : answers) written.push_back(to_json(answer));
  std::cout << json_text(written) << '\n';
  return 0;
}

}  // namespace evodevo
