// How long a body must be simulated until its least and most stressed springs are known.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/table.hpp"
#include "experiment/experiment.hpp"

namespace evodevo::tools::stress {

// Numbers of springs sought, as in the paper: the least stressed springs, which are removed (section IV-D2), and the
// most stressed ones, next to which springs may be added.
inline constexpr std::size_t least_sought = 125, most_sought = 100;

/// The stress of one robot's springs, that is their mean |force| from birth to each of several times, N.
using StressOverTime = std::vector<std::vector<double>>;

/// The shares of the truly least and the truly most stressed springs that an estimate finds.
struct Found {
  double least, most;
};
Found found(const std::vector<double>& truth, const std::vector<double>& estimate);

/// A set of random robots in a scene.
struct Case {
  std::string scene;
  std::string experiment;      ///< experiment file
  bool muscles_still = false;  ///< whether muscles keep their length
};

/// Returns a case for each experiment, and another one for the first experiment, in which muscles keep their length and
/// bodies only settle.
std::vector<Case> cases(const std::vector<std::string>& experiments);

/// Returns the cycle times, s. All others are compared with the last one.
std::vector<double> cycle_times();

/// Reads the experiment of a case.
Experiment experiment_of(const Case& one, const std::string& device);

/// Simulates `robots` random robots of a case from birth on, with the time stepping of the experiment. All of them have
/// a muscle and enough springs. Returns the stress of those that have not diverged.
std::vector<StressOverTime> simulate(const Case& one, std::size_t robots, const std::string& device);

/// Adds the rows of a case to the table: for each cycle time, statistics of the shares found over the robots of the
/// case.
void add_rows(const Case& one, const std::vector<StressOverTime>& robots, Table& table);
Table overlap_table();

/// Returns a table of the shortest sufficient cycle time, s, for each scene, kind of springs and share in `shares`. A
/// cycle time is sufficient if it and all longer ones find at least that share; the cell is empty if only the longest
/// one does.
Table shortest_cycles(const Table& overlap, std::span<const double> shares);

}  // namespace evodevo::tools::stress
