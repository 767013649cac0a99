#include "commands/run/islands.hpp"

#include <algorithm>
#include <iostream>
#include <memory>

#include "base/text.hpp"
#include "commands/run/early_end.hpp"
#include "commands/run/islands_progress.hpp"
#include "commands/run/page.hpp"
#include "commands/run/progress.hpp"
#include "commands/run/run_options.hpp"
#include "commands/shell/output/notices.hpp"
#include "commands/shell/output/output_of_thread.hpp"
#include "commands/shell/verification_report.hpp"
#include "engine/builds.hpp"
#include "engine/run.hpp"
#include "evolution/islands/island_folders.hpp"
#include "evolution/islands/island_runs.hpp"
#include "experiment/device.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

bool are_finished(const Islands& islands) {
  for (std::size_t i = 0; i < islands.archives.size(); ++i)
    if (!is_finished(islands.experiments[i], islands.archives[i].generations())) return false;
  return true;
}

std::string resume_command_for(const fs::path& folder) { return shell_command({"resume", folder.string()}); }

void verify_best_of_all(Islands& islands, Simulator& simulator, std::size_t count) {
  std::vector<std::size_t> counts(islands.archives.size());  // of an island, its own best come first among all
  for (const IslandIndividual& one : best_of_islands(islands.archives, count)) ++counts[one.island];
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 0) continue;
    const Experiment& island = islands.experiments[i];
    const auto verifications = timed("verifying the best individuals of an island",
                                     [&] { return verify_best(island, simulator, islands.archives[i], counts[i]); });
    std::cout << "island " << island.island << ":\n";
    print(verifications, island.objectives.front());
  }
}

/// Prints the best of all islands. Returns whether there is one.
bool print_best(const Islands& islands) {
  const std::vector<IslandIndividual> best = best_of_islands(islands.archives, 1);
  const std::size_t island = best.empty() ? 0 : best.front().island;
  return print_best(islands.experiments[island], islands.archives[island]);
}

std::pair<Archive, Experiment> reopened_island(const fs::path& folder, const Given& given, const Experiment* expected) {
  const RunSpec spec = given_spec(given, folder);
  auto island = reopened(spec, printed_events(), expected);
  if (!spec.other_versions) refuse_other_versions(island.second, island.first);
  return island;
}

void finish(Islands& islands, Simulator& simulator, const RunOutput& output) {
  verify_best_of_all(islands, simulator,
                     begin_ending(islands.experiments.front(), output, !best_of_islands(islands.archives, 1).empty(),
                                  resume_command_for(islands.folder)));
  if (!output.page) return;
  std::vector<ShownRun> shown;
  for (std::size_t i = 0; i < islands.archives.size(); ++i)
    shown.push_back({islands.experiments[i], islands.archives[i]});
  show_runs(islands.folder, shown, simulator);
}

}  // namespace

Islands created_islands(const fs::path& folder, std::vector<Experiment> experiments, const std::string& device,
                        const Given& given) {
  if (!is_half_created(folder, static_cast<std::int64_t>(experiments.size()))) begin_run_folder(folder);
  Islands islands{folder, std::move(experiments), {}};
  for (const Experiment& island : islands.experiments) {
    const fs::path own = island_folder(folder, island.island);
    islands.archives.push_back(is_begun(own) ? reopened_island(own, given, &island).first
                                             : Archive::create(own, island, device, given_journal(given)));
  }
  return islands;
}

std::string state_of(const Islands& islands) {
  for (const Archive& archive : islands.archives)
    if (!archive.is_in_place()) return "";
  const std::vector<std::uint32_t> next = next_generations(islands.archives);
  const auto [least, most] = std::ranges::minmax(next);
  const std::string complete = least == 0 ? "an island has not completed any generation"
                               : least == most
                                   ? "the islands are complete up to generation " + std::to_string(least - 1)
                                   : "the islands are complete up to generations " + std::to_string(least - 1) +
                                         " to " + std::to_string(most - 1);
  return "\n" + complete + "; continue the run with `" + resume_command_for(islands.folder) + "`";
}

Islands reopened_islands(const fs::path& folder, const Given& given, const std::vector<Experiment>* expected) {
  Islands islands{folder, {}, {}};
  const std::vector<fs::path> folders = island_folders(folder);
  if (expected && expected->size() != folders.size())
    throw ArchiveError(folder.string() + ": has " + std::to_string(folders.size()) +
                       " islands, but the experiment asks for " + std::to_string(expected->size()) +
                       "; give the experiment of the run, or another --out");
  for (std::size_t i = 0; i < folders.size(); ++i) {
    auto [archive, experiment] = reopened_island(folders[i], given, expected ? &(*expected)[i] : nullptr);
    if (archive.island() != static_cast<std::int64_t>(i) + 1)
      archive.refuse("it is island " + std::to_string(archive.island()) + " of a run; name its folder after that");
    islands.archives.push_back(std::move(archive));
    islands.experiments.push_back(std::move(experiment));
  }
  return islands;
}

bool are_complete(const Islands& islands) {
  const Experiment& first = islands.experiments.front();
  if (!are_finished(islands)) return false;
  return !is_verifiable(first) ||
         std::ranges::all_of(best_of_islands(islands.archives, static_cast<std::size_t>(first.verify)),
                             [&](const IslandIndividual& one) {
                               return islands.archives[one.island].verification(one.id).has_value();
                             });
}

std::unique_ptr<IslandsProgress> progress_of(const Islands& islands, const std::atomic<bool>& stop, bool is_live) {
  std::int64_t evaluations = 0;
  std::vector<std::vector<Summary>> past;
  for (const Experiment& island : islands.experiments) evaluations += island.evaluations;
  for (const Archive& archive : islands.archives) past.push_back(archive.generations());
  return std::make_unique<IslandsProgress>(islands.experiments.front(), evaluations, past, stop, is_live);
}

Observer observer_of(const Experiment& island, std::function<void(std::int64_t, const Summary&)> tell) {
  Observer observer;
  observer.generation_done = [tell = std::move(tell), number = island.island](const Summary& summary) {
    tell(number, summary);
  };
  return observer;
}

int report_outcome(Islands& islands, Simulator& simulator, const IslandsProgress& progress, const RunOutput& output) {
  const bool has_best = print_best(islands);
  print_speed(static_cast<double>(progress.spring_evaluations()), progress.seconds());
  const bool finished = are_finished(islands);
  if (finished || output.ends_by_clock()) finish(islands, simulator, output);
  if (finished) return has_best ? 0 : no_fitness;
  std::cout << "ended early; to continue: " << resume_command_for(islands.folder) << std::endl;
  return ended_early;
}

int evolve_and_report(Islands& islands, Simulator& simulator, const std::atomic<bool>& stop, const RunOutput& output) {
  const bool is_live = prints_on_terminal() && verbosity() != Verbosity::quiet;
  const auto progress = progress_of(islands, stop, is_live);
  const auto tell = [&, target = OutputOfThread::target()](std::int64_t island, const Summary& summary) {
    const OutputOfThread to(target);  // this is the thread of an island, but its lines are the run's
    progress->generation_done(island, summary);
    output.generation_done(summary, island);
  };
  std::vector<std::unique_ptr<LocalEvaluator>> evaluators;
  std::vector<IslandRun> runs;
  for (std::size_t i = 0; i < islands.archives.size(); ++i) {
    const Experiment& island = islands.experiments[i];
    evaluators.push_back(std::make_unique<LocalEvaluator>(island, simulator));
    runs.push_back({island, islands.archives[i], *evaluators.back(), observer_of(island, tell)});
  }
  LocalExchange exchange;
  try {
    const std::vector<TimeSpent> times = evolve(runs, exchange, next_generations(islands.archives), stop);
    for (std::size_t i = 0; i < times.size(); ++i) record_time_spent(islands.archives[i], times[i]);
  } catch (const std::exception& error) {
    progress->finish();
    throw std::runtime_error(error.what() + remedy_for(error) + state_of(islands));
  }
  progress->finish();
  return report_outcome(islands, simulator, *progress, output);
}

}  // namespace evodevo
