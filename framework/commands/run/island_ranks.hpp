// The work of the ranks of a run with islands.
#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "cluster/worker.hpp"
#include "commands/run/islands.hpp"

namespace evodevo {

/// Does on rank 0 for a run with islands what evolve_and_report() does in one process: tells the other ranks to begin,
/// and evolves the islands of its own group.
int evolve_and_report(Islands& islands, Simulator& simulator, Channel& channel, const Given& given,
                      std::atomic<bool>& stop, const RunOutput& output);

/// Does the work of another rank, given the Lead that it has got: leads its group if it is the first one of it, or else
/// evaluates for the group. `options` are those of serve().
void serve_islands(Channel& channel, const std::string& lead, const Given& given,
                   const std::function<RankOptions()>& options);

}  // namespace evodevo
