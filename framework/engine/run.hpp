// A run: begun in a folder or opened from it, advanced generation by generation, and finished.
//
//   Experiment, RunSpec ─► begin ─┐
//                                 ├─► advance ─► advance ─► … ─► pause ─► finish
//                RunSpec ─► open ─┘
//
//   std::atomic<bool> stop = false;  // set on another thread, it ends the run after the generation under way
//   Run run = Run::begin(read_experiment({"experiments/quickstart.toml"}), {.folder = "runs/quickstart"});
//   while (run.advance(stop)) {
//   }
//   run.finish();
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "evolution/evolution.hpp"

namespace evodevo {

/// What a run needs besides its experiment.
struct RunSpec {
  std::filesystem::path folder = {};                    ///< of the run; empty: begin() makes runs/NAME-N
  std::optional<Journal> journal = std::nullopt;        ///< of SQLite; nullopt: what the file system can do
  std::vector<std::filesystem::path> plugin_path = {};  ///< of open(): more places to search for operators
  std::vector<Override> machine = {};                   ///< of open(): values of keys of [simulation], such as threads
  std::vector<int> gpus = {};                           ///< of open(): Experiment::gpus
  bool other_versions = false;                          ///< of open(): whether operators may have other versions
  /// Takes a share of the threads and GPUs of this host, if other processes work on the run.
  std::function<void(Experiment&)> share = [](Experiment&) {};
  /// Makes what evaluates the individuals; by default, this process does it alone.
  std::function<std::unique_ptr<Evaluator>(const Experiment&, Simulator&)> evaluator =
      [](const Experiment& experiment, Simulator& simulator) -> std::unique_ptr<Evaluator> {
    return std::make_unique<LocalEvaluator>(experiment, simulator);
  };
};

/// What a run tells while it begins or opens.
struct RunEvents {
  std::function<void(const std::string&)> warning = [](const std::string&) {};
  /// Does a step that may take long, such as opening a GPU, so that a client can tell of it and time it.
  std::function<void(const std::string& what, const std::function<void()>& work)> step =
      [](const std::string&, const std::function<void()>& work) { work(); };
};

/// A run with one population. Whoever holds it decides when it goes on and when it ends; nothing of it is global to the
/// process, so that a process can hold many. One thread at a time may use it.
class Run {
 public:
  /// Begins a run. Throws ConfigError or ArchiveError, before anything is written, if the experiment's start, its
  /// device or the folder cannot be used.
  static Run begin(Experiment experiment, const RunSpec& spec, const RunEvents& events = {});
  /// Opens a run to go on with it. Throws ArchiveError if it cannot be continued, or if `expected` is given and is not
  /// its experiment. If it is complete, no device is opened, there is no simulator(), and
  /// the other functions do nothing.
  static Run open(const RunSpec& spec, const RunEvents& events = {}, const Experiment* expected = nullptr);
  /// Makes a run of its parts.
  Run(Experiment experiment, std::unique_ptr<Simulator> simulator, Archive archive);
  Run(Run&&) noexcept;
  ~Run();

  const Experiment& experiment() const { return *experiment_; }
  Simulator& simulator() { return *simulator_; }
  /// May be used before the first advance() and after pause().
  Archive& archive() { return *archive_; }

  /// Whether the run has used up what the experiment allows.
  bool is_finished() const;
  /// Whether there is nothing left to do: neither evolution nor verification; false between advance() and pause().
  bool is_complete() const;
  /// Makes the next generation, and commits it or begins to. Returns false if the run is finished or `stop` is set; a
  /// generation that has begun is completed. Throws what the device or an operator throws; then the run is as after the
  /// last generation that was committed, from which the next call goes on.
  bool advance(const std::atomic<bool>& stop, const Observer& observer = {});
  /// Waits until all generations have been committed, and adds the time of this process to the run's record. Returns
  /// that time.
  TimeSpent pause();
  /// pause(), and verifies the best `count` individuals, and stores the results.
  std::vector<Verification> verify(std::size_t count);
  /// pause(), and verifies as many of the best as the experiment asks for, if its first objective can be verified.
  std::vector<Verification> finish();

 private:
  Run(std::unique_ptr<Experiment> experiment, std::unique_ptr<Simulator> simulator,
      std::unique_ptr<Evaluator> evaluator, Archive archive);

  std::unique_ptr<Experiment> experiment_;
  std::unique_ptr<Simulator> simulator_;
  std::unique_ptr<Evaluator> evaluator_;
  std::unique_ptr<Archive> archive_;
  std::unique_ptr<Evolution> evolution_;  ///< from the first advance() to pause()
};

/// Creates and returns the folder runs/NAME-N, where N is the first number from 1 for which there is no folder yet.
std::filesystem::path new_run_folder(const std::string& name);

/// Opens the simulator with which a run begins, after telling the warnings of its experiment. Throws ConfigError or
/// ArchiveError if the experiment's start or its device cannot be used.
std::unique_ptr<Simulator> opened_to_begin(Experiment& experiment, const RunSpec& spec, const RunEvents& events);

/// Opens an archive to continue its run, and reads its experiment. Throws ArchiveError if the run cannot be continued,
/// or if `expected` is given and is not its experiment.
std::pair<Archive, Experiment> reopened(const RunSpec& spec, const RunEvents& events,
                                        const Experiment* expected = nullptr);

/// Verifies the `count` best individuals of a run, and stores and returns the results.
std::vector<Verification> verify_best(const Experiment& experiment, Simulator& simulator, Archive& archive,
                                      std::size_t count);

}  // namespace evodevo
