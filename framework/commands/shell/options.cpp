#include "commands/shell/options.hpp"

#include <algorithm>
#include <charconv>
#include <iostream>
#include <limits>
#include <memory>
#include <string_view>

#include "base/text.hpp"
#include "commands/shell/output/notices.hpp"
#include "evolution/founders.hpp"
#include "evolution/resimulation.hpp"
#include "experiment/device.hpp"
#include "experiment/toml_reader.hpp"
#include "operators/loader.hpp"

namespace evodevo {

namespace fs = std::filesystem;

void refuse_to_overwrite(const std::string& option, const fs::path& file, const std::vector<fs::path>& inputs) {
  for (const fs::path& input : inputs)
    if (std::error_code error; fs::equivalent(file, input, error))
      throw UsageError(option + " " + file.string() + ": is " + input.string() +
                       ", which the command reads; name another file to write");
}

std::vector<fs::path> libraries_of(const Experiment& experiment) {
  std::vector<fs::path> libraries;
  for (const OperatorUse& use : experiment.uses) libraries.push_back(use.file);
  return libraries;
}

std::vector<fs::path> files_of_run(const fs::path& folder) {
  const fs::path database = folder / database_name;
  return {database, database.string() + "-wal", database.string() + "-shm"};
}

namespace {

struct Shorthand {
  const char* option;
  const char* key;
  const char* value;  ///< placeholder of the value
  const char* text;

  void add_to(Options& options) const { options.add_options()(option, evodevo::value<std::string>(value), text); }
  /// Appends the value that is given, if there is one.
  void add_to(std::vector<Override>& overrides, const Given& given) const {
    if (!given.contains(option)) return;
    const auto text_of_value = given[option].as<std::string>();
    overrides.push_back({key, text_of_value, option_text(option, text_of_value)});
  }
};

constexpr Shorthand seed{"seed", "experiment.seed", "N", "seed of all random numbers"},
    threads{"threads", "simulation.threads", "N", "number of threads on the CPU; 0: one for each core"};

}  // namespace

std::string option_text(const std::string& option, const std::string& value) {
  return "--" + option + " " + printable(value);
}

void add_plugin_option(Options& options) {
  options.add_options()("plugin-path", values<std::string>("PATH"),
                        "folder with operators, or one library; searched after the experiment's own paths and before "
                        "EVODEVO_PLUGIN_PATH; may be repeated");
}

std::vector<std::filesystem::path> given_plugin_path(const Given& given) {
  std::vector<std::filesystem::path> path;
  if (!given.contains("plugin-path")) return path;
  for (const std::string& item : given["plugin-path"].as<std::vector<std::string>>()) {
    if (!is_plugin_path(item))
      throw UsageError(option_text("plugin-path", item) +
                       ": is neither a folder nor a library NAME.evodevo.so; build the plugin first");
    path.emplace_back(item);
  }
  return path;
}

void add_individual_option(Options& options) {
  options.add_options()("individual", value<std::int64_t>("ID"), "the individual; default: the best");
}

void add_scenario_option(Options& options, const char* text) {
  options.add_options()("scenario", value<std::string>("NAME"), text);
}

std::optional<std::size_t> given_scenario(const Experiment& experiment, const Given& given) {
  if (!given.contains("scenario")) return std::nullopt;
  const auto name = given["scenario"].as<std::string>();
  std::vector<std::string> names;
  for (const Scenario& scenario : experiment.scenarios) names.push_back(scenario.name);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  throw UsageError(
      option_text("scenario", name) + ": the experiment has " +
      (names.empty() ? "no scenarios; leave the option out" : "no scenario of this name" + suggestion(name, names)));
}

const Scenario* given_developing_scenario(const Experiment& experiment, const Given& given) {
  const std::optional<std::size_t> index = given_scenario(experiment, given);
  if (!index) return nullptr;
  const Scenario& scenario = experiment.scenarios[*index];
  if (scenario.develops) return &scenario;
  throw UsageError(option_text("scenario", scenario.name) +
                   ": robots do not develop in it, because its key develops is false; leave the option out");
}

void add_life_option(Options& options, const char* text) {
  options.add_options()("life", value<std::int64_t>("K"), text);
}

std::optional<std::int64_t> given_life_number(const Given& given) {
  return given.contains("life") ? std::optional(given["life"].as<std::int64_t>()) : std::nullopt;
}

Newborn life_of(const Newborn& individual, const Experiment& experiment, std::int64_t number) {
  std::vector<Newborn> lives = each_life(experiment, {&individual, 1});
  if (number < 1 || number > std::ssize(lives))
    throw UsageError(
        option_text("life", std::to_string(number)) + ": individual " + std::to_string(individual.id) + " has had " +
        (lives.size() == 1 ? "one life; leave the option out, or give 1"
                           : std::to_string(lives.size()) + " lives; expected 1 to " + std::to_string(lives.size())));
  return std::move(lives[static_cast<std::size_t>(number - 1)]);
}

Newborn given_life(const Newborn& individual, const Experiment& experiment, const Given& given) {
  return life_of(individual, experiment, given_life_number(given).value_or(1));
}

void add_machine_options(Options& options) {
  threads.add_to(options);
  options.add_options()(
      "device", value<std::string>("auto|cpu|cuda"),
      "where to simulate; auto: on GPUs if there are any; cuda:0,2 uses only these of the visible GPUs, "
      "which are counted from 0");
}

void add_experiment_options(Options& options) {
  add_plugin_option(options);
  seed.add_to(options);
  add_machine_options(options);
  options.add_options()("set", values<std::string>("KEY=VALUE"),
                        "set any key of the file, as in experiment.population=20 or fitness.0.window=5; may be "
                        "repeated");
}

namespace {

constexpr std::string_view device_with_numbers = "cuda:";

/// The value of --device without numbers of GPUs.
std::string device_alone(const std::string& device) {
  return device.starts_with(device_with_numbers) ? "cuda" : device;
}

}  // namespace

std::vector<int> given_gpus(const Given& given) {
  if (!given.contains("device")) return {};
  const auto device = given["device"].as<std::string>();
  if (!device.starts_with(device_with_numbers)) return {};
  std::vector<int> gpus;
  for (auto text = device.begin() + device_with_numbers.size();;) {
    const auto end = std::find(text, device.end(), ',');
    int gpu = -1;
    const auto [last, error] = std::from_chars(std::to_address(text), std::to_address(end), gpu);
    if (error != std::errc() || last != std::to_address(end) || gpu < 0 || std::ranges::find(gpus, gpu) != gpus.end())
      throw UsageError(option_text("device", device) +
                       ": expected different numbers of GPUs, counted from 0, as in --device cuda:0,2");
    gpus.push_back(gpu);
    if (end == device.end()) return gpus;
    text = end + 1;
  }
}

ExperimentSource experiment_source(const std::string& file, const Given& given) {
  ExperimentSource source{file, {}, given_plugin_path(given)};
  if (given.contains("set")) {
    for (const std::string& text : given["set"].as<std::vector<std::string>>()) {
      const auto equals = text.find('=');
      if (equals == std::string::npos || equals == 0)
        throw UsageError(option_text("set", text) + ": expected --set key=value");
      source.overrides.push_back({text.substr(0, equals), text.substr(equals + 1), option_text("set", text)});
    }
  }
  seed.add_to(source.overrides, given);
  const std::vector<Override> machine = given_machine(given);
  source.overrides.insert(source.overrides.end(), machine.begin(), machine.end());
  source.gpus = given_gpus(given);
  return source;
}

std::vector<Override> given_machine(const Given& given) {
  std::vector<Override> overrides;
  threads.add_to(overrides, given);
  if (given.contains("device")) {
    const auto value = given["device"].as<std::string>();
    overrides.push_back({"simulation.device", device_alone(value), option_text("device", value)});
  }
  return overrides;
}

Experiment given_experiment(const std::string& file, const Given& given) {
  return timed("reading " + printable(file) + " and loading its operators",
               [&] { return read_experiment(experiment_source(file, given)); });
}

std::vector<Experiment> given_islands(const std::string& file, const Given& given) {
  return timed("reading " + printable(file) + " and loading its operators", [&] {
    ExperimentSource source = experiment_source(file, given);
    std::vector<Experiment> islands = read_islands(source);
    // what the robots of another run have inherited goes with them
    if (const auto seed = development_seed_of_start(islands.front()); seed && !gives_key(source, "development.seed")) {
      source.overrides.push_back({"development.seed", std::to_string(*seed), "experiment.start"});
      islands = read_islands(source);
    }
    return islands;
  });
}

void print_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings)
    std::cerr << "warning: " << printable(warning, InputError::longest_message) << '\n';
}

std::unique_ptr<Simulator> opened_simulator(const Experiment& experiment) {
  return timed("opening the simulator", [&] { return make_simulator(experiment); });
}

Experiment experiment_of_run(const Archive& archive, const Given& given) {
  return timed("reading the experiment of " + printable(archive.folder().string()) + " and loading its operators",
               [&] { return experiment_for_resimulation(archive, given_plugin_path(given)); });
}

ArchivedIndividual individual_named(const Archive& archive, std::int64_t id) {
  const std::string folder = archive.folder().string();
  const bool is_id = id >= 0 && id <= std::numeric_limits<std::uint32_t>::max();
  auto individual = is_id ? archive.individual(static_cast<std::uint32_t>(id)) : std::nullopt;
  if (!individual)
    throw ArchiveError(folder + ": there is no individual " + std::to_string(id) + "; see `" +
                       shell_command({"show", folder}) + "`");
  return *individual;
}

ArchivedIndividual chosen_individual(const Archive& archive, const Given& given) {
  if (given.contains("individual")) return individual_named(archive, given["individual"].as<std::int64_t>());
  const auto best = archive.best(1);
  if (best.empty())
    throw ArchiveError(archive.folder().string() + ": no individual has a fitness; name one with --individual");
  return archive.known_individual(best.front());
}

}  // namespace evodevo
