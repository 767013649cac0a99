// evodevo environments: the bodies that one genome grows in several scenes, and how far they are from each other.
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>

#include "body_distance.hpp"
#include "body_json.hpp"
#include "breeding.hpp"
#include "commands/options.hpp"
#include "disturbance.hpp"
#include "toml_reader.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;
namespace po = boost::program_options;

/// What became of the genome after one start; a body where it matured.
struct Grown {
  Status status = Status::ok;
  std::string reason;
  std::optional<GrownBody> body;
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
  const std::size_t born = lives.front().living.body.masses.size();
  for (std::uint32_t start = 1; start < starts; ++start)
    if (lives[start].alive()) disturb(lives[start], experiment, start - 1);
  evaluation.develop(lives, [](double) {});
  Environment environment{.name = experiment.name, .materials = experiment.world.material_names, .grown = {}};
  if (experiment.scene.gravity) environment.slope = experiment.scene.gravity->slope;
  for (Life& life : lives) {
    Grown& grown = environment.grown.emplace_back(Grown{life.result.status, life.result.reason, std::nullopt});
    if (life.alive())
      grown.body = {std::move(life.living.body), std::move(life.living.state.position),
                    mass_numbers(born, life.result.record)};
  }
  return environment;
}

/// Two lives and their distances.
struct Comparison {
  std::size_t start_a, start_b;
  double springs, mass;
};

/// Of every body of `a` with every one of `b`, or with every later one where both are the same environment.
std::vector<Comparison> compare(const Environment& a, const Environment& b) {
  std::vector<Comparison> all;
  for (std::size_t i = 0; i < a.grown.size(); ++i)
    for (std::size_t j = &a == &b ? i + 1 : 0; j < b.grown.size(); ++j)
      if (const auto& x = a.grown[i].body, &y = b.grown[j].body; x && y)
        all.push_back({i, j, spring_distance(*x, *y), mass_distance(*x, *y)});
  return all;
}

struct Spread {
  double least, median, most;
};

std::optional<Spread> spread(const std::vector<Comparison>& comparisons, double Comparison::*distance) {
  if (comparisons.empty()) return std::nullopt;
  std::vector<double> values;
  for (const Comparison& comparison : comparisons) values.push_back(comparison.*distance);
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return Spread{values.front(), values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2,
                values.back()};
}

void print(const std::vector<Environment>& environments, const char* title, double Comparison::*distance) {
  std::printf("\n%s\n%-16s %-22s", title, "", "start noise alone");
  for (const Environment& environment : environments) std::printf(" %14.14s", environment.name.c_str());
  std::printf("\n");
  for (const Environment& a : environments) {
    const auto noise = spread(compare(a, a), distance);
    std::printf("%-16s ", a.name.c_str());
    if (noise)
      std::printf("%.3f (%.3f to %.3f)", noise->median, noise->least, noise->most);
    else
      std::printf("%-22s", "-");
    for (const Environment& b : environments) {
      const auto between = &a == &b ? std::nullopt : spread(compare(a, b), distance);
      if (between)
        std::printf(" %14.3f", between->median);
      else
        std::printf(" %14s", "-");
    }
    std::printf("\n");
  }
}

void print(const std::vector<Environment>& environments) {
  std::printf("%-16s %8s %8s\n", "matured", "masses", "springs");
  for (const Environment& environment : environments) {
    const Grown& first = environment.grown.front();
    if (first.body)
      std::printf("%-16s %8zu %8zu\n", environment.name.c_str(), first.body->body.masses.size(),
                  first.body->body.springs.size());
    for (std::size_t start = 0; start < environment.grown.size(); ++start)
      if (const Grown& grown = environment.grown[start]; !grown.body)
        std::printf("%-16s %s from start %zu: %s\n", environment.name.c_str(), name(grown.status), start,
                    grown.reason.c_str());
  }
  print(environments, "part of the springs that only one body has, median", &Comparison::springs);
  print(environments, "part of the mass that lies elsewhere, median", &Comparison::mass);
}

Json to_json(const Environment& environment) {
  Json starts = Json::array();
  for (const Grown& grown : environment.grown) {
    Json start = {{"status", name(grown.status)}, {"reason", grown.reason}};
    if (grown.body)
      start["body"] = Json::parse(body_to_json(grown.body->body, grown.body->places, environment.materials));
    starts.push_back(std::move(start));
  }
  return {{"name", environment.name}, {"slope", environment.slope}, {"starts", std::move(starts)}};
}

Json to_json(const std::vector<Environment>& environments) {
  Json scenes = Json::array(), distances = Json::array();
  for (std::size_t a = 0; a < environments.size(); ++a) {
    scenes.push_back(to_json(environments[a]));
    for (std::size_t b = a; b < environments.size(); ++b)
      for (const Comparison& comparison : compare(environments[a], environments[b]))
        distances.push_back({{"scenes", {a, b}},
                             {"starts", {comparison.start_a, comparison.start_b}},
                             {"springs", comparison.springs},
                             {"mass", comparison.mass}});
  }
  return {{"scenes", std::move(scenes)}, {"distances", std::move(distances)}};
}

/// One genome must mean the same body at birth in all scenes.
void expect_same_encoding(const Experiment& experiment, const std::string& file, const Experiment& first,
                          const std::string& first_file) {
  const auto same = [](const GeneSpec& a, const GeneSpec& b) {
    return a.low == b.low && a.high == b.high && a.choices == b.choices;
  };
  if (!std::ranges::equal(experiment.layout.genes, first.layout.genes, same))
    throw ConfigError(file + ": encoding: has other genes than that of " + first_file + "; make them equal");
  const auto encoding = [](const Experiment& e) {
    return parse_toml(e.resolved, e.name)["encoding"].ref<toml::table>();
  };
  if (encoding(experiment) != encoding(first))
    throw ConfigError(file + ": encoding: has other parameters than that of " + first_file + "; make them equal");
}

std::vector<Experiment> read_experiments(const std::vector<std::string>& files, const po::variables_map& given) {
  std::vector<Experiment> experiments;
  for (const std::string& file : files) {
    experiments.push_back(read_experiment(experiment_source(file, given)));
    expect_same_encoding(experiments.back(), file, experiments.front(), files.front());
  }
  return experiments;
}

/// The individual of a run, or else one of the random ones that the experiment begins with. The experiments get the
/// seed that goes with it, so that development draws the same random numbers everywhere.
Individual chosen_genome(std::vector<Experiment>& experiments, const po::variables_map& given) {
  if (!given.contains("run")) {
    const auto id = given.contains("individual") ? given["individual"].as<std::int64_t>() : 0;
    if (id < 0 || id > std::numeric_limits<std::uint32_t>::max())
      throw UsageError("--individual " + std::to_string(id) + ": expected 0 or more");
    for (Experiment& experiment : experiments) experiment.seed = experiments.front().seed;
    return breed(experiments.front(), {}, 0, static_cast<std::uint32_t>(id), 1).front();
  }
  const Archive archive = Archive::read(given["run"].as<std::string>());
  const Experiment recorded = recorded_experiment(archive, given_plugin_path(given));
  expect_same_encoding(recorded, archive.folder().string(), experiments.front(), "the first experiment");
  for (Experiment& experiment : experiments) experiment.seed = recorded.seed;
  return chosen_individual(archive, given);
}

}  // namespace

int environments_command(const Arguments& arguments) {
  CommandLine line{"environments EXPERIMENT.toml... [options]", {}, {}};
  line.options.add_options()("experiments", po::value<std::vector<std::string>>(),
                             "what the genome grows in; all with the same encoding")(
      "run", po::value<std::string>(), "folder of the run that the genome comes from; default: a random genome")(
      "individual", po::value<std::int64_t>(),
      "its id in the run; default: the best. Without a run, which of the random ones; default: 0")(
      "starts", po::value<std::int64_t>()->default_value(6),
      "starts in each scene: one as the body is born, the others with masses moved at random by up to 1e-4 of its "
      "size")("json", "machine-readable, with all bodies and distances");
  add_experiment_options(line.options);
  line.repeated = "experiments";
  const auto given = parse(std::move(line), arguments);
  if (!given) return 0;
  if (!given->contains("experiments")) throw UsageError("environments: give experiments, FILE.toml");
  const auto starts = (*given)["starts"].as<std::int64_t>();
  if (starts < 1 || starts > 200) throw UsageError("--starts " + std::to_string(starts) + ": expected 1 to 200");
  auto experiments = read_experiments((*given)["experiments"].as<std::vector<std::string>>(), *given);
  const Individual individual = chosen_genome(experiments, *given);
  std::vector<Environment> environments;
  for (const Experiment& experiment : experiments)
    environments.push_back(grow(experiment, individual, static_cast<std::uint32_t>(starts)));
  if (given->contains("json"))
    std::cout << to_json(environments).dump(1) << '\n';
  else
    print(environments);
  return 0;
}

}  // namespace evodevo
