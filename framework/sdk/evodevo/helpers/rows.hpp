// For selection operators: an order of the rows that does not depend on the order of birth, and the choice of
// parents.
#pragma once

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "evodevo/selection.hpp"

namespace evodevo {

/// Returns the rows from best to worst: by the first score, ties by the other scores in their order, then by youth,
/// then by the order of birth. Failed rows come last, and among them those first that violate the constraints least
/// (Deb 2000). An operator that works in this order gives a result that depends on the order of birth only for exact
/// ties.
inline std::vector<std::uint32_t> best_first(std::span<const Candidate> rows) {
  std::vector<std::uint32_t> order(rows.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
    const auto &a = rows[i].scores, &b = rows[j].scores;
    if (!std::equal(a.begin(), a.end(), b.begin(), b.end()))
      return std::lexicographical_compare(b.begin(), b.end(), a.begin(), a.end());
    if (rows[i].violation != rows[j].violation) return rows[i].violation < rows[j].violation;
    return rows[i].age < rows[j].age;
  });
  return order;
}

/// Returns the rows in the given order.
inline std::vector<Candidate> in_order(std::span<const Candidate> rows, const std::vector<std::uint32_t>& order) {
  std::vector<Candidate> sorted;
  for (const std::uint32_t i : order) sorted.push_back(rows[i]);
  return sorted;
}

/// Returns `count` pairs of a parent and a mate. Both are drawn from the rows that did not fail, or from all rows if
/// all failed. `draw(n, rng)` returns a rank from 0 (the best) to n-1. The mate differs from the parent if there is
/// more than one row to draw from.
template <class Draw>
std::vector<std::pair<std::uint32_t, std::uint32_t>> draw_pairs(std::span<const Candidate> rows, std::uint32_t count,
                                                                Rng& rng, const Draw& draw) {
  auto pool = best_first(rows);
  if (pool.empty()) return {};
  if (rows[pool.front()].ok()) std::erase_if(pool, [&](std::uint32_t i) { return !rows[i].ok(); });
  const auto size = static_cast<std::uint32_t>(pool.size());
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t parent = draw(size, rng);
    std::uint32_t mate = size > 1 ? draw(size - 1, rng) : parent;
    if (size > 1 && mate >= parent) ++mate;  // so that the mate is any row except the parent
    pairs.emplace_back(pool[parent], pool[mate]);
  }
  return pairs;
}

/// Draws a row uniformly: for draw_pairs(), a draw in which all rows have the same chance.
inline std::uint32_t draw_any(std::uint32_t rows, Rng& rng) { return rng.below(rows); }

}  // namespace evodevo
