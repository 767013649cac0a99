// The common part of `run` and `resume` for runs with islands.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "commands/run/islands_progress.hpp"
#include "commands/run/run.hpp"

namespace evodevo {

/// The islands of a run, in the order of their numbers.
struct Islands {
  std::filesystem::path folder;  ///< of the run
  std::vector<Experiment> experiments;
  std::vector<Archive> archives;
};

/// Begins the archives of a run with islands in a folder, or those that are missing if it is half created. Throws
/// ArchiveError if begin_run_folder() does.
Islands created_islands(const std::filesystem::path& folder, std::vector<Experiment> experiments,
                        const std::string& device, const Given& given);

/// Opens the archives of a run with islands to continue it, like reopened(). `expected` has the experiments of its
/// islands if the user names them, and is otherwise null.
Islands reopened_islands(const std::filesystem::path& folder, const Given& given,
                         const std::vector<Experiment>* expected);

/// Prints the best robot of a run with islands and the speed. If the run is finished, verifies the best and writes the
/// page; otherwise says how to continue. Returns the exit code.
int report_outcome(Islands& islands, Simulator& simulator, const IslandsProgress& progress, const RunOutput& output);

/// Whether a run with islands has nothing left to do: neither evolution nor verification.
bool are_complete(const Islands& islands);

/// Returns the end of a message about a failure: which generations the islands have completed, and how to continue.
std::string state_of(const Islands& islands);

/// The progress of a run with islands from now on. Both arguments must outlive it.
std::unique_ptr<IslandsProgress> progress_of(const Islands& islands, const std::atomic<bool>& stop, bool is_live);

/// Returns an observer that tells a function of each generation of an island.
Observer observer_of(const Experiment& island, std::function<void(std::int64_t, const Summary&)> tell);

/// Does for a run with islands what evolve_and_report() does for one with a single population. If an island fails, the
/// others stop.
int evolve_and_report(Islands& islands, Simulator& simulator, const std::atomic<bool>& stop, const RunOutput& output);

}  // namespace evodevo
