// Runs that are divided into pieces, so that bodies can be observed between pieces.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "core/simulator.hpp"

namespace evodevo {

/// Simulates the steps of every task in several pieces. The final state is bit-identical to that of an undivided run.
///
///   next_steps(i) ─► number of steps of task i's next piece, at least 1 (the last piece has the remaining steps)
///   simulator.run(pieces) ─► one result per piece, with the quantities that `recording` requests
///   look(i, piece) ◄─ the result, after its state, status and course have been stored in tasks[i]
///
/// `look` is called on the simulator's workers, never concurrently for the same task. Bodies are checked for divergence
/// at the same steps as in one run, so `look` may see positions that are not finite if a body is diverging. The samples
/// that `tasks` ask for are taken; the records and the work in `tasks` are not changed.
void run_in_pieces(Simulator& simulator, std::span<Task> tasks, Recording recording,
                   const std::function<std::uint64_t(std::size_t)>& next_steps,
                   const std::function<void(std::size_t, const Task&)>& look);

}  // namespace evodevo
