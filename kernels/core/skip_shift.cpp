#include "core/skip_shift.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "core/piecewise.hpp"

namespace evodevo {
namespace {

/// The absolute force of a spring and its dashpot in `state`, N.
double force(const Body& body, const State& state, const Spring& spring) {
  const Material& material = body.materials[spring.material];
  const Vec3 d = state.position[spring.b] - state.position[spring.a];
  const double distance = norm(d);
  double force = body.stiffness(spring) * (distance - spring.rest_length * material.relative_length(state.time));
  if (material.damping != 0 && distance > 0)
    force += body.damping(spring) * dot(d, state.velocity[spring.b] - state.velocity[spring.a]) / distance;
  return std::abs(force);
}

void refuse(Task& task, std::uint64_t skip) {
  task.status = Status::invalid;
  task.reason = "no tally in a cycle of " + std::to_string(task.steps) + " steps, because development.skip is " +
                std::to_string(skip) + "; choose a smaller value";
  task.clear({}, 0);
}

}  // namespace

std::vector<std::uint32_t> random_order(std::size_t springs, Rng& random) {
  std::vector<std::uint32_t> order(springs);
  std::iota(order.begin(), order.end(), 0u);
  random.shuffle(order);
  return order;
}

void tally(const Body& body, const State& state, const std::vector<std::uint32_t>& order, std::vector<double>& points) {
  std::vector<double> forces;
  for (const std::uint32_t s : order) forces.push_back(force(body, state, body.springs[s]));
  const std::size_t groups = std::min(most_tally_groups, order.size() / 2);
  for (std::size_t group = 0; group < groups; ++group) {
    const auto first = forces.begin() + static_cast<std::ptrdiff_t>(group * order.size() / groups);
    const auto last = forces.begin() + static_cast<std::ptrdiff_t>((group + 1) * order.size() / groups);
    // of equal forces, the first one counts; the choice is random because the order is random
    points[order[static_cast<std::size_t>(std::max_element(first, last) - forces.begin())]] += 1;
    points[order[static_cast<std::size_t>(std::min_element(first, last) - forces.begin())]] -= 1;
  }
}

void run_with_tallies(Simulator& simulator, std::span<Task> tasks, std::uint64_t skip, const TallyOrder& order) {
  for (Task& task : tasks) {
    task.clear({.stress = true}, task.body->springs.size());
    if (task.status == Status::ok && task.steps < skip) refuse(task, skip);
  }
  std::vector<std::uint64_t> tallies(tasks.size());
  const auto next_steps = [&](std::size_t) { return skip; };
  const auto look = [&](std::size_t i, const Task& piece) {
    Task& task = tasks[i];
    if (task.status != Status::ok)
      task.clear({}, 0);
    else if (piece.steps == skip)
      tally(*task.body, *task.state, order(i, tallies[i]++), task.stress);
  };
  run_in_pieces(simulator, tasks, {}, next_steps, look);
}

}  // namespace evodevo
