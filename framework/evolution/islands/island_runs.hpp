// Lets islands evolve at the same time.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <vector>

#include "evolution/evolution.hpp"
#include "evolution/islands/exchange.hpp"

namespace evodevo {

/// An island that evolves in this process.
struct IslandRun {
  const Experiment& experiment;
  Archive& archive;
  Evaluator& evaluator;
  Observer observer;  ///< called on the thread of the island
};

/// Continues the runs of islands until all are finished, each on a thread of its own, or on the calling thread if there
/// is only one. `next` has the next generation of each island of the whole run. If `stop` is set in the meantime, they
/// end as evolve() does. If one fails, the others stop, and its exception is thrown. Returns the times of the islands.
std::vector<TimeSpent> evolve(std::vector<IslandRun>& islands, Exchange& exchange,
                              const std::vector<std::uint32_t>& next, const std::atomic<bool>& stop);

}  // namespace evodevo
