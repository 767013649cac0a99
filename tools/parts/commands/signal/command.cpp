// evodevo signal: measures what of its scores an experiment's selection can use.
#include <fmt/ostream.h>

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "archive/island_folders.hpp"
#include "archive/record_check.hpp"
#include "archive/recorded_experiment.hpp"
#include "base/json_text.hpp"
#include "base/output_file.hpp"
#include "base/text.hpp"
#include "commands/commands.hpp"
#include "commands/shell/options.hpp"
#include "commands/shell/output/notices.hpp"
#include "engine/builds.hpp"
#include "report/signal.hpp"
#include "signal/chart.hpp"
#include "signal/measuring.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t most_robots = 1000;

void print(const std::vector<SignalNumber>& numbers) {
  std::size_t width = 13;
  for (const SignalNumber& number : numbers) width = std::max(width, number.of.size());
  const auto line = [&](const auto&... cells) {
    fmt::print(std::cout, "{:<8}  {:<28}  {:<{}}  {:<5}  {:>9}  {:<20}  {:>5}\n", cells...);
  };
  line("robots", "quantity", "of", width, "scale", "value", "95 % interval", "count");
  for (const SignalNumber& number : numbers) {
    std::string interval = "-";
    if (number.low && number.high) interval = short_number(*number.low) + " to " + short_number(*number.high);
    line(number.population, number.quantity, number.of, width, number.scale, short_number(number.value), interval,
         number.count);
  }
  std::cout << '\n';
}

/// Throws UsageError if an option is given that changes the experiment, which that of a run must not.
void refuse_changes(const std::string& folder, const Given& given) {
  for (const char* option : {"set", "seed"})
    if (given.contains(option))
      throw UsageError(std::string("--") + option + ": " + printable(folder) +
                       " is a run, which has its settings; leave the option out, or give the file of an experiment");
}

/// Returns the folder of the archive that is measured: of a run with islands, that of the island with the best robot.
fs::path measured_folder(const fs::path& run) {
  if (!has_islands(run)) return run;
  const std::vector<fs::path> folders = island_folders(run);
  std::vector<Archive> archives;
  for (const fs::path& folder : folders) archives.push_back(Archive::read(folder));
  const std::vector<IslandIndividual> best = best_of_islands(archives, 1);
  const fs::path& measured = folders.at(best.empty() ? 0 : best.front().island);
  if (verbosity() != Verbosity::quiet)
    std::cerr << "measuring " << printable(measured.string()) << ", the island with the best robot" << std::endl;
  return measured;
}

/// Returns the experiment of a run, on the machine that the options ask for.
Experiment experiment_of(const Archive& archive, const Given& given) {
  const std::vector<Override> machine = given_machine(given);
  if (machine.empty()) return experiment_of_run(archive, given);
  Experiment experiment = recorded_experiment(archive, given_plugin_path(given), machine);
  experiment.gpus = given_gpus(given);
  return experiment;
}

/// Returns what is measured of a run: its population and its best robot.
MeasuredRobots measured_of(const Archive& archive, const Experiment& experiment, std::size_t robots) {
  const std::vector<std::uint32_t> best = archive.best(1);
  if (best.empty())
    throw ArchiveError(archive.folder().string() + ": no individual has a fitness; measure its experiment instead, `" +
                       shell_command({"signal", "EXPERIMENT.toml"}) + "`");
  MeasuredRobots measured{robots, archive.known_individual(best.front()), archive.population()};
  check_genes(archive, experiment, *measured.champion);
  for (const Individual& individual : measured.last) check_genes(archive, experiment, individual);
  return measured;
}

int signal(const Given& given) {
  const auto robots = given["robots"].as<std::int64_t>();
  if (robots < static_cast<std::int64_t>(least_robots) || robots > most_robots)
    throw UsageError("--robots " + std::to_string(robots) + ": expected " + std::to_string(least_robots) + " to " +
                     std::to_string(most_robots));
  const auto subject = given["PATH"].as<std::string>();
  std::optional<Archive> archive;
  if (fs::is_directory(subject)) {
    refuse_changes(subject, given);
    archive.emplace(Archive::annotate(measured_folder(subject)));
  }
  // of an experiment with islands, the first; as for a run, the development of another run goes with its robots
  const Experiment experiment =
      archive ? experiment_of(*archive, given) : std::move(given_islands(subject, given).front());
  print_warnings(experiment.warnings);
  if (given.contains("svg") && experiment.makes_children())
    throw UsageError("--svg " + printable(given["svg"].as<std::string>()) + ": " + experiment.child_maker +
                     " makes children of the whole population, so that there are no parents to draw them over; leave "
                     "the option out");
  std::optional<OutputFile> chart;
  if (given.contains("svg")) {
    const auto file = given["svg"].as<std::string>();
    std::vector<fs::path> inputs = libraries_of(experiment);
    for (const fs::path& input : archive ? files_of_run(archive->folder()) : std::vector<fs::path>{subject})
      inputs.push_back(input);
    refuse_to_overwrite("--svg", file, inputs);
    chart.emplace(file, "--svg " + printable(file));
  }
  const auto count = static_cast<std::size_t>(robots);
  std::uint32_t generation = 0;  // whose population is measured
  if (archive)
    for (const Summary& summary : archive->generations()) generation = summary.generation;
  const MeasuredRobots measured = archive ? measured_of(*archive, experiment, count) : MeasuredRobots{count};
  const auto simulator = opened_simulator(experiment);
  if (archive) print_warnings(other_builds(experiment, *simulator, *archive));
  const Signal found = measure_signal(experiment, *simulator, measured, [](const std::string& what) {
    if (verbosity() != Verbosity::quiet) std::cerr << "measuring " << what << std::endl;
  });
  for (const std::string& note : found.notes) std::cerr << "note: " << printable(note) << '\n';
  const bool is_kept = archive && archive->set_signal(found.numbers, generation);
  if (archive && !is_kept)
    std::cerr << "warning: the run has gone on meanwhile, and does not keep these numbers of an earlier population\n";
  const Objective& objective = experiment.objectives.front();
  if (chart) {
    chart->write(signal_chart(found, objective));
    chart->finish();
  }
  if (given.contains("json")) {
    std::cout << json_text(signal_json(found.numbers, experiment, objective)) << '\n';
    return 0;
  }
  print(found.numbers);
  for (const std::string& sentence : sentences_on(found.numbers, experiment, objective))
    std::cout << wrapped(sentence) << '\n';
  if (is_kept)
    remarks() << "the run keeps these numbers; a page with them: "
              << shell_command({"report", archive->folder().string()}) << '\n';
  return 0;
}

}  // namespace

Command signal_command() {
  Options options;
  options.add_options()("robots", value<std::int64_t>("N")->default_value(60),
                        "how many robots of each population to measure")(
      "svg", value<std::string>("FILE"), "write a chart of the scores of children over those of their parents")(
      "json", "print JSON");
  add_experiment_options(options);
  return {
      .name = "signal",
      .arguments = {{"PATH"}},
      .summary = "Measure what repeats in scores and what children inherit",
      .text = {"PATH is the file of an experiment or the folder of a run. Random robots live again and again, and so "
               "do children that the experiment's mutation and crossover make "
               "of them. The command says which share of the differences between scores lies between robots and not "
               "between lives of one (repeatability), which share children inherit (heritability), and what would "
               "help. Of a run, it also measures the last population and the best robot with its children, stores the "
               "numbers in the run, and the next `report` shows them. Of a run with islands, it measures the island "
               "with the best robot. `help heredity` explains the numbers."},
      .examples = {"signal experiments/quickstart.toml", "signal runs/quickstart-1 --svg children.svg",
                   "signal experiments/walker.toml --robots 200 --json"},
      .options = options,
      .function = signal};
}

}  // namespace evodevo
