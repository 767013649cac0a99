// For selection operators: an order of the individuals that does not depend on that of the rows, competition between
// parents and children, and the choice of parents.
#pragma once

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "evodevo/selection.hpp"

namespace evodevo {

/// Returns whether a row is better than another one by the first `objectives` scores: by the first, ties by the others
/// in their order. A row that did not fail is better than one that failed. Of two that failed, the one is better that
/// violates the constraints less (Deb 2000).
inline bool is_better(const Candidate& one, const Candidate& other, std::size_t objectives = 1) {
  if (one.ok() != other.ok()) return one.ok();
  if (!one.ok()) return one.violation < other.violation;
  const auto a = one.scores.first(objectives), b = other.scores.first(objectives);
  return std::lexicographical_compare(b.begin(), b.end(), a.begin(), a.end());
}

/// Returns the rows from best to worst: by the first score, ties by the other scores in their order, then by youth,
/// then by id. Failed rows come last, and among them those first that violate the constraints least (Deb 2000). An
/// operator that works in this order gives a result that does not depend on the order of the rows.
inline std::vector<std::uint32_t> best_first(std::span<const Candidate> rows) {
  std::vector<std::uint32_t> order(rows.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
    const std::size_t objectives = rows[i].scores.size();
    if (is_better(rows[i], rows[j], objectives)) return true;
    if (is_better(rows[j], rows[i], objectives)) return false;
    return std::pair(rows[i].age, rows[i].id) < std::pair(rows[j].age, rows[j].id);
  });
  return order;
}

/// Returns the first `count` of some rows, or all of them if there are fewer.
inline std::vector<std::uint32_t> first_rows(std::vector<std::uint32_t> rows, std::size_t count) {
  rows.resize(std::min(rows.size(), count));
  return rows;
}

/// Lets children compete with the parents whose places they may take (Candidate::challenges), and returns which rows
/// lost. Of the children of one parent, all lose but the best, which is the first in `order`; it loses, too, unless
/// `wins(child, parent)`. If it wins, the parent loses. `order` has all rows, from best to worst.
template <class Wins>
std::vector<bool> lost_challenges(std::span<const Candidate> rows, const std::vector<std::uint32_t>& order,
                                  const Wins& wins) {
  std::vector<bool> lost(rows.size(), false), challenged(rows.size(), false);
  for (const std::uint32_t child : order) {
    if (!rows[child].challenges) continue;
    const std::uint32_t parent = *rows[child].challenges;
    const bool has_won = !challenged[parent] && wins(child, parent);
    challenged[parent] = true;
    lost[has_won ? parent : child] = true;
  }
  return lost;
}

/// Returns the rows that may breed, from best to worst: those that did not fail, or all if all failed.
inline std::vector<std::uint32_t> breeding_rows(std::span<const Candidate> rows) {
  auto pool = best_first(rows);
  if (!pool.empty() && rows[pool.front()].ok()) std::erase_if(pool, [&](std::uint32_t i) { return !rows[i].ok(); });
  return pool;
}

/// Returns `count` pairs of a parent and a mate, both from `pool`. `draw(n, rng)` returns a position from 0 to n-1. The
/// mate differs from the parent if the pool has more than one row.
template <class Draw>
std::vector<Couple> draw_pairs(const std::vector<std::uint32_t>& pool, std::uint32_t count, Rng& rng,
                               const Draw& draw) {
  if (pool.empty()) return {};
  const auto size = static_cast<std::uint32_t>(pool.size());
  std::vector<Couple> pairs;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t parent = draw(size, rng);
    std::uint32_t mate = size > 1 ? draw(size - 1, rng) : parent;
    if (size > 1 && mate >= parent) ++mate;  // so that the mate is any row except the parent
    pairs.push_back({pool[parent], pool[mate]});
  }
  return pairs;
}
/// The same for breeding_rows(): position 0 is the best row.
template <class Draw>
std::vector<Couple> draw_pairs(std::span<const Candidate> rows, std::uint32_t count, Rng& rng, const Draw& draw) {
  return draw_pairs(breeding_rows(rows), count, rng, draw);
}

/// Draws a row uniformly: for draw_pairs(), a draw in which all rows have the same chance.
inline std::uint32_t draw_any(std::uint32_t rows, Rng& rng) { return rng.below(rows); }

/// For draw_pairs(): of some rows drawn uniformly, the best wins (tournament: Goldberg & Deb 1991).
struct Tournament {
  std::int64_t size;  ///< number of rows drawn, some perhaps more than once

  std::uint32_t operator()(std::uint32_t rows, Rng& rng) const {
    std::uint32_t best = rng.below(rows);
    for (std::int64_t i = 1; i < size; ++i) best = std::min(best, rng.below(rows));
    return best;
  }
};

}  // namespace evodevo
