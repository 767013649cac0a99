// evodevo run and resume.
#include "commands/run/run.hpp"

#include <algorithm>
#include <iostream>
#include <iterator>

#include "base/text.hpp"
#include "cluster/farm.hpp"
#include "cluster/ranks.hpp"
#include "commands/commands.hpp"
#include "commands/run/early_end.hpp"
#include "commands/run/island_ranks.hpp"
#include "commands/run/islands.hpp"
#include "commands/run/page.hpp"
#include "commands/run/progress.hpp"
#include "commands/run/run_options.hpp"
#include "commands/shell/options.hpp"
#include "commands/shell/output/notices.hpp"
#include "commands/shell/verification_report.hpp"
#include "engine/builds.hpp"
#include "evolution/islands/island_folders.hpp"
#include "experiment/device.hpp"
#include "operators/call_watch.hpp"
#include "operators/plugin_folders.hpp"
#include "report/run_json.hpp"
#include "threads/parallel.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

std::string resume_command_for(const Archive& archive) { return shell_command({"resume", archive.folder().string()}); }

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

/// Lets this rank work for rank 0, if it is another one, or lead a group of ranks. Returns whether that is so.
bool served(const Ranks& ranks, const Given& given) {
  if (ranks.leads()) return false;
  // rank 0 decides when the run ends, so the first signal changes nothing here; a second one ends this rank
  stop_on_signals();
  const auto options = [&] {
    return RankOptions{given_plugin_path(given), given_gpus(given), given_machine(given), given.contains("mixed")};
  };
  const std::optional<std::string> first = first_message(*ranks.channel());
  if (!first) return true;
  if (message::kind_of(*first) == message::Kind::lead)
    serve_islands(*ranks.channel(), *first, given, options);
  else
    serve(*ranks.channel(), *first, options);
  return true;
}

/// Returns what the options say of the run in a folder, with the ranks that work for it, if there are others; the farm
/// that they make is then put into `farm`. `is_record` is that of ExperimentSource. The arguments must outlive it.
RunSpec spec_of(const Given& given, const fs::path& folder, const Ranks& ranks, bool is_record, Farm*& farm) {
  RunSpec spec = given_spec(given, folder);
  if (!ranks.channel()) return spec;
  const bool mixed = given.contains("mixed");
  spec.share = [&ranks, mixed](Experiment& experiment) { share_host(experiment, *ranks.channel(), mixed); };
  spec.evaluator = [&ranks, &farm, is_record, mixed](const Experiment& experiment, Simulator& simulator) {
    const message::Setup setup{
        .text = experiment.resolved, .name = experiment.name, .files = experiment.files, .is_record = is_record};
    auto made = timed("waiting for the other ranks", [&] {
      return std::make_unique<Farm>(experiment, simulator, *ranks.channel(), setup, FarmOptions{.mixed = mixed});
    });
    farm = made.get();
    return made;
  };
  return spec;
}

/// Returns the file of an experiment and the files that its parameters name.
std::vector<fs::path> files_of_experiment(const fs::path& file, const Experiment& experiment) {
  std::vector<fs::path> files{file};
  for (const auto& [name, content] : experiment.files) files.push_back(file.parent_path() / name);
  return files;
}

RunOutput output_of(const Given& given, GenerationLog* log, TimeLimit* limit) {
  return {log, !given.contains("no-report"), limit};
}

}  // namespace

std::size_t begin_ending(const Experiment& experiment, const RunOutput& output, bool has_best,
                         const std::string& later) {
  end_on_signals();
  if (output.limit != nullptr) end_at(output.limit->end());
  if (experiment.verify == 0 || !has_best) return 0;
  if (!is_verifiable(experiment)) {
    remarks() << "not verified: " << experiment.objectives.front().name
              << " is measured within the life, which verification does not repeat" << std::endl;
    return 0;
  }
  remarks() << "verifying the best " << experiment.verify << "; Ctrl-C stops this, and it can be done later by `"
            << later << "`" << std::endl;
  return static_cast<std::size_t>(experiment.verify);
}

void RunOutput::generation_done(const Summary& summary, std::int64_t island) const {
  if (log != nullptr) log->add(summary, island);
  if (limit == nullptr) return;
  limit->generation_done(summary.wall_time, TimeLimit::Clock::now());
  if (limit->is_reached()) stop_requested() = true;
}

namespace {

/// Verifies the best of a run, and shows them on a page, as far as the user asks for it.
void verify_and_show(Run& run, const RunOutput& output) {
  const Archive& archive = run.archive();
  const std::size_t count = begin_ending(run.experiment(), output, !archive.best(1).empty(),
                                         shell_command({"verify", archive.folder().string()}));
  print(timed("verifying the best individuals", [&] { return run.verify(count); }),
        run.experiment().objectives.front());
  if (!output.page) return;
  const ShownRun shown{run.experiment(), archive};
  show_runs(archive.folder(), {&shown, 1}, run.simulator());
}

}  // namespace

int evolve_and_report(Run& run, Farm* farm, const RunOutput& output) {
  const Experiment& experiment = run.experiment();
  const Archive& archive = run.archive();
  stop_on_signals();
  end_long_calls_after(stop_requested());
  remarks() << experiment.name << " on " << run.simulator().device() << ", " << places_text(run.simulator(), farm)
            << "; writing " << archive.folder().string() << std::endl;
  ProgressDisplay progress(experiment, archive.generations(), stop_requested(), farm);
  Observer observer = progress.observer();
  observer.generation_done = [&output, display = observer.generation_done](const Summary& summary) {
    display(summary);
    output.generation_done(summary);
  };
  TimeSpent time;
  try {
    while (run.advance(stop_requested(), observer)) {
    }
    time = run.pause();
  } catch (const std::exception& error) {
    progress.finish();
    throw std::runtime_error(error.what() + remedy_for(error) + state_of(archive));
  }
  progress.finish();
  const bool has_best = print_best(experiment, archive);
  print_speed(static_cast<double>(progress.spring_evaluations()), progress.seconds(), time.verify);
  print_time_spent(time, run.simulator());
  if (farm) {
    print_shares(farm->shares(), time.whole);
    farm->finish();
  }
  const bool finished = run.is_finished();
  if (finished || output.ends_by_clock()) verify_and_show(run, output);
  if (finished) return has_best ? 0 : no_fitness;
  std::cout << "ended early; to continue: " << resume_command_for(archive) << std::endl;
  return ended_early;
}

namespace {

/// Begins a run with islands, or goes on with it.
int evolve_and_report(Islands islands, Simulator& simulator, const Ranks& ranks, const Given& given,
                      const RunOutput& output) {
  std::atomic<bool>& stop = stop_requested();
  stop_on_signals();
  end_long_calls_after(stop);
  remarks() << islands.experiments.front().name << " on " << simulator.device() << ", "
            << places_text(simulator, nullptr) << "; writing " << islands.experiments.size() << " islands in "
            << islands.folder.string() << std::endl;
  return ranks.channel() ? evolve_and_report(islands, simulator, *ranks.channel(), given, stop, output)
                         : evolve_and_report(islands, simulator, stop, output);
}

int begin_islands(const Ranks& ranks, std::vector<Experiment> islands, const RunSpec& spec, const Given& given,
                  const RunOutput& output) {
  Experiment& first = islands.front();
  const auto simulator = opened_to_begin(first, spec, printed_events());
  remember_folders_of(first);
  const fs::path folder = spec.folder.empty() ? new_run_folder(first.name) : spec.folder;
  return evolve_and_report(created_islands(folder, std::move(islands), simulator->device(), given), *simulator, ranks,
                           given, output);
}

/// Does what `evodevo run` does if the folder of the run holds no run yet. `islands` has the experiments of all
/// islands, or the only one of the run.
int begin(const Ranks& ranks, const std::string& file, std::vector<Experiment> islands, const Given& given,
          TimeLimit* limit) {
  Farm* farm = nullptr;
  const fs::path folder = given.contains("out") ? given["out"].as<std::string>() : "";
  if (given.contains("out") && folder.empty())
    throw UsageError("--out: is empty; give a folder, or leave the option out");
  const RunSpec spec = spec_of(given, folder, ranks, false, farm);
  Experiment& first = islands.front();
  const std::unique_ptr<GenerationLog> log = given_log(given, first, files_of_experiment(file, first));
  const RunOutput output = output_of(given, log.get(), limit);
  if (islands.size() > 1) return begin_islands(ranks, std::move(islands), spec, given, output);
  Run run = Run::begin(std::move(first), spec, printed_events());
  remember_folders_of(run.experiment());
  return evolve_and_report(run, farm, output);
}

/// Says that a run with islands is complete, so that there is nothing to do, and returns the exit code.
int say_complete(const Islands& islands) {
  const std::string run = islands.folder.string();
  std::cout << run << ": the run is complete on all islands; to look at it: " << shell_command({"show", run})
            << std::endl;
  const bool has_best = std::ranges::any_of(islands.archives, [](const Archive& one) { return !one.best(1).empty(); });
  return has_best ? 0 : no_fitness;
}

/// Says that a run is complete, so that there is nothing to do, and returns the exit code.
int say_complete(const Archive& archive) {
  const Summary last = archive.generations().back();
  std::cout << archive.folder().string() << ": the run is complete: " << last.evaluations << " evaluations in "
            << last.generation + 1
            << " generations; to look at it: " << shell_command({"show", archive.folder().string()})
            << "; to go on from its population in another run: "
            << shell_command({"run", "EXPERIMENT.toml", "--set",
                              "experiment.start=" + fs::absolute(archive.folder()).lexically_normal().string()})
            << std::endl;
  return archive.best(1).empty() ? no_fitness : 0;
}

/// Returns the files of all islands of a run.
std::vector<fs::path> files_of_islands(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::path& island : archive_folders(folder))
    std::ranges::move(files_of_run(island), std::back_inserter(files));
  return files;
}

/// Continues the run with islands in a folder. `expected` has the experiments of its islands if the user names them.
int go_on_with_islands(const Ranks& ranks, const fs::path& folder, const Given& given, TimeLimit* limit,
                       const std::vector<Experiment>* expected) {
  Islands islands = reopened_islands(folder, given, expected);
  Experiment& first = islands.experiments.front();
  if (are_complete(islands)) return say_complete(islands);
  if (ranks.channel()) share_host(first, *ranks.channel(), given.contains("mixed"));
  const auto simulator = opened_simulator(first);
  print_warnings(another_device(*simulator, islands.archives.front()));
  print_warnings(other_builds(first, *simulator, islands.archives.front()));
  const std::unique_ptr<GenerationLog> log = given_log(given, first, files_of_islands(folder));
  return evolve_and_report(std::move(islands), *simulator, ranks, given, output_of(given, log.get(), limit));
}

/// Continues the run in a folder. `expected` has the experiment of the run, or those of its islands, if the user names
/// it; throws ArchiveError if the run is of another one.
int go_on(const Ranks& ranks, const fs::path& folder, const Given& given, TimeLimit* limit,
          const std::vector<Experiment>* expected = nullptr) {
  if (has_islands(folder)) return go_on_with_islands(ranks, folder, given, limit, expected);
  Farm* farm = nullptr;
  const RunSpec spec = spec_of(given, folder, ranks, true, farm);
  Run run = Run::open(spec, printed_events(), expected ? &expected->front() : nullptr);
  if (run.is_complete()) return say_complete(run.archive());
  const std::unique_ptr<GenerationLog> log = given_log(given, run.experiment(), files_of_run(folder));
  return evolve_and_report(run, farm, output_of(given, log.get(), limit));
}

/// Whether --resume is given and the folder of --out holds a run, with `islands` islands. Throws UsageError for
/// --resume without --out.
bool is_to_go_on(const Given& given, std::size_t islands) {
  if (!given.contains("resume")) return false;
  if (!given.contains("out")) throw UsageError("--resume: give the folder of the run with --out");
  const fs::path folder = given["out"].as<std::string>();
  return has_islands(folder) ? !is_half_created(folder, static_cast<std::int64_t>(islands)) : is_begun(folder);
}

int make_run_of(const Ranks& ranks, const Given& given) {
  const auto file = given["EXPERIMENT.toml"].as<std::string>();
  const std::unique_ptr<TimeLimit> limit = given_limit(given);
  std::vector<Experiment> islands = given_islands(file, given);
  if (!is_to_go_on(given, islands.size())) return begin(ranks, file, std::move(islands), given, limit.get());
  remember_folders_of(islands.front());
  return go_on(ranks, given["out"].as<std::string>(), given, limit.get(), &islands);
}

int run(const Given& given) {
  end_on_signals();
  const Ranks ranks = Ranks::joined();
  return served(ranks, given) ? 0 : make_run_of(ranks, given);
}

int resume(const Given& given) {
  end_on_signals();
  const Ranks ranks = Ranks::joined();
  if (served(ranks, given)) return 0;
  return go_on(ranks, given["DIR"].as<std::string>(), given, given_limit(given).get());
}

}  // namespace

int make_run(const Given& given) { return make_run_of(Ranks::alone(), given); }

Command run_command() {
  Options options;
  options.add_options()("out", value<std::string>("DIR"), "folder of the run; default: a new one in runs/");
  options.add_options()("resume",
                        "continue the run in the folder of --out if there is one, and begin it otherwise, so that the "
                        "same command can be given again; a run that is complete stays as it is");
  add_versions_option(options);
  add_output_options(options);
  add_journal_option(options);
  add_mixed_option(options);
  add_experiment_options(options);
  return {
      .name = "run",
      .arguments = {{"EXPERIMENT.toml"}},
      .summary = "Evolve robots",
      .text =
          {"The run writes all individuals of all generations into its folder, and verifies its best individual "
           "at the end. Then it shows its best robots on a page, if the viewer has been built. Ctrl-C, SIGTERM and "
           "SIGUSR1 end it after the current generation, a second one ends it at once, both with exit code 130; "
           "`resume` continues it. Results do not depend on the numbers of threads, GPUs and processes, except with "
           "--mixed. A run uses all equal GPUs, and all processes that mpirun or srun starts."},
      .examples = {"run experiments/quickstart.toml",
                   "run experiments/quickstart.toml --seed 2 --set selection.name=elitist --out runs/elitist",
                   "run experiments/evo-devo.toml --device cuda:0,2",
                   "run experiments/evo-devo.toml --out runs/evo-devo --resume"},
      .options = options,
      .function = run};
}

Command resume_command() {
  Options options;
  add_versions_option(options);
  add_output_options(options);
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

}  // namespace evodevo
