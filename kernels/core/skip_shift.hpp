// The paper's estimate of stress, Skip-Shift (section IV-D1).
#pragma once

#include <cstdint>
#include <span>

#include "core/simulator.hpp"
#include "evodevo/rng.hpp"

namespace evodevo {

/// Groups that the springs of a body are dealt out to, as many as the paper's blocks have threads. Bodies of fewer
/// than 512 springs have half as many groups as springs: the one spring of a group of one would gain a point and lose
/// it.
inline constexpr std::size_t most_tally_groups = 256;

/// Moves every task's body and, after each `skip` steps, tallies its springs: they are dealt out to the groups in a new
/// random order, and each group's spring of largest absolute force gains one point, that of least force loses one;
/// among equals chance decides. The points are the task's `stress`, so that the springs with the fewest and the most
/// are the least and the most stressed. A task of fewer than `skip` steps has no tally and ends as invalid before the
/// first. `random` has a stream for each task, which is all that the order depends on.
///
/// The steps between two tallies are a run of the simulator each, and the tally is made on the host, the same for every
/// device. So this costs more than the exact stress, instead of which it repeats the paper.
void run_with_tallies(Simulator& simulator, std::span<Task> tasks, std::uint64_t skip, std::span<Rng> random);

/// The points of one tally, added to those of before: one for each spring, in the body's order.
void tally(const Body& body, const State& state, Rng& random, std::vector<double>& points);

}  // namespace evodevo
