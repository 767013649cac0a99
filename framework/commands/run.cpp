// evodevo run, resume and check.
#include "commands/run.hpp"

#include <csignal>
#include <iostream>

#include "base/text.hpp"
#include "commands/options.hpp"
#include "commands/progress.hpp"
#include "commands/verification_report.hpp"
#include "evolution/evolution.hpp"
#include "evolution/record_check.hpp"
#include "experiment/device.hpp"
#include "operators/call_watch.hpp"
#include "operators/plugin_folders.hpp"
#include "threads/parallel.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;
namespace po = boost::program_options;

constexpr int interrupted = 130;

std::atomic<bool> stop_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

/// The first Ctrl-C asks for a stop after the generation under way, or ends the process where an operator does not
/// return; the second ends the process at once. Neither loses anything that is committed.
void stop_on_interrupt() {
  struct sigaction action {};
  action.sa_handler = [](int) { stop_requested = true; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  end_long_calls_after(stop_requested);
}

/// What is left to do can be done later: Ctrl-C ends the process.
void end_on_interrupt() {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
}

/// runs/NAME-1, or the first number that no other run has taken. Making the folder takes it.
fs::path new_run_folder(const std::string& name) {
  std::error_code error;
  fs::create_directories("runs", error);
  for (int number = 1; !error; ++number) {
    fs::path folder = fs::path("runs") / (name + "-" + std::to_string(number));
    if (fs::create_directory(folder, error)) return folder;
  }
  throw ArchiveError("runs: no folder can be made there: " + error.message() + "; give another place with --out");
}

std::string resume_command_for(const Archive& archive) {
  return program_name() + " resume " + archive.folder().string();
}

/// What a failure leaves behind, on a line of its own; nothing where the run's file is gone.
std::string state_of(const Archive& archive) {
  if (!archive.is_in_place()) return "";
  const std::vector<Summary> generations = archive.generations();
  return (generations.empty()
              ? "\nno generation is complete; "
              : "\nthe run is complete up to generation " + std::to_string(generations.back().generation) + "; ") +
         resume_command_for(archive) + " goes on from there";
}

void add_journal_option(po::options_description& options) {
  options.add_options()("journal", po::value<std::string>(),
                        "how SQLite keeps what is being written: wal, by which nobody waits for anybody, or delete, "
                        "which works on file systems of other machines too; default: what the file system bears");
}

/// Throws UsageError.
std::optional<Journal> given_journal(const po::variables_map& given) {
  if (!given.contains("journal")) return std::nullopt;
  const auto text = given["journal"].as<std::string>();
  const auto journal = journal_named(text);
  if (!journal) throw UsageError("--journal " + text + ": expected wal or delete");
  return journal;
}

/// So that `resume` and other commands may load what this run has loaded.
void remember_folders_of(const Experiment& experiment) {
  if (const std::string fault = remember_plugin_folders(experiment.plugin_folders); !fault.empty())
    std::cerr << "warning: " << fault
              << ", so that the folders of operators are not remembered; `resume` and others need --plugin-path\n";
}

void print_warnings(const Experiment& experiment) {
  for (const std::string& warning : experiment.warnings)
    std::cerr << "warning: " << printable(warning, InputError::longest_message) << '\n';
}

std::string title(const OperatorUse& use) { return use.kind + " operator \"" + use.name + "\" " + use.version; }

std::string title(const Maker& maker) { return "evodevo " + maker.version + " (" + maker.program + ")"; }

/// Calls `report(then, now)` for each operator whose library is not the one that the run began with.
template <class Report>
void for_each_changed_operator(const Experiment& experiment, const Maker& first, const Report& report) {
  const std::vector<OperatorUse>& past = first.operators;
  // a run uses the operators of its own record, in the same order
  for (std::size_t i = 0; i < past.size() && i < experiment.uses.size(); ++i)
    if (past[i].hash != experiment.uses[i].hash) report(past[i], experiment.uses[i]);
}

/// Says where the run goes on elsewhere than it began, which may change results.
void warn_of_another_device(const Simulator& simulator, const Archive& archive) {
  if (const std::string before = archive.makers().front().device; before != simulator.device())
    std::cerr << "warning: the run began on " << before << " and goes on on " << simulator.device()
              << "; results may differ, at first in the last bit\n";
}

/// Another build of the same version may do the same; another version says that it does not.
void refuse_other_versions(const Experiment& experiment, const Archive& archive) {
  for_each_changed_operator(experiment, archive.makers().front(), [&](const OperatorUse& then, const OperatorUse& now) {
    if (then.version == now.version) return;
    throw ArchiveError(archive.folder().string() + ": began with " + title(then) + ", but " + now.file.string() +
                       " is version " + now.version + "; put back the version that it began with (it was " +
                       then.file.string() + "), or go on with --allow-other-versions");
  });
}

}  // namespace

void warn_of_other_builds(const Experiment& experiment, const Simulator& simulator, const Archive& archive) {
  const auto warn = [](const auto& then, const auto& now, const std::string& which) {
    std::cerr << "warning: the run began with " << title(then) << ", now it is "
              << (then.version == now.version ? "another build of it" : "version " + now.version) << ", " << which
              << "; results may differ\n";
  };
  const Maker first = archive.makers().front(), here = this_maker(experiment, simulator.device());
  if (first.program != here.program) warn(first, here, here.program);
  for_each_changed_operator(
      experiment, first, [&](const OperatorUse& then, const OperatorUse& now) { warn(then, now, now.file.string()); });
}

int evolve_and_report(const Experiment& experiment, Simulator& simulator, Archive& archive) {
  std::cout << experiment.name << " on " << simulator.device() << ", " << simulator.workers().count()
            << " threads; writing " << archive.folder().string() << std::endl;
  stop_on_interrupt();
  ProgressDisplay progress(experiment, archive.generations(), stop_requested);
  TimeSpent time;
  try {
    time = evolve(experiment, simulator, archive, stop_requested, progress.observer());
  } catch (const std::exception& error) {
    progress.finish();
    throw std::runtime_error(error.what() + remedy_for(error) + state_of(archive));
  }
  progress.finish();
  record_time_spent(archive, time);
  print_outcome(experiment, archive, progress);
  print_time_spent(time, simulator);
  if (is_finished(experiment, archive.generations())) {
    const auto count = static_cast<std::size_t>(experiment.verify);
    if (count > 0)
      std::cout << "verifying the best " << count << "; Ctrl-C leaves that to `" << program_name() << " verify "
                << archive.folder().string() << "`" << std::endl;
    end_on_interrupt();
    for (const Verification& verification : verify_best(experiment, simulator, archive, count))
      print(verification, experiment.objectives.front());
    return 0;
  }
  std::cout << "interrupted; to go on: " << resume_command_for(archive) << std::endl;
  return interrupted;
}

int run_command(const Arguments& arguments) {
  CommandLine line{"run EXPERIMENT.toml [options]", {"EXPERIMENT.toml"}, {}};
  line.options.add_options()("out", po::value<std::string>(), "folder for the run; default: a new one in runs/");
  add_journal_option(line.options);
  add_experiment_options(line.options);
  const auto given = parse(std::move(line), arguments);
  if (!given) return 0;
  const Experiment experiment =
      read_experiment(experiment_source((*given)["EXPERIMENT.toml"].as<std::string>(), *given));
  const std::optional<Journal> journal = given_journal(*given);
  print_warnings(experiment);
  const auto simulator = make_simulator(experiment);
  remember_folders_of(experiment);
  const fs::path folder =
      given->contains("out") ? fs::path((*given)["out"].as<std::string>()) : new_run_folder(experiment.name);
  Archive archive = Archive::create(folder, experiment, simulator->device(), journal);
  return evolve_and_report(experiment, *simulator, archive);
}

int resume_command(const Arguments& arguments) {
  CommandLine line{"resume DIR [--allow-other-versions] [--journal J] [--plugin-path P]", {"DIR"}, {}};
  line.options.add_options()("allow-other-versions", "go on even where an operator has another version than before");
  add_journal_option(line.options);
  add_plugin_option(line.options);
  const auto given = parse(std::move(line), arguments);
  if (!given) return 0;
  Archive archive = Archive::resume((*given)["DIR"].as<std::string>(), given_journal(*given));
  const Experiment experiment = recorded_experiment(archive, given_plugin_path(*given));
  check_resumable(archive, experiment);
  if (!given->contains("allow-other-versions")) refuse_other_versions(experiment, archive);
  const auto simulator = make_simulator(experiment);
  warn_of_another_device(*simulator, archive);
  warn_of_other_builds(experiment, *simulator, archive);
  return evolve_and_report(experiment, *simulator, archive);
}

int check_command(const Arguments& arguments) {
  CommandLine line{"check EXPERIMENT.toml [options]", {"EXPERIMENT.toml"}, {}};
  add_experiment_options(line.options);
  const auto given = parse(std::move(line), arguments);
  if (!given) return 0;
  const auto file = (*given)["EXPERIMENT.toml"].as<std::string>();
  print_warnings(read_experiment(experiment_source(file, *given)));
  std::cout << file << ": ok\n";
  return 0;
}

}  // namespace evodevo
