// The paper's estimate of stress, Skip-Shift (section IV-D1). Stress is the mean absolute force of a spring over a
// cycle, in N; the estimate only ranks springs by it.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/simulator.hpp"
#include "evodevo/rng.hpp"

namespace evodevo {

/// The number of groups into which a body's springs are divided, which is the number of threads in the paper's blocks.
/// Bodies of fewer than 512 springs have half as many groups as springs, because in a group of one, the same spring
/// would both gain and lose a point.
inline constexpr std::size_t most_tally_groups = 256;

/// Returns the springs of a task in a new random order for a tally of this number, from 0.
using TallyOrder = std::function<std::vector<std::uint32_t>(std::size_t task, std::uint64_t number)>;

/// Simulates every task, with a tally of its springs after every `skip` steps. A tally divides the springs among the
/// groups in a new random order. In each group, the spring with the largest absolute force gains one point, and the
/// spring with the smallest absolute force loses one; ties are decided at random. The points become the task's
/// `stress`: the springs with the most points are the most stressed. A task with fewer than `skip` steps would have no
/// tally; it ends as invalid before its first step. `order` gives the orders.
///
/// The simulator advances the bodies from one tally to the next, and the host computes the tallies, in the same way for
/// every device. That costs more than recording the exact stress; this function exists only to reproduce the paper.
void run_with_tallies(Simulator& simulator, std::span<Task> tasks, std::uint64_t skip, const TallyOrder& order);

/// Computes one tally of `body` in `state`, whose springs are in this order, and adds its points to `points`, which has
/// one entry for each of the body's springs.
void tally(const Body& body, const State& state, const std::vector<std::uint32_t>& order, std::vector<double>& points);

/// Returns the numbers from 0 to `springs` - 1 in a random order.
std::vector<std::uint32_t> random_order(std::size_t springs, Rng& random);

}  // namespace evodevo
