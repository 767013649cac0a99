// A run: begun in a folder or opened from it, advanced generation by generation, and finished.
//
//   Experiments, RunSpec ─► begin ─┐
//                                  ├─► advance ─► advance ─► … ─► pause ─► finish
//                RunSpec ─► open ──┘
//
//   Run run = Run::begin(read_islands({"experiments/quickstart.toml"}), {.folder = "runs/quickstart"});
//   while (run.advance()) {
//   }
//   run.finish();
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cluster/farm.hpp"
#include "evolution/evolution.hpp"

namespace evodevo {

/// What a run needs besides its experiment.
struct RunSpec {
  std::filesystem::path folder = {};                    ///< of the run; empty: begin() makes runs/NAME-N
  std::optional<Journal> journal = std::nullopt;        ///< of SQLite; nullopt: what the file system can do
  std::vector<std::filesystem::path> plugin_path = {};  ///< where a run is gone on with: more places for operators
  std::vector<Override> machine = {};                   ///< likewise: values of keys of [simulation]
  std::vector<int> gpus = {};                           ///< likewise: Experiment::gpus
  bool other_versions = false;                          ///< likewise: whether operators may have other versions
  /// The processes that work on the run, of which this is rank 0; null: this one alone. Whoever owns the channel ends
  /// the run for the others, as Ranks does, if a failure comes before finish().
  Channel* ranks = nullptr;
  bool mixed = false;  ///< whether ranks may differ in their devices and builds
  /// If another thread or a signal handler sets it, the run ends after the generation under way. If ranks evolve
  /// islands, a failure sets it, too, and so does pause() before the islands of this rank are finished.
  std::atomic<bool>* stop = nullptr;
};

/// What a run tells while it begins or opens.
struct RunEvents {
  std::function<void(const std::string&)> warning = [](const std::string&) {};
  /// Does a step that may take long, such as opening a GPU, so that a client can tell of it and time it.
  std::function<void(const std::string& what, const std::function<void()>& work)> step =
      [](const std::string&, const std::function<void()>& work) { work(); };
};

/// The verifications of a population, best first.
struct VerifiedBest {
  std::int64_t island = 0;  ///< 0: the run has no islands
  std::vector<Verification> verifications;
};

/// A run with one population or with islands, of this process alone or of several ranks. Whoever holds it decides when
/// it goes on and when it ends; nothing of it is global to the process, so that a process can hold many. One thread at
/// a time may use it.
class Run {
 public:
  /// Begins a run with the experiments of its islands, or with its only one. Throws ConfigError or ArchiveError, before
  /// anything is written, if the experiment's start, its device or the folder cannot be used.
  static Run begin(std::vector<Experiment> experiments, RunSpec spec, const RunEvents& events = {});
  /// Opens a run to go on with it. Throws ArchiveError if it cannot be continued, or if `expected` is given and does
  /// not have its experiments. If it is complete, no device is opened, there is no simulator(), and the other functions
  /// do nothing.
  static Run open(RunSpec spec, const RunEvents& events = {}, const std::vector<Experiment>* expected = nullptr);
  /// Makes a run of its parts: of the experiments of its islands and their archives, or of the only ones. `stop` is
  /// RunSpec::stop.
  Run(std::vector<Experiment> experiments, std::unique_ptr<Simulator> simulator, std::vector<Archive> archives,
      std::atomic<bool>* stop = nullptr);
  Run(Run&&) noexcept;
  ~Run();

  const std::filesystem::path& folder() const;
  /// Of the islands in the order of their numbers, or the only one.
  const std::vector<Experiment>& experiments() const;
  /// Of the islands in the order of their numbers, or the only one. May be used before the first advance() and after
  /// pause(); empty if that could not open all of them.
  const std::vector<Archive>& archives() const;
  bool has_islands() const { return experiments().front().island > 0; }
  Simulator& simulator();
  /// What each rank has contributed; empty for one process, and for islands.
  std::vector<Share> shares() const;

  /// Lets the run call these functions from now on. It never calls two at once, but, if ranks evolve islands, also on a
  /// thread of its own until pause(). Of islands, it tells only what they have completed. Not to be called from within
  /// these functions.
  void observe(Observer observer);

  /// Whether the run has used up what the experiment allows; between advance() and pause(), as far as this rank knows.
  bool is_finished() const;
  /// Whether there is nothing left to do: neither evolution nor verification; false between advance() and pause().
  bool is_complete() const;
  /// Makes the next generation, and commits it or begins to. Islands make theirs at the same time; those that are ahead
  /// wait for the others. Returns false if the run, or the part of this rank, is finished or RunSpec::stop is set; a
  /// generation that has begun is completed. Throws what the device or an operator throws; then the run is as after the
  /// last generation that was committed, from which the next call goes on, unless it has ranks: then no call advances
  /// it any more.
  bool advance();
  /// Waits until all generations have been committed, and adds the time of this process to the run's record. Returns
  /// that time, summed over islands. If ranks evolve islands, waits until those of other ranks are finished or,
  /// if those of this rank are not, ends their work after the generations under way; throws std::runtime_error if one
  /// has failed; in all cases, no call advances the run any more.
  TimeSpent pause();
  /// pause(), lets the other ranks go, and verifies the best `count` individuals, and stores the results.
  std::vector<VerifiedBest> verify(std::size_t count);
  /// The same for as many of the best as the experiment asks for, if its first objective can be verified.
  std::vector<VerifiedBest> finish();

  /// Lets this process, which is not rank 0, work for a run of rank 0 until that ends it. `spec` says what this process
  /// was told of the run (machine, gpus, plugin_path, mixed …); what it throws is told to rank 0.
  static void serve(Channel& ranks, const std::function<RunSpec()>& spec, const RunEvents& events = {});

 private:
  struct State;
  explicit Run(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Verifies the `count` best individuals of a population, and stores and returns the results.
std::vector<Verification> verify_best(const Experiment& experiment, Simulator& simulator, Archive& archive,
                                      std::size_t count);

}  // namespace evodevo
