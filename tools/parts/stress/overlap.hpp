// How soon it is known which springs are stressed.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/table.hpp"
#include "experiment/experiment.hpp"

namespace evodevo::tools::stress {

// as in the paper: those that go (section IV-D2), and those beside which springs may come
inline constexpr std::size_t least_sought = 125, most_sought = 100;

/// The stress of one robot's springs from birth on to each of some times, N.
using StressOverTime = std::vector<std::vector<double>>;

/// The shares of the truly least and most stressed springs, by `truth`, that `estimate` finds.
struct Found {
  double least, most;
};
Found found(const std::vector<double>& truth, const std::vector<double>& estimate);

/// Random robots in a scene.
struct Case {
  std::string scene;
  std::string experiment;      ///< file
  bool muscles_still = false;  ///< whether muscles keep their length
};

/// The experiments' own scenes, and that of the first with bodies that only settle.
std::vector<Case> cases(const std::vector<std::string>& experiments);

/// Cycle times, s; the last is that which the others are compared with.
std::vector<double> cycle_times();

/// The stress of `robots` random robots of a case, which have a muscle and enough springs, from birth on as their
/// experiment simulates them; of those alone that have not diverged.
std::vector<StressOverTime> simulate(const Case& one, std::size_t robots, const std::string& device);

/// The rows of a case: for each cycle time, the shares found by all its robots.
void add_rows(const Case& one, const std::vector<StressOverTime>& robots, Table& table);
Table overlap_table();

/// For each scene, what is sought and each of `shares`, the shortest cycle from which on at least that share is found,
/// s; none where only the last does.
Table shortest_cycles(const Table& overlap, std::span<const double> shares);

}  // namespace evodevo::tools::stress
