#include "engine/run.hpp"

#include <algorithm>
#include <mutex>
#include <utility>

#include "archive/island_folders.hpp"
#include "archive/record_check.hpp"
#include "archive/recorded_experiment.hpp"
#include "cluster/post.hpp"
#include "cluster/ranks.hpp"
#include "engine/builds.hpp"
#include "evolution/first_robots.hpp"
#include "evolution/founders.hpp"
#include "evolution/islands/migration.hpp"
#include "evolution/resimulation.hpp"
#include "experiment/device.hpp"
#include "threads/parallel.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

void warn(const RunEvents& events, const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) events.warning(warning);
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

/// Opens an archive to continue its run, and reads its experiment. Throws ArchiveError if the run cannot be continued,
/// or if `expected` is given and is not its experiment.
std::pair<Archive, Experiment> reopened(const fs::path& folder, const RunSpec& spec, const RunEvents& events,
                                        const Experiment* expected) {
  Archive archive = Archive::resume(folder, spec.journal);
  std::optional<Experiment> experiment;
  events.step("reading the record of the run and loading its operators",
              [&] { experiment = recorded_experiment(archive, spec.plugin_path, spec.machine); });
  if (expected) check_same_experiment(archive, *experiment, *expected);
  experiment->gpus = spec.gpus;
  events.step("checking that the run can be continued", [&] { check_resumable(archive, *experiment); });
  return {std::move(archive), *std::move(experiment)};
}

/// Reads the message with which rank 0 calls the groups of ranks. If it cannot be read, says so to rank 0.
std::optional<message::Lead> read_lead(const std::string& bytes, Channel& ranks) {
  try {
    require_protocol(bytes);
    return message::unpacked<message::Lead>(bytes);
  } catch (const std::exception& error) {
    report_failure(error, ranks);
    return std::nullopt;
  }
}

}  // namespace

struct Run::State {
  RunSpec spec;
  Observer observer = {};
  std::vector<Experiment> experiments = {};
  std::vector<Archive> archives = {};  ///< while ranks evolve islands, those of this rank's group
  std::unique_ptr<Simulator> simulator = nullptr;
  std::vector<std::uint32_t> next = {};  ///< generation of each island, where other ranks lead some of them
  std::atomic<bool> never = false;
  std::mutex telling = {};  ///< of what the observer is told
  bool is_over = false;     ///< whether no generation can be made any more
  bool has_let_go = false;  ///< whether the other ranks have been told that there is no more work

  // while it evolves; the evaluators also in between, except those of groups
  std::unique_ptr<Exchange> between_islands = nullptr;  ///< in this process
  std::unique_ptr<Post> post = nullptr;                 ///< between groups of ranks
  std::vector<std::unique_ptr<Evaluator>> evaluators = {};
  std::vector<Migration> migrations = {};
  std::vector<Evolution> evolutions = {};
  Farm* farm = nullptr;  ///< the only evaluator, if ranks evaluate for one population

  explicit State(RunSpec given) : spec(std::move(given)) {}

  std::atomic<bool>& stop() { return spec.stop ? *spec.stop : never; }
  bool has_islands() const { return experiments.front().island > 0; }
  bool has_groups() const { return spec.ranks && has_islands(); }

  void open_archives(const RunEvents& events, const std::vector<std::int64_t>& islands,
                     const std::vector<Experiment>* expected);
  void open_simulator(const RunEvents& events);
  void warn_of_changes(const RunEvents& events) const;
  void make_evaluators(const RunEvents& events, bool is_record);
  void create_archives(const RunEvents& events);
  void begin_work();
  void call_groups();
  bool make_generation();
  void tell(std::int64_t island, const Summary& summary);
  TimeSpent end_work();
  std::optional<std::string> end_groups();
  void let_go();
  void lead_group();
};

/// Opens the archives of islands, or that of the only population.
void Run::State::open_archives(const RunEvents& events, const std::vector<std::int64_t>& islands,
                               const std::vector<Experiment>* expected) {
  for (std::size_t i = 0; i < std::max<std::size_t>(1, islands.size()); ++i) {
    const fs::path folder = islands.empty() ? spec.folder : island_folder(spec.folder, islands[i]);
    auto [archive, experiment] = reopened(folder, spec, events, expected ? &expected->at(i) : nullptr);
    if (islands.empty() && archive.island() > 0)
      throw ArchiveError(folder.string() +
                         ": is an island, which cannot be continued alone; give the folder of its run");
    if (!islands.empty() && archive.island() != islands[i])
      archive.refuse("it is island " + std::to_string(archive.island()) + " of a run; name its folder after that");
    archives.push_back(std::move(archive));
    experiments.push_back(std::move(experiment));
  }
}

void Run::State::open_simulator(const RunEvents& events) {
  Experiment& first = experiments.front();
  if (spec.ranks) share_host(first, *spec.ranks, spec.mixed);
  events.step("opening the simulator", [&] { simulator = make_simulator(first); });
}

void Run::State::warn_of_changes(const RunEvents& events) const {
  warn(events, another_device(*simulator, archives.front()));
  warn(events, other_builds(experiments.front(), *simulator, archives.front()));
}

/// `is_record`: see ExperimentSource.
void Run::State::make_evaluators(const RunEvents& events, bool is_record) {
  if (has_groups()) return;  // call_groups() does it
  if (!spec.ranks) {
    for (const Experiment& one : experiments) evaluators.push_back(std::make_unique<LocalEvaluator>(one, *simulator));
    return;
  }
  const Experiment& only = experiments.front();
  const message::Setup setup{.text = only.resolved, .name = only.name, .files = only.files, .is_record = is_record};
  events.step("waiting for the other ranks", [&] {
    auto made = std::make_unique<Farm>(only, *simulator, *spec.ranks, setup, FarmOptions{.mixed = spec.mixed});
    farm = made.get();
    evaluators.push_back(std::move(made));
  });
}

void Run::State::create_archives(const RunEvents& events) {
  if (!has_islands()) {
    archives.push_back(Archive::create(spec.folder, experiments.front(), simulator->device(), spec.journal));
    return;
  }
  // a process that was killed may have created some of the islands
  if (!is_half_created(spec.folder, static_cast<std::int64_t>(experiments.size()))) begin_run_folder(spec.folder);
  for (const Experiment& island : experiments) {
    const fs::path own = island_folder(spec.folder, island.island);
    if (!is_begun(own)) {
      archives.push_back(Archive::create(own, island, simulator->device(), spec.journal));
      continue;
    }
    auto [archive, recorded] = reopened(own, spec, events, &island);
    if (!spec.other_versions) refuse_other_versions(recorded, archive);
    archives.push_back(std::move(archive));
  }
}

Run::Run(std::unique_ptr<State> state) : state_(std::move(state)) {}
Run::Run(std::vector<Experiment> experiments, std::unique_ptr<Simulator> simulator, std::vector<Archive> archives,
         std::atomic<bool>* stop)
    : state_(std::make_unique<State>(RunSpec{.folder = archives.front().folder(), .stop = stop})) {
  state_->experiments = std::move(experiments);
  state_->simulator = std::move(simulator);
  state_->archives = std::move(archives);
  if (has_islands()) state_->spec.folder = folder().parent_path();
  state_->make_evaluators({}, true);
}
Run::Run(Run&&) noexcept = default;
Run::~Run() = default;

Run Run::begin(std::vector<Experiment> experiments, RunSpec spec, const RunEvents& events) {
  auto state = std::make_unique<State>(std::move(spec));
  state->experiments = std::move(experiments);
  const Experiment& first = state->experiments.front();
  founders(first);  // so that a wrong start is reported before anything is written
  warn(events, first.warnings);
  warn(events, first_robots(first).warnings);
  state->open_simulator(events);
  state->make_evaluators(events, false);
  if (state->spec.folder.empty()) state->spec.folder = new_run_folder(first.name);
  state->create_archives(events);
  return Run(std::move(state));
}

Run Run::open(RunSpec spec, const RunEvents& events, const std::vector<Experiment>* expected) {
  auto state = std::make_unique<State>(std::move(spec));
  const RunSpec& own = state->spec;
  const std::size_t count = island_folders(own.folder).size();
  if (expected && expected->size() != std::max<std::size_t>(1, count))
    throw ArchiveError(
        own.folder.string() + ": has " + (count == 0 ? "one population" : std::to_string(count) + " islands") +
        ", but the experiment asks for " + std::to_string(expected->size()) +
        (expected->size() == 1 ? " population" : " islands") + "; give the experiment of the run, or another --out");
  std::vector<std::int64_t> islands;
  for (std::size_t i = 1; i <= count; ++i) islands.push_back(static_cast<std::int64_t>(i));
  state->open_archives(events, islands, expected);
  Run run(std::move(state));
  if (run.is_complete()) return run;
  State& opened = *run.state_;
  if (!own.other_versions)
    for (std::size_t i = 0; i < opened.archives.size(); ++i)
      refuse_other_versions(opened.experiments[i], opened.archives[i]);
  opened.open_simulator(events);
  opened.warn_of_changes(events);
  opened.make_evaluators(events, true);
  return run;
}

const fs::path& Run::folder() const { return state_->spec.folder; }
const std::vector<Experiment>& Run::experiments() const { return state_->experiments; }
const std::vector<Archive>& Run::archives() const { return state_->archives; }
Simulator& Run::simulator() { return *state_->simulator; }
std::vector<Share> Run::shares() const { return state_->farm ? state_->farm->shares() : std::vector<Share>(); }

void Run::observe(Observer observer) {
  const std::lock_guard lock(state_->telling);
  state_->observer = std::move(observer);
}

bool Run::is_finished() const {
  const State& state = *state_;
  if (!state.evolutions.empty()) return std::ranges::all_of(state.evolutions, &Evolution::is_finished);
  if (state.archives.size() < state.experiments.size()) return false;  // a group of ranks has failed
  for (std::size_t i = 0; i < state.archives.size(); ++i)
    if (!evodevo::is_finished(state.experiments[i], state.archives[i].generations())) return false;
  return true;
}

bool Run::is_complete() const {
  const Experiment& first = experiments().front();
  if (!state_->evolutions.empty() || !is_finished()) return false;
  return !is_verifiable(first) ||
         std::ranges::all_of(
             best_of_islands(archives(), static_cast<std::size_t>(first.verify)),
             [&](const IslandIndividual& one) { return archives()[one.island].verification(one.id).has_value(); });
}

void Run::State::tell(std::int64_t island, const Summary& summary) {
  const std::lock_guard lock(telling);
  observer.generation_done(island, summary);
}

/// Prepares what the generations need that are made until end_work().
void Run::State::begin_work() {
  if (!evolutions.empty()) return;
  if (!has_islands()) {
    evolutions.emplace_back(experiments.front(), *evaluators.front(), archives.front());
    return;
  }
  if (next.empty()) next = next_generations(archives);  // unless rank 0 has said it
  if (has_groups())
    call_groups();
  else
    between_islands = std::make_unique<LocalExchange>();
  Exchange& exchange = post ? post->exchange() : *between_islands;
  for (const Experiment& island : experiments)
    if (migrations.size() < archives.size()) migrations.emplace_back(island, exchange);
  for (std::size_t i = 0; i < archives.size(); ++i) {
    migrations[i].repeat_departures(archives[i], next);
    evolutions.emplace_back(experiments[i], *evaluators[i], archives[i], &migrations[i]);
  }
}

/// On rank 0, lets the other ranks open the archives of their islands. Prepares the evaluators of this rank's group.
void Run::State::call_groups() {
  Channel& ranks = *spec.ranks;
  const Groups groups(ranks.size(), static_cast<std::int64_t>(next.size()));
  if (ranks.rank() == 0) {
    while (archives.size() > groups.islands(0).size()) archives.pop_back();
    const message::Lead lead{.folder = fs::absolute(spec.folder).string(), .next = next};
    for (int rank = 1; rank < ranks.size(); ++rank) ranks.send(rank, message::packed(lead));
  }
  post = std::make_unique<Post>(ranks, groups, stop(),
                                [this](std::int64_t island, const Summary& summary) { tell(island, summary); });
  for (std::size_t i = 0; i < archives.size(); ++i) {
    const Experiment& island = experiments[i];
    if (post->group().size() == 1) {
      evaluators.push_back(std::make_unique<LocalEvaluator>(island, *simulator));
      continue;
    }
    const message::Setup setup{.text = island.resolved, .name = island.name, .files = island.files, .is_record = true};
    evaluators.push_back(
        std::make_unique<Farm>(island, *simulator, post->group(), setup, FarmOptions{.mixed = spec.mixed}));
  }
}

/// Returns whether any was made.
bool Run::State::make_generation() {
  if (!has_islands()) return evolutions.front().advance(stop(), observer);
  std::uint32_t furthest_behind = ~0u;
  for (const Evolution& one : evolutions)
    if (!one.is_finished()) furthest_behind = std::min(furthest_behind, one.generation());
  std::vector<std::size_t> due;
  for (std::size_t i = 0; i < evolutions.size(); ++i)
    if (!evolutions[i].is_finished() && evolutions[i].generation() == furthest_behind) due.push_back(i);
  std::vector<std::optional<Summary>> made(due.size());
  std::exception_ptr failure;
  try {
    on_own_threads(due.size(), [&](std::size_t k) {
      Observer own;
      own.generation_done = [&](std::int64_t, const Summary& summary) { made[k] = summary; };
      try {
        evolutions[due[k]].advance(stop(), own);
      } catch (...) {
        (post ? post->exchange() : *between_islands).abandon();  // others may wait for its migrants
        throw;
      }
    });
  } catch (...) {
    failure = std::current_exception();
  }
  bool any = false;
  for (std::size_t k = 0; k < due.size(); ++k) {
    if (!made[k]) continue;
    any = true;
    try {
      tell(experiments[due[k]].island, *made[k]);
    } catch (...) {
      if (!failure) failure = std::current_exception();
    }
  }
  if (failure) std::rethrow_exception(failure);
  return any;
}

/// Waits until all generations have been committed, and returns the time that has been spent on them.
TimeSpent Run::State::end_work() {
  TimeSpent sum;
  std::exception_ptr failure;
  for (std::size_t i = 0; i < evolutions.size(); ++i) {
    try {
      const TimeSpent time = evolutions[i].pause();
      record_time_spent(archives[i], time);
      sum += time;
    } catch (...) {
      if (!failure) failure = std::current_exception();
    }
  }
  evolutions.clear();
  migrations.clear();
  between_islands.reset();
  next.clear();
  if (failure) std::rethrow_exception(failure);
  return sum;
}

/// On rank 0, waits until the other groups have ended, and opens the archives of all islands. Returns why that failed.
std::optional<std::string> Run::State::end_groups() {
  if (!post) return std::nullopt;
  std::optional<std::string> failure = post->others_done();
  evaluators.clear();
  post.reset();
  is_over = true;
  archives.clear();
  try {
    std::vector<Archive> all;
    for (const Experiment& island : experiments)
      all.push_back(Archive::annotate(island_folder(spec.folder, island.island)));
    archives = std::move(all);
  } catch (const std::exception& error) {
    if (!failure) failure = error.what();
  }
  return failure;
}

/// Tells the other ranks that there is no more work.
void Run::State::let_go() {
  if (!spec.ranks || std::exchange(has_let_go, true)) return;
  end_run(*spec.ranks);
  is_over = true;
}

bool Run::advance() {
  State& state = *state_;
  if (!state.simulator || state.is_over) return false;
  try {
    state.begin_work();
    return state.make_generation();
  } catch (...) {
    state.is_over = state.spec.ranks != nullptr;  // another rank may still be at work for the generation that failed
    if (state.post) state.stop() = true;
    try {
      pause();
    } catch (...) {  // a consequence of the first failure, which is the one to tell
    }
    throw;
  }
}

TimeSpent Run::pause() {
  State& state = *state_;
  TimeSpent time;
  std::exception_ptr failure;
  if (state.post && !is_finished()) state.stop() = true;  // other groups would wait for migrants
  try {
    time = state.end_work();
  } catch (...) {
    failure = std::current_exception();
    if (state.post) state.stop() = true;
  }
  const std::optional<std::string> of_groups = state.end_groups();
  if (failure) std::rethrow_exception(failure);
  if (of_groups) throw std::runtime_error(*of_groups);
  return time;
}

std::vector<VerifiedBest> Run::verify(std::size_t count) {
  pause();
  State& state = *state_;
  std::vector<VerifiedBest> verified;
  if (!state.simulator) return verified;
  state.let_go();
  std::vector<std::size_t> counts(state.archives.size());  // of an island, its own best come first among all
  for (const IslandIndividual& one : best_of_islands(state.archives, count)) ++counts[one.island];
  for (std::size_t i = 0; i < counts.size(); ++i)
    if (counts[i] > 0)
      verified.push_back({state.experiments[i].island,
                          verify_best(state.experiments[i], *state.simulator, state.archives[i], counts[i])});
  return verified;
}

std::vector<VerifiedBest> Run::finish() {
  pause();
  state_->let_go();
  const Experiment& first = experiments().front();
  return is_verifiable(first) ? verify(static_cast<std::size_t>(first.verify)) : std::vector<VerifiedBest>();
}

/// Evolves the islands of a group other than that of rank 0.
void Run::State::lead_group() {
  observer.generation_done = [this](std::int64_t island, const Summary& summary) {
    post->tell_generation(island, summary);
  };
  try {
    begin_work();
    while (make_generation()) {
    }
    end_work();
  } catch (const std::exception& error) {
    if (!post) throw;
    evolutions.clear();
    archives.clear();
    return post->fail(error);
  }
  archives.clear();  // rank 0 opens them
  post->done();
}

void Run::serve(Channel& ranks, const std::function<RunSpec()>& spec, const RunEvents& events) {
  const auto options = [&] {
    RunSpec given = spec();
    return RankOptions{std::move(given.plugin_path), std::move(given.gpus), std::move(given.machine), given.mixed};
  };
  const std::optional<std::string> first = first_message(ranks);
  if (!first) return;
  if (message::kind_of(*first) != message::Kind::lead) return evodevo::serve(ranks, *first, options);
  const std::optional<message::Lead> lead = read_lead(*first, ranks);
  if (!lead) return;
  const Groups groups(ranks.size(), static_cast<std::int64_t>(lead->next.size()));
  const int group = groups.of_rank(ranks.rank());
  if (groups.first_rank(group) != ranks.rank()) {
    GroupChannel of_group(ranks, groups.ranks(group));
    if (const std::optional<std::string> setup = first_message(of_group)) evodevo::serve(of_group, *setup, options);
    return;
  }
  std::atomic<bool> stop = false;
  std::optional<State> state;
  try {
    state.emplace(spec());
    state->spec.folder = lead->folder;
    state->spec.ranks = &ranks;
    state->spec.stop = &stop;
    state->next = lead->next;
    state->open_archives({.step = events.step}, groups.islands(group), nullptr);
    state->open_simulator(events);
    state->lead_group();
  } catch (const std::exception& error) {
    report_failure(error, ranks);
  }
}

std::vector<Verification> verify_best(const Experiment& experiment, Simulator& simulator, Archive& archive,
                                      std::size_t count) {
  std::vector<ArchivedIndividual> best;  // a champion refers to its genome
  for (const std::uint32_t id : archive.best(count)) best.push_back(archive.known_individual(id));
  std::vector<Champion> champions;
  for (const ArchivedIndividual& one : best)
    champions.push_back(
        {for_resimulation(archive, experiment, one, simulator.device()), one.result.objectives.front()});
  std::vector<Verification> verifications = evodevo::verify(experiment, simulator, champions);
  archive.add_verifications(verifications);
  return verifications;
}

}  // namespace evodevo
