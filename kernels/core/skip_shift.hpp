// The paper's estimate of stress, Skip-Shift (section IV-D1). Stress is the mean absolute force of a spring over a
// cycle, in N; the estimate only ranks springs by it.
#pragma once

#include <cstdint>
#include <span>

#include "core/simulator.hpp"
#include "evodevo/rng.hpp"

namespace evodevo {

/// The number of groups into which a body's springs are divided: as many as the paper's blocks have threads. Bodies of
/// fewer than 512 springs have half as many groups as springs, because the only spring of a group would gain a point
/// and lose it again.
inline constexpr std::size_t most_tally_groups = 256;

/// Moves every task's body and tallies its springs after every `skip` steps. A tally divides the springs among the
/// groups in a new random order; in each group the spring of largest absolute force gains one point and the spring of
/// smallest absolute force loses one; ties are decided at random. The points become the task's `stress`: the springs
/// with the most points are the most stressed. A task of fewer than `skip` steps would have no tally; it ends as
/// invalid before its first step. `random` has one stream per task; the orders depend on nothing else.
///
/// The simulator moves the bodies from one tally to the next, and the host makes the tallies, the same way for every
/// device. That costs more than recording the exact stress; this function is here to repeat the paper.
void run_with_tallies(Simulator& simulator, std::span<Task> tasks, std::uint64_t skip, std::span<Rng> random);

/// Makes one tally of `body` in `state` and adds its points to `points`, which has one entry for each of the body's
/// springs.
void tally(const Body& body, const State& state, Rng& random, std::vector<double>& points);

}  // namespace evodevo
