// evodevo run, resume and check.
#include "commands/run.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <iostream>

#include "base/text.hpp"
#include "cluster/farm.hpp"
#include "cluster/ranks.hpp"
#include "commands/commands.hpp"
#include "commands/shell/builds.hpp"
#include "commands/shell/notices.hpp"
#include "commands/shell/options.hpp"
#include "commands/shell/progress.hpp"
#include "commands/shell/verification_report.hpp"
#include "evolution/breeding.hpp"
#include "evolution/evolution.hpp"
#include "evolution/record_check.hpp"
#include "experiment/device.hpp"
#include "life/birth.hpp"
#include "life/measurement/top_speed.hpp"
#include "life/measurement/windows.hpp"
#include "operators/call_watch.hpp"
#include "operators/plugin_folders.hpp"
#include "threads/parallel.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

constexpr int interrupted = 130;

std::atomic<bool> stop_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

/// Sets what Ctrl-C does. The first Ctrl-C makes the run stop after the current generation, or ends the process if an
/// operator does not return. The second one ends the process at once. Committed generations are kept in any case.
void stop_on_interrupt() {
  struct sigaction action {};
  action.sa_handler = [](int) { stop_requested = true; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  end_long_calls_after(stop_requested);
}

/// Makes Ctrl-C end the process at once, because the remaining work can be done later by another command.
void end_on_interrupt() {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
}

/// Creates and returns the folder runs/NAME-N, where N is the first number from 1 for which there is no folder yet.
fs::path new_run_folder(const std::string& name) {
  std::error_code error;
  fs::create_directories("runs", error);
  for (int number = 1; !error; ++number) {
    fs::path folder = fs::path("runs") / (name + "-" + std::to_string(number));
    if (fs::create_directory(folder, error)) return folder;
  }
  throw ArchiveError("runs: no folder can be created in it: " + error.message() + "; give another place with --out");
}

std::string resume_command_for(const Archive& archive) {
  return program_name() + " resume " + archive.folder().string();
}

/// Returns a line that says which generation the run has completed and how to continue it, or an empty text if the
/// run's file is gone.
std::string state_of(const Archive& archive) {
  if (!archive.is_in_place()) return "";
  const std::vector<Summary> generations = archive.generations();
  return (generations.empty()
              ? "\nno generation is complete; "
              : "\nthe run is complete up to generation " + std::to_string(generations.back().generation) + "; ") +
         "continue the run with `" + resume_command_for(archive) + "`";
}

void add_journal_option(Options& options) {
  options.add_options()(
      "journal", value<std::string>("wal|delete"),
      "journal mode of SQLite: with wal, the run and its readers never wait for each other; delete also "
      "works on network file systems; default: wal if the file system can do it");
}

/// Returns the value of --journal, or nullopt if the option is not given. Throws UsageError if the value is neither wal
/// nor delete.
std::optional<Journal> given_journal(const Given& given) {
  if (!given.contains("journal")) return std::nullopt;
  const auto text = given["journal"].as<std::string>();
  const auto journal = journal_named(text);
  if (!journal) throw UsageError("--journal " + text + ": expected wal or delete");
  return journal;
}

/// Remembers the folders of the experiment's operators, so that `resume` and other commands may load these operators.
void remember_folders_of(const Experiment& experiment) {
  if (const std::string fault = remember_plugin_folders(experiment.plugin_folders); !fault.empty())
    std::cerr << "warning: " << fault
              << ", so the folders of operators are not remembered; give them to `resume` and other commands with "
                 "--plugin-path\n";
}

/// Returns a text that says with how many threads, devices and ranks a run works.
std::string places_text(Simulator& simulator, const Farm* farm) {
  const std::size_t threads = simulator.workers().count();
  std::string text = std::to_string(threads) + (threads == 1 ? " thread" : " threads");
  if (const std::optional<DeviceUse> use = simulator.device_use(); use && use->devices > 1)
    text = std::to_string(use->devices) + " devices, " + text;
  if (farm) text += " on rank 0 of " + std::to_string(farm->shares().size());
  return text;
}

/// Lets this rank work for rank 0, if it is another one. Returns whether that is so.
bool served(const Ranks& ranks, const Given& given) {
  if (ranks.leads()) return false;
  // rank 0 decides when the run stops; a second signal ends this rank
  struct sigaction action {};
  action.sa_handler = [](int) {};
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  serve(*ranks.channel(), [&] {
    return RankOptions{given_plugin_path(given), given_gpus(given), given_machine(given), given.contains("mixed")};
  });
  return true;
}

void add_mixed_option(Options& options) {
  options.add_options()(
      "mixed",
      "let ranks have different devices and builds; the run records with which of them each individual was evaluated");
}

/// Returns the farm of all ranks; nothing if there is only this process. `is_record` is that of ExperimentSource.
std::unique_ptr<Farm> farm_of(const Ranks& ranks, const Experiment& experiment, Simulator& simulator, bool is_record,
                              const Given& given) {
  if (!ranks.channel()) return nullptr;
  const message::Setup setup{
      .text = experiment.resolved, .name = experiment.name, .files = experiment.files, .is_record = is_record};
  const FarmOptions options{.mixed = given.contains("mixed")};
  return timed("waiting for the other ranks",
               [&] { return std::make_unique<Farm>(experiment, simulator, *ranks.channel(), setup, options); });
}

void print_warnings(const Experiment& experiment) {
  for (const std::string& warning : experiment.warnings)
    std::cerr << "warning: " << printable(warning, InputError::longest_message) << '\n';
}

}  // namespace

int evolve_and_report(const Experiment& experiment, Simulator& simulator, Archive& archive, Farm* farm) {
  remarks() << experiment.name << " on " << simulator.device() << ", " << places_text(simulator, farm) << "; writing "
            << archive.folder().string() << std::endl;
  stop_on_interrupt();
  ProgressDisplay progress(experiment, archive.generations(), stop_requested, farm);
  TimeSpent time;
  try {
    time = farm ? evolve(experiment, *farm, archive, stop_requested, progress.observer())
                : evolve(experiment, simulator, archive, stop_requested, progress.observer());
  } catch (const std::exception& error) {
    progress.finish();
    throw std::runtime_error(error.what() + remedy_for(error) + state_of(archive));
  }
  progress.finish();
  record_time_spent(archive, time);
  print_outcome(experiment, archive, progress);
  print_time_spent(time, simulator);
  if (farm) {
    print_shares(farm->shares(), time.whole);
    farm->finish();
  }
  if (is_finished(experiment, archive.generations())) {
    const auto count = is_verifiable(experiment) ? static_cast<std::size_t>(experiment.verify) : 0;
    if (count < static_cast<std::size_t>(experiment.verify))
      remarks() << "not verified: " << experiment.objectives.front().name
                << " is measured within the life, which verification does not repeat" << std::endl;
    if (count > 0)
      remarks() << "verifying the best " << count << "; Ctrl-C stops this, and it can be done later by `"
                << program_name() << " verify " << archive.folder().string() << "`" << std::endl;
    end_on_interrupt();
    for (const Verification& verification : verify_best(experiment, simulator, archive, count))
      print(verification, experiment.objectives.front());
    return 0;
  }
  std::cout << "interrupted; to continue: " << resume_command_for(archive) << std::endl;
  return interrupted;
}

namespace {

int run(const Given& given) {
  const Ranks ranks = Ranks::joined();
  if (served(ranks, given)) return 0;
  Experiment experiment = given_experiment(given["EXPERIMENT.toml"].as<std::string>(), given);
  const std::optional<Journal> journal = given_journal(given);
  print_warnings(experiment);
  if (ranks.channel()) share_host(experiment, *ranks.channel(), given.contains("mixed"));
  const auto simulator = opened_simulator(experiment);
  remember_folders_of(experiment);
  const auto farm = farm_of(ranks, experiment, *simulator, false, given);
  const fs::path folder =
      given.contains("out") ? fs::path(given["out"].as<std::string>()) : new_run_folder(experiment.name);
  Archive archive = Archive::create(folder, experiment, simulator->device(), journal);
  return evolve_and_report(experiment, *simulator, archive, farm.get());
}

int resume(const Given& given) {
  const Ranks ranks = Ranks::joined();
  if (served(ranks, given)) return 0;
  Archive archive = Archive::resume(given["DIR"].as<std::string>(), given_journal(given));
  Experiment experiment = timed("reading the record of the run and loading its operators", [&] {
    return recorded_experiment(archive, given_plugin_path(given), given_machine(given));
  });
  experiment.gpus = given_gpus(given);
  timed("checking that the run can be continued", [&] { check_resumable(archive, experiment); });
  if (!given.contains("allow-other-versions")) refuse_other_versions(experiment, archive);
  if (ranks.channel()) share_host(experiment, *ranks.channel(), given.contains("mixed"));
  const auto simulator = opened_simulator(experiment);
  warn_of_another_device(*simulator, archive);
  warn_of_other_builds(experiment, *simulator, archive);
  const auto farm = farm_of(ranks, experiment, *simulator, true, given);
  return evolve_and_report(experiment, *simulator, archive, farm.get());
}

/// Prints how much memory samples by mass and by spring take, if a fitness operator asks for any.
void print_sample_memory(const Experiment& experiment) {
  constexpr std::size_t masses = 1000, springs = 10'000;
  const Windows windows(experiment, 0);
  const double small = windows.bytes_after_maturing(0, 0) + windows.bytes_within_life(0, 0),
               after = windows.bytes_after_maturing(masses, springs),
               within = windows.bytes_within_life(masses, springs);
  if (!(after + within > small)) return;
  const auto megabytes = [](double bytes) { return short_number(bytes / 1e6) + " MB"; };
  std::cout << "samples: " << megabytes(after) << " after maturing and " << megabytes(within)
            << " within the life, for a robot of " << masses << " masses and " << springs << " springs; at most "
            << megabytes(std::max(after, most_sample_bytes)) << " after maturing at once\n";
}

/// Returns the lengths at birth of those of the first random robots that have a length, m, in ascending order.
std::vector<double> lengths_at_birth(const Experiment& experiment) {
  constexpr std::int64_t most = 10;
  std::vector<double> lengths;
  const auto count = static_cast<std::size_t>(std::min(most, experiment.newborns()));
  for (const Individual& robot : breed(experiment, {}, 0, 0, count)) {
    const BuiltBody built = build_body(decoded(experiment, robot.genome, {.individual = robot.id}));
    const double length = bounding_box(rest_positions(built.body)).longest_side();
    if (built.failure.empty() && length > 0) lengths.push_back(length);
  }
  std::sort(lengths.begin(), lengths.end());
  return lengths;
}

/// Returns a text such as "0.2" or "0.2 to 0.3".
std::string range_text(double low, double high) {
  const std::string from = short_number(low), to = short_number(high);
  return from == to ? from : from + " to " + to;
}

/// Returns a text such as "0.24 m/s" or, on a slope, "0.3 m/s downhill, and 0.2 m/s uphill,".
std::string top_speed_text(const Scene& scene) {
  const auto [uphill, downhill] = std::minmax({top_speed(scene, -1), top_speed(scene, 1)});
  const std::string fastest = short_number(downhill) + " m/s";
  if (uphill == downhill) return fastest;
  return fastest + " downhill, and " + (uphill > 0 ? short_number(uphill) + " m/s" : "nothing") + " uphill,";
}

/// Prints what limits the speed of robots that move by friction. `lengths` are those of some robots, m, in ascending
/// order; `window` is the time during which the first objective is measured, s; 0: it is not a time in this scene.
void print_top_speed(const Scene& scene, const std::vector<double>& lengths, double window) {
  const double fastest = std::max(top_speed(scene, -1), top_speed(scene, 1));
  if (std::isinf(fastest)) {
    std::cout << "there is no damping, so only its muscles limit the speed of a robot\n";
    return;
  }
  std::cout << "friction keeps up at most " << top_speed_text(scene) << " against the damping";
  if (!lengths.empty()) {
    const double low = fastest / lengths.back(), high = fastest / lengths.front();
    std::cout << ": " << range_text(low, high) << " body lengths per second, ";
    if (window > 0)
      std::cout << "or " << range_text(low * window, high * window) << " in the window of " << short_number(window)
                << " s, ";
    std::cout << "for the first random robots, which are " << range_text(lengths.front(), lengths.back())
              << " m long at birth";
  }
  std::cout << '\n';
}

/// Prints it for each scene in which robots are measured.
void print_top_speeds(const Experiment& experiment) {
  std::vector<std::pair<std::string, const Scene*>> scenes;
  if (experiment.scenarios.empty()) scenes.emplace_back("", &experiment.scene);
  for (const Scenario& scenario : experiment.scenarios)
    scenes.emplace_back(" in scenario " + scenario.name, &scenario.scene);
  std::erase_if(scenes, [](const auto& named) { return !moves_by_friction(*named.second); });
  if (scenes.empty()) return;
  const std::vector<double> lengths = lengths_at_birth(experiment);
  const std::optional<Request> request = first_objective_request(experiment);
  const double window = request && !request->cycle ? request->window : 0;
  for (const auto& [where, scene] : scenes) {
    std::cout << "top speed" << where << ": ";
    print_top_speed(*scene, lengths, window);
  }
}

int check(const Given& given) {
  const auto file = given["EXPERIMENT.toml"].as<std::string>();
  const Experiment experiment = given_experiment(file, given);
  print_warnings(experiment);
  print_sample_memory(experiment);
  print_top_speeds(experiment);
  std::cout << file << ": ok\n";
  return 0;
}

}  // namespace

Command run_command() {
  Options options;
  options.add_options()("out", value<std::string>("DIR"), "folder of the run; default: a new one in runs/");
  add_journal_option(options);
  add_mixed_option(options);
  add_experiment_options(options);
  return {
      .name = "run",
      .arguments = {{"EXPERIMENT.toml"}},
      .summary = "Evolve robots",
      .text = {"The run writes all individuals of all generations into its folder, and verifies its best individual "
               "at the end. Ctrl-C ends it after the current generation, a second Ctrl-C ends it at once; `resume` "
               "continues it. Results do not depend on the numbers of threads, GPUs and processes, except with "
               "--mixed. A run uses all equal GPUs, and all processes that mpirun or srun starts."},
      .examples = {"run experiments/quickstart.toml",
                   "run experiments/quickstart.toml --seed 2 --set selection.name=elitist --out runs/elitist",
                   "run experiments/evo-devo.toml --device cuda:0,2"},
      .options = options,
      .function = run};
}

Command resume_command() {
  Options options;
  options.add_options()("allow-other-versions",
                        "continue even if an operator has another version than when the run began");
  add_journal_option(options);
  add_mixed_option(options);
  add_machine_options(options);
  add_plugin_option(options);
  return {
      .name = "resume",
      .arguments = {{"DIR"}},
      .summary = "Continue an interrupted run",
      .text = {"The run ends as if it had never been interrupted, unless it was or is --mixed. It warns if the device, "
               "or the build of evodevo or of an operator, is none of those that took part in the run before."},
      .examples = {"resume runs/quickstart-1"},
      .options = options,
      .function = resume};
}

Command check_command() {
  Options options;
  add_experiment_options(options);
  return {.name = "check",
          .arguments = {{"EXPERIMENT.toml"}},
          .summary = "Check an experiment without running it",
          .text = {"It reads the experiment, loads its operators and checks all values. An error names the place, the "
                   "value and the remedy. It also prints the top speed that friction and damping allow in the scene."},
          .examples = {"check experiments/paper.toml", "check my.toml --set experiment.population=100"},
          .options = options,
          .function = check};
}

}  // namespace evodevo
