#include "commands/run/island_ranks.hpp"

#include <unistd.h>

#include <memory>
#include <optional>

#include "base/input_error.hpp"
#include "cluster/post.hpp"
#include "cluster/ranks.hpp"
#include "commands/run/run_options.hpp"
#include "commands/shell/options.hpp"
#include "evolution/islands/island_folders.hpp"
#include "evolution/islands/island_runs.hpp"
#include "experiment/device.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;
using OnGeneration = Post::OnGeneration;

/// The islands of one group, which evolve in this process.
struct Here {
  std::vector<const Experiment*> experiments;
  std::vector<Archive*> archives;
};

/// Evolves the islands of this rank's group, with all of its ranks.
void evolve_group(const Here& here, Simulator& simulator, Post& post, const std::vector<std::uint32_t>& next,
                  const std::atomic<bool>& stop, bool mixed, const OnGeneration& tell) {
  std::vector<std::unique_ptr<Evaluator>> evaluators;
  std::vector<IslandRun> runs;
  for (std::size_t i = 0; i < here.archives.size(); ++i) {
    const Experiment& island = *here.experiments[i];
    if (post.group().size() > 1) {  // then the group has one island
      const message::Setup setup{
          .text = island.resolved, .name = island.name, .files = island.files, .is_record = true};
      evaluators.push_back(std::make_unique<Farm>(island, simulator, post.group(), setup, FarmOptions{.mixed = mixed}));
    } else {
      evaluators.push_back(std::make_unique<LocalEvaluator>(island, simulator));
    }
    runs.push_back({island, *here.archives[i], *evaluators.back(), observer_of(island, tell)});
  }
  const std::vector<TimeSpent> times = evolve(runs, post.exchange(), next, stop);
  for (std::size_t i = 0; i < times.size(); ++i) record_time_spent(*here.archives[i], times[i]);
}

std::string host_name() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "unknown host";
}

/// Leads a group other than that of rank 0.
void lead(Channel& channel, const message::Lead& lead, const Groups& groups, const Given& given) {
  std::vector<Archive> archives;
  std::vector<Experiment> experiments;
  std::unique_ptr<Simulator> simulator;
  const bool mixed = given.contains("mixed");
  try {
    for (const std::int64_t island : groups.islands(groups.of_rank(channel.rank()))) {
      auto [archive, experiment] = reopened(given_spec(given, island_folder(lead.folder, island)), printed_events());
      archives.push_back(std::move(archive));
      experiments.push_back(std::move(experiment));
    }
    share_host(experiments.front(), channel, mixed);
    simulator = make_simulator(experiments.front());
  } catch (const std::exception& error) {
    return report_failure(error, channel);
  }
  Here here;
  for (std::size_t i = 0; i < archives.size(); ++i) {
    here.experiments.push_back(&experiments[i]);
    here.archives.push_back(&archives[i]);
  }
  std::atomic<bool> stop = false;
  Post post(channel, groups, stop, [](std::int64_t, const Summary&) {});
  try {
    evolve_group(here, *simulator, post, lead.next, stop, mixed,
                 [&](std::int64_t island, const Summary& summary) { post.tell_generation(island, summary); });
  } catch (const std::exception& error) {
    archives.clear();
    return post.fail(host_name(), error);
  }
  archives.clear();  // rank 0 opens them
  post.done();
}

}  // namespace

int evolve_and_report(Islands& islands, Simulator& simulator, Channel& channel, const Given& given,
                      std::atomic<bool>& stop, const RunOutput& output) {
  const Groups groups(channel.size(), static_cast<std::int64_t>(islands.experiments.size()));
  const auto progress = progress_of(islands, stop, false);  // a launcher lets each output look like a terminal
  const message::Lead lead{.folder = fs::absolute(islands.folder).string(), .next = next_generations(islands.archives)};
  const std::size_t own = groups.islands(0).size();  // the first islands belong to the group of rank 0
  while (islands.archives.size() > own) islands.archives.pop_back();
  for (int rank = 1; rank < channel.size(); ++rank) channel.send(rank, message::packed(lead));
  Here here;
  for (std::size_t i = 0; i < own; ++i) {
    here.experiments.push_back(&islands.experiments[i]);
    here.archives.push_back(&islands.archives[i]);
  }
  const auto tell = [&](std::int64_t island, const Summary& summary) {
    progress->generation_done(island, summary);
    output.generation_done(summary, island);
  };
  std::optional<std::string> failure;
  {
    Post post(channel, groups, stop, tell);
    try {
      evolve_group(here, simulator, post, lead.next, stop, given.contains("mixed"), tell);
    } catch (const std::exception& error) {
      failure = error.what() + remedy_for(error);
      stop = true;
    }
    const std::optional<std::string> of_others = post.others_done();
    if (!failure) failure = of_others;
  }
  progress->finish();
  islands.archives.clear();
  for (const Experiment& island : islands.experiments)
    islands.archives.push_back(Archive::annotate(island_folder(islands.folder, island.island)));
  if (failure) throw std::runtime_error(*failure + state_of(islands));
  end_run(channel);
  return report_outcome(islands, simulator, *progress, output);
}

void serve_islands(Channel& channel, const std::string& bytes, const Given& given,
                   const std::function<RankOptions()>& options) {
  if (const std::string protocol = message::protocol_of(bytes); protocol != message::protocol())
    return report_failure(InputError("speaks protocol " + message::protocol() + ", but rank 0 speaks protocol " +
                                     protocol + "; give all ranks evodevo programs of the same version"),
                          channel);
  const auto first = message::unpacked<message::Lead>(bytes);
  const Groups groups(channel.size(), static_cast<std::int64_t>(first.next.size()));
  const int group = groups.of_rank(channel.rank());
  if (groups.first_rank(group) == channel.rank()) return lead(channel, first, groups, given);
  GroupChannel of_group(channel, groups.ranks(group));
  if (const std::optional<std::string> setup = first_message(of_group)) serve(of_group, *setup, options);
}

}  // namespace evodevo
