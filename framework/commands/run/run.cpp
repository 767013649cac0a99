// evodevo run and resume.
#include "commands/run/run.hpp"

#include <algorithm>
#include <iostream>
#include <iterator>

#include "archive/island_folders.hpp"
#include "base/text.hpp"
#include "cluster/ranks.hpp"
#include "commands/commands.hpp"
#include "commands/run/early_end.hpp"
#include "commands/run/page.hpp"
#include "commands/run/progress.hpp"
#include "commands/run/run_options.hpp"
#include "commands/shell/options.hpp"
#include "commands/shell/output/notices.hpp"
#include "commands/shell/verification_report.hpp"
#include "experiment/device.hpp"
#include "operators/call_watch.hpp"
#include "operators/plugin_folders.hpp"
#include "threads/parallel.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

std::string resume_command_for(const Run& run) { return shell_command({"resume", run.folder().string()}); }

/// Returns a line that says which generations the run has completed and how to continue it, or an empty text if a file
/// of the run is gone.
std::string state_of(const Run& run) {
  if (run.archives().size() != run.experiments().size() || !std::ranges::all_of(run.archives(), &Archive::is_in_place))
    return "";
  const std::vector<std::uint32_t> next = next_generations(run.archives());
  const auto [least, most] = std::ranges::minmax(next);
  std::string complete;
  if (least == 0)
    complete = run.has_islands() ? "an island has not completed any generation" : "no generation is complete";
  else
    complete = std::string(run.has_islands() ? "the islands are" : "the run is") + " complete up to generation" +
               (least == most ? " " : "s " + std::to_string(least - 1) + " to ") + std::to_string(most - 1);
  return "\n" + complete + "; continue the run with `" + resume_command_for(run) + "`";
}

/// Remembers the folders of the experiment's operators, so that `resume` and other commands may load these operators.
void remember_folders_of(const Experiment& experiment) {
  if (const std::string fault = remember_plugin_folders(experiment.plugin_folders); !fault.empty())
    std::cerr << "warning: " << fault
              << ", so the folders of operators are not remembered; give them to `resume` and other commands with "
                 "--plugin-path\n";
}

/// Returns a text that says what is run where: with how many threads, devices and ranks.
std::string places_text(Run& run) {
  Simulator& simulator = run.simulator();
  const std::size_t threads = simulator.workers().count(), ranks = run.shares().size();
  std::string text = std::to_string(threads) + (threads == 1 ? " thread" : " threads");
  if (const std::optional<DeviceUse> use = simulator.device_use(); use && use->devices > 1)
    text = std::to_string(use->devices) + " devices, " + text;
  if (ranks > 0) text += " on rank 0 of " + std::to_string(ranks);
  text += "; writing ";
  if (run.has_islands()) text += std::to_string(run.archives().size()) + " islands in ";
  return text + run.folder().string();
}

/// Begins the end of a run, when nothing is evolved any more: from now on, signals and the time limit end the process
/// at once. Returns the number of best individuals to verify, and announces it, if an individual has a fitness.
std::size_t begin_ending(const Run& run, const RunOutput& output) {
  end_on_signals();
  if (output.limit) end_at(output.limit->end());
  const Experiment& first = run.experiments().front();
  if (first.verify == 0 || best_of_islands(run.archives(), 1).empty()) return 0;
  if (!is_verifiable(first)) {
    remarks() << "not verified: " << first.objectives.front().name
              << " is measured within the life, which verification does not repeat" << std::endl;
    return 0;
  }
  const std::string later =
      run.has_islands() ? resume_command_for(run) : shell_command({"verify", run.folder().string()});
  remarks() << "verifying the best " << first.verify << "; Ctrl-C stops this, and it can be done later by `" << later
            << "`" << std::endl;
  return static_cast<std::size_t>(first.verify);
}

/// Verifies the best of a run, and shows them on a page, as far as the user asks for it.
void verify_and_show(Run& run, const RunOutput& output) {
  const std::size_t count = begin_ending(run, output);
  const auto verified = timed("verifying the best individuals", [&] { return run.verify(count); });
  for (const VerifiedBest& best : verified) {
    if (best.island > 0) std::cout << "island " << best.island << ":\n";
    print(best.verifications, run.experiments().front().objectives.front());
  }
  if (!output.page) return;
  std::vector<ShownRun> shown;
  for (std::size_t i = 0; i < run.archives().size(); ++i) shown.push_back({run.experiments()[i], run.archives()[i]});
  show_runs(run.folder(), shown, run.simulator());
}

/// Prints the best individual of a run. Returns whether there is one.
bool print_best(const Run& run) {
  const std::vector<IslandIndividual> best = best_of_islands(run.archives(), 1);
  const std::size_t island = best.empty() ? 0 : best.front().island;
  return print_best(run.experiments()[island], run.archives()[island]);
}

}  // namespace

int evolve_and_report(Run& run, const RunOutput& output) {
  std::atomic<bool>& stop = stop_requested();
  stop_on_signals();
  end_long_calls_after(stop);
  remarks() << run.experiments().front().name << " on " << run.simulator().device() << ", " << places_text(run)
            << std::endl;
  const std::unique_ptr<ProgressDisplay> progress = progress_of(run, stop, output.ranks != nullptr);
  run.observe({.generation_done =
                   [&](std::int64_t island, const Summary& summary) {
                     progress->generation_done(island, summary);
                     if (output.log) output.log->add(summary, island);
                     if (output.limit) output.limit->generation_done(summary.wall_time, TimeLimit::Clock::now());
                     if (output.limit && output.limit->is_reached()) stop = true;
                   },
               .generation_progress = [&](double done) { progress->generation_progress(done); }});
  TimeSpent time;
  try {
    while (run.advance()) {
    }
    time = run.pause();
  } catch (const std::exception& error) {
    progress->finish();
    throw std::runtime_error(error.what() + remedy_for(error) + state_of(run));
  }
  progress->finish();
  const bool has_best = print_best(run);
  // islands verify at the same time, so their times say nothing about that of the run
  print_speed(static_cast<double>(progress->spring_evaluations()), progress->seconds(),
              run.has_islands() ? 0 : time.verify);
  if (!run.has_islands()) print_time_spent(time, run.simulator());
  print_shares(run.shares(), time.whole);
  // if time is up, a run is verified and shown although it is not finished
  const bool finished = run.is_finished();
  if (finished || (output.limit && output.limit->is_reached())) verify_and_show(run, output);
  if (finished) return has_best ? 0 : no_fitness;
  std::cout << "ended early; to continue: " << resume_command_for(run) << std::endl;
  return ended_early;
}

namespace {

/// Says that a run is complete, so that there is nothing to do, and returns the exit code.
int say_complete(const Run& run) {
  const std::string folder = run.folder().string();
  const Summary last = run.archives().front().generations().back();
  std::cout << folder << ": the run is complete";
  if (run.has_islands())
    std::cout << " on all islands; to look at it: " << shell_command({"show", folder});
  else
    std::cout << ": " << last.evaluations << " evaluations in " << last.generation + 1
              << " generations; to look at it: " << shell_command({"show", folder})
              << "; to go on from its population in another run: "
              << shell_command({"run", "EXPERIMENT.toml", "--set",
                                "experiment.start=" + fs::absolute(folder).lexically_normal().string()});
  std::cout << std::endl;
  return best_of_islands(run.archives(), 1).empty() ? no_fitness : 0;
}

/// Returns what the options say of the run in a folder.
RunSpec spec_of(const Given& given, const fs::path& folder, const Ranks& ranks) {
  RunSpec spec = given_spec(given, folder);
  spec.ranks = ranks.channel();
  spec.stop = &stop_requested();
  return spec;
}

RunOutput output_of(const Given& given, const Ranks& ranks, GenerationLog* log, TimeLimit* limit) {
  return {log, !given.contains("no-report"), limit, ranks.channel()};
}

/// Does what `evodevo run` does if the folder of the run holds no run yet.
int begin(const Ranks& ranks, const fs::path& file, std::vector<Experiment> experiments, const Given& given,
          TimeLimit* limit) {
  const fs::path folder = given.contains("out") ? given["out"].as<std::string>() : "";
  if (given.contains("out") && folder.empty())
    throw UsageError("--out: is empty; give a folder, or leave the option out");
  std::vector<fs::path> inputs{file};
  for (const auto& [name, content] : experiments.front().files) inputs.push_back(file.parent_path() / name);
  const std::unique_ptr<GenerationLog> log = given_log(given, experiments.front(), inputs);
  Run run = Run::begin(std::move(experiments), spec_of(given, folder, ranks), printed_events());
  remember_folders_of(run.experiments().front());
  return evolve_and_report(run, output_of(given, ranks, log.get(), limit));
}

/// Continues the run in a folder. `expected` has the experiment of the run, or those of its islands, if the user names
/// it; throws ArchiveError if the run is of another one.
int go_on(const Ranks& ranks, const fs::path& folder, const Given& given, TimeLimit* limit,
          const std::vector<Experiment>* expected = nullptr) {
  Run run = Run::open(spec_of(given, folder, ranks), printed_events(), expected);
  if (run.is_complete()) return say_complete(run);
  std::vector<fs::path> inputs;
  for (const fs::path& one : archive_folders(folder)) std::ranges::move(files_of_run(one), std::back_inserter(inputs));
  const std::unique_ptr<GenerationLog> log = given_log(given, run.experiments().front(), inputs);
  return evolve_and_report(run, output_of(given, ranks, log.get(), limit));
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
  std::vector<Experiment> experiments = given_islands(file, given);
  if (!is_to_go_on(given, experiments.size())) return begin(ranks, file, std::move(experiments), given, limit.get());
  remember_folders_of(experiments.front());
  return go_on(ranks, given["out"].as<std::string>(), given, limit.get(), &experiments);
}

/// Joins the ranks that a launcher has started, and calls `lead` on rank 0; the others work for it.
int with_ranks(const Given& given, const std::function<int(const Ranks&)>& lead) {
  end_on_signals();
  const Ranks ranks = Ranks::joined();
  if (ranks.leads()) return lead(ranks);
  // rank 0 decides when the run ends, so the first signal changes nothing here; a second one ends this rank
  stop_on_signals();
  Run::serve(
      *ranks.channel(), [&] { return given_spec(given, {}); }, printed_events());
  return 0;
}

int run(const Given& given) {
  return with_ranks(given, [&](const Ranks& ranks) { return make_run_of(ranks, given); });
}

int resume(const Given& given) {
  return with_ranks(given, [&](const Ranks& ranks) {
    return go_on(ranks, given["DIR"].as<std::string>(), given, given_limit(given).get());
  });
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
