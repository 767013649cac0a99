// Runs that are interrupted to observe the bodies on the way.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "core/simulator.hpp"

namespace evodevo {

/// Moves every task's body through its steps in several pieces. The end is the same, to the bit, as that of one run.
///
///   next_steps(i) ─► steps of task i's next piece, at least 1 (the last piece has the steps that are left)
///   simulator.run(pieces) ─► one answer per piece, with what `recording` asks for
///   look(i, piece) ◄─ the answer, after tasks[i] has taken its state, status and course
///
/// `look` is called on the simulator's workers, never twice at once for the same task. Bodies are checked for
/// divergence at the same steps as in one run, so positions that `look` sees of a diverging body may not be finite. The
/// tasks' own records and work stay as they are.
void run_in_pieces(Simulator& simulator, std::span<Task> tasks, Recording recording,
                   const std::function<std::uint64_t(std::size_t)>& next_steps,
                   const std::function<void(std::size_t, const Task&)>& look);

}  // namespace evodevo
