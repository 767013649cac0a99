#include "skip_shift.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "parallel.hpp"

namespace evodevo {
namespace {

/// The absolute force of a spring now, N.
double force(const Body& body, const State& state, const Spring& spring) {
  const Material& material = body.materials[spring.material];
  const double distance = norm(state.position[spring.b] - state.position[spring.a]);
  return std::abs(material.stiffness * (distance - spring.rest_length * material.relative_length(state.time)));
}

/// A body on its way through one piece of its run after the other.
class Journey {
 public:
  Journey(const Task& task, std::uint64_t skip) : whole_(task), start_(task.state->time) {
    whole_.clear({.stress = true}, task.body->springs.size());
    whole_.spring_evaluations = 0;
    if (whole_.status == Status::ok && whole_.steps < skip) refuse(skip);
  }

  bool is_over() const { return whole_.status != Status::ok || done_ == whole_.steps; }

  /// The next steps, at most `skip`.
  Task piece(std::uint64_t skip) const {
    Task piece = whole_;
    piece.steps = std::min(skip, whole_.steps - done_);
    return piece;
  }

  /// Takes the answer to a piece, and tallies if it was a whole one.
  void take(Task&& piece, std::uint64_t skip, Rng& random) {
    whole_.status = piece.status;
    whole_.ended_at = piece.ended_at;
    whole_.reason = std::move(piece.reason);
    whole_.preparation = std::move(piece.preparation);
    whole_.spring_evaluations += piece.spring_evaluations;
    done_ += piece.steps;
    if (whole_.status != Status::ok) return whole_.clear({}, 0);
    // not a sum of sums, so that the time is the same as after one run
    whole_.state->time = start_ + static_cast<double>(done_) * whole_.dt;
    if (piece.steps == skip) tally(*whole_.body, *whole_.state, random, whole_.stress);
  }

  Task& whole() { return whole_; }

 private:
  void refuse(std::uint64_t skip) {
    whole_.status = Status::invalid;
    whole_.reason = "no tally in a cycle of " + std::to_string(whole_.steps) +
                    " steps; set development.skip = " + std::to_string(skip) + " to at most as many";
    whole_.clear({}, 0);
  }

  Task whole_;
  double start_;  ///< s
  std::uint64_t done_ = 0;
};

}  // namespace

void tally(const Body& body, const State& state, Rng& random, std::vector<double>& points) {
  std::vector<std::uint32_t> order(body.springs.size());
  std::iota(order.begin(), order.end(), 0u);
  random.shuffle(order);
  std::vector<double> forces;
  for (const std::uint32_t s : order) forces.push_back(force(body, state, body.springs[s]));
  const std::size_t groups = std::min(most_tally_groups, order.size() / 2);
  for (std::size_t group = 0; group < groups; ++group) {
    const auto first = forces.begin() + static_cast<std::ptrdiff_t>(group * order.size() / groups);
    const auto last = forces.begin() + static_cast<std::ptrdiff_t>((group + 1) * order.size() / groups);
    // the first among equals, and the order is random
    points[order[static_cast<std::size_t>(std::max_element(first, last) - forces.begin())]] += 1;
    points[order[static_cast<std::size_t>(std::min_element(first, last) - forces.begin())]] -= 1;
  }
}

void run_with_tallies(Simulator& simulator, std::span<Task> tasks, std::uint64_t skip, std::span<Rng> random) {
  std::vector<Journey> journeys;
  for (const Task& task : tasks) journeys.emplace_back(task, skip);
  std::vector<std::size_t> moving(tasks.size());
  std::iota(moving.begin(), moving.end(), std::size_t{0});
  for (;;) {
    std::erase_if(moving, [&](std::size_t i) { return journeys[i].is_over(); });
    if (moving.empty()) break;
    std::vector<Task> pieces;
    for (const std::size_t i : moving) pieces.push_back(journeys[i].piece(skip));
    simulator.run(pieces, {});
    simulator.workers().for_each(
        moving.size(), [&](std::size_t i) { journeys[moving[i]].take(std::move(pieces[i]), skip, random[moving[i]]); });
  }
  for (std::size_t i = 0; i < tasks.size(); ++i) tasks[i] = std::move(journeys[i].whole());
}

}  // namespace evodevo
