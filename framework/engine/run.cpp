#include "engine/run.hpp"

#include "engine/builds.hpp"
#include "evolution/first_robots.hpp"
#include "evolution/founders.hpp"
#include "evolution/record_check.hpp"
#include "evolution/resimulation.hpp"
#include "experiment/device.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

void warn(const RunEvents& events, const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) events.warning(warning);
}

std::unique_ptr<Simulator> opened(const Experiment& experiment, const RunEvents& events) {
  std::unique_ptr<Simulator> simulator;
  events.step("opening the simulator", [&] { simulator = make_simulator(experiment); });
  return simulator;
}

}  // namespace

fs::path new_run_folder(const std::string& name) {
  std::error_code error;
  fs::create_directories("runs", error);
  for (int number = 1; !error; ++number) {
    fs::path folder = fs::path("runs") / (name + "-" + std::to_string(number));
    if (fs::create_directory(folder, error)) return folder;
  }
  throw ArchiveError("runs: no folder can be created in it: " + error.message() + "; give another place with --out");
}

std::unique_ptr<Simulator> opened_to_begin(Experiment& experiment, const RunSpec& spec, const RunEvents& events) {
  founders(experiment);  // so that a wrong start is reported before anything is written
  warn(events, experiment.warnings);
  warn(events, first_robots(experiment).warnings);
  spec.share(experiment);
  return opened(experiment, events);
}

std::pair<Archive, Experiment> reopened(const RunSpec& spec, const RunEvents& events, const Experiment* expected) {
  Archive archive = Archive::resume(spec.folder, spec.journal);
  std::optional<Experiment> experiment;
  events.step("reading the record of the run and loading its operators",
              [&] { experiment = recorded_experiment(archive, spec.plugin_path, spec.machine); });
  if (expected) check_same_experiment(archive, *experiment, *expected);
  experiment->gpus = spec.gpus;
  events.step("checking that the run can be continued", [&] { check_resumable(archive, *experiment); });
  return {std::move(archive), *std::move(experiment)};
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

Run Run::begin(Experiment experiment, const RunSpec& spec, const RunEvents& events) {
  auto own = std::make_unique<Experiment>(std::move(experiment));
  auto simulator = opened_to_begin(*own, spec, events);
  auto evaluator = spec.evaluator(*own, *simulator);
  const fs::path folder = spec.folder.empty() ? new_run_folder(own->name) : spec.folder;
  Archive archive = Archive::create(folder, *own, simulator->device(), spec.journal);
  return {std::move(own), std::move(simulator), std::move(evaluator), std::move(archive)};
}

Run Run::open(const RunSpec& spec, const RunEvents& events, const Experiment* expected) {
  auto [archive, experiment] = reopened(spec, events, expected);
  if (archive.island() > 0)
    throw ArchiveError(spec.folder.string() +
                       ": is an island, which cannot be continued alone; give the folder of its run");
  auto own = std::make_unique<Experiment>(std::move(experiment));
  if (evodevo::is_complete(archive, *own)) return {std::move(own), nullptr, nullptr, std::move(archive)};
  if (!spec.other_versions) refuse_other_versions(*own, archive);
  spec.share(*own);
  auto simulator = opened(*own, events);
  warn(events, another_device(*simulator, archive));
  warn(events, other_builds(*own, *simulator, archive));
  auto evaluator = spec.evaluator(*own, *simulator);
  return {std::move(own), std::move(simulator), std::move(evaluator), std::move(archive)};
}

Run::Run(std::unique_ptr<Experiment> experiment, std::unique_ptr<Simulator> simulator,
         std::unique_ptr<Evaluator> evaluator, Archive archive)
    : experiment_(std::move(experiment)),
      simulator_(std::move(simulator)),
      evaluator_(std::move(evaluator)),
      archive_(std::make_unique<Archive>(std::move(archive))) {}
Run::Run(Experiment experiment, std::unique_ptr<Simulator> simulator, Archive archive)
    : Run(std::make_unique<Experiment>(std::move(experiment)), std::move(simulator), nullptr, std::move(archive)) {
  evaluator_ = std::make_unique<LocalEvaluator>(*experiment_, *simulator_);
}
Run::Run(Run&&) noexcept = default;
Run::~Run() = default;

bool Run::is_finished() const {
  return evolution_ ? evolution_->is_finished() : evodevo::is_finished(*experiment_, archive_->generations());
}

bool Run::is_complete() const { return !evolution_ && evodevo::is_complete(*archive_, *experiment_); }

bool Run::advance(const std::atomic<bool>& stop, const Observer& observer) {
  if (!evaluator_) return false;  // opened, but complete
  if (!evolution_) evolution_ = std::make_unique<Evolution>(*experiment_, *evaluator_, *archive_);
  try {
    return evolution_->advance(stop, observer);
  } catch (...) {
    pause();  // another one goes on from the generations that are committed
    throw;
  }
}

TimeSpent Run::pause() {
  if (!evolution_) return {};
  const std::unique_ptr<Evolution> paused = std::move(evolution_);
  const TimeSpent time = paused->pause();
  record_time_spent(*archive_, time);
  return time;
}

std::vector<Verification> Run::verify(std::size_t count) {
  pause();
  return simulator_ ? verify_best(*experiment_, *simulator_, *archive_, count) : std::vector<Verification>();
}

std::vector<Verification> Run::finish() {
  pause();
  if (!is_verifiable(*experiment_)) return {};
  return verify(static_cast<std::size_t>(experiment_->verify));
}

}  // namespace evodevo
