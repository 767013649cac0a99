// Runs with something to see on the way.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "core/simulator.hpp"

namespace evodevo {

/// Moves every task's body through its steps in several runs, which end in the bits of one. `next_steps(i)` is how many
/// steps the i-th task's next run has, at least 1; the last run has what is left. `look(i, piece)` sees the answer to
/// each of them, in which `recording` was recorded, after tasks[i] has taken all of it but records and work; it is
/// called for one run of a task at a time, on the simulator's workers. A body is checked when it would be in one run,
/// so what `look` sees of one that diverges may not be finite. The tasks' own records and work are left alone.
void run_in_pieces(Simulator& simulator, std::span<Task> tasks, Recording recording,
                   const std::function<std::uint64_t(std::size_t)>& next_steps,
                   const std::function<void(std::size_t, const Task&)>& look);

}  // namespace evodevo
