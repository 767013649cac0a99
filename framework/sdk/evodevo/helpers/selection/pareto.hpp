// Pareto layers and crowding, for selection operators.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "evodevo/selection.hpp"

namespace evodevo {

/// The objectives of one candidate; greater is better. A candidate that failed has no objectives, and every candidate
/// that did not fail dominates it.
using Point = std::vector<double>;

/// Returns whether `a` dominates `b`: it is at least as good in every objective and better in at least one.
inline bool dominates(const Point& a, const Point& b) {
  if (a.empty() || b.empty()) return !a.empty() && b.empty();
  bool better = false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] < b[i]) return false;
    better |= a[i] > b[i];
  }
  return better;
}

/// Returns one point for each candidate: its scores and, as the last objective, its youth (the negative age).
inline std::vector<Point> scores_and_youth(std::span<const Candidate> rows) {
  std::vector<Point> points;
  for (const Candidate& row : rows) {
    points.emplace_back(row.scores.begin(), row.scores.end());
    if (row.ok()) points.back().push_back(-static_cast<double>(row.age));
  }
  return points;
}

/// Returns every point's Pareto layer: 0 for the front, 1 for the front of the remaining points, and so on (paper,
/// section IV-F). Failed points share the last layer. The algorithm is the efficient non-dominated sort (Zhang et al.
/// 2015): it takes the points in descending lexicographic order, in which only earlier points can dominate a point, and
/// puts each into the first layer that has no point dominating it. A binary search finds this layer, because a point
/// that is dominated in one layer is dominated in all layers before it.
inline std::vector<std::uint32_t> pareto_layers(const std::vector<Point>& points) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return points[b] < points[a]; });
  std::vector<std::uint32_t> layer(points.size());
  std::vector<std::vector<std::uint32_t>> layers;
  for (const std::uint32_t i : order) {
    const auto has_dominating = [&](const std::vector<std::uint32_t>& members) {
      return std::any_of(members.rbegin(), members.rend(), [&](auto j) { return dominates(points[j], points[i]); });
    };
    const auto first = std::partition_point(layers.begin(), layers.end(), has_dominating);
    layer[i] = static_cast<std::uint32_t>(first - layers.begin());
    if (first == layers.end()) layers.emplace_back();
    layers[layer[i]].push_back(i);
  }
  return layer;
}

/// The points of one layer, linked to their neighbours along every objective in which the points differ.
class Crowd {
 public:
  Crowd(const std::vector<Point>& points, const std::vector<std::uint32_t>& members) {
    const std::size_t objectives = members.empty() ? 0 : points[members.front()].size();
    for (std::size_t o = 0; o < objectives; ++o) add_objective(points, members, o);
  }

  /// Returns the crowding distance of a member (Deb et al. 2002): the distance between its two neighbours relative to
  /// the range of the objective, summed over the objectives; infinity if the member is the first or last along any of
  /// them. `member` is an index into `members`.
  double room(std::uint32_t member) const {
    double sum = 0;
    for (const Line& line : lines_) {
      const std::uint32_t before = line.before[member], after = line.after[member];
      if (before == none || after == none) return std::numeric_limits<double>::infinity();
      sum += line.value[after] - line.value[before];
    }
    return sum;
  }

  /// Removes a member and returns its former neighbours, whose crowding distance has grown.
  std::vector<std::uint32_t> remove(std::uint32_t member) {
    std::vector<std::uint32_t> neighbours;
    for (Line& line : lines_) {
      const std::uint32_t before = line.before[member], after = line.after[member];
      if (before != none) line.after[before] = after, neighbours.push_back(before);
      if (after != none) line.before[after] = before, neighbours.push_back(after);
    }
    return neighbours;
  }

 private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  /// The members in the order of one objective, as a doubly linked list.
  struct Line {
    std::vector<double> value;                 ///< value of each member relative to the range of the objective
    std::vector<std::uint32_t> before, after;  ///< each member's neighbours; `none` at an end
  };

  void add_objective(const std::vector<Point>& points, const std::vector<std::uint32_t>& members, std::size_t o) {
    std::vector<std::uint32_t> order(members.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto value = [&](std::uint32_t i) { return points[members[i]][o]; };
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return value(a) < value(b); });
    // half of the range, since the difference of two finite numbers may overflow to infinity
    const double half_range = value(order.back()) / 2 - value(order.front()) / 2;
    if (!(half_range > 0)) return;
    Line line{{}, std::vector(members.size(), none), std::vector(members.size(), none)};
    for (std::uint32_t i = 0; i < members.size(); ++i) line.value.push_back(value(i) / half_range / 2);
    for (std::size_t i = 1; i < order.size(); ++i) {
      line.before[order[i]] = order[i - 1];
      line.after[order[i - 1]] = order[i];
    }
    lines_.push_back(std::move(line));
  }

  std::vector<Line> lines_;
};

/// Removes the most crowded member, updates the crowding distances of its neighbours, and repeats this until `count`
/// members are left; returns these. Of several equally crowded members, it removes the last in `members`.
inline std::vector<std::uint32_t> least_crowded(const std::vector<Point>& points,
                                                const std::vector<std::uint32_t>& members, std::size_t count) {
  if (members.size() <= count) return members;
  Crowd crowd(points, members);
  std::vector<std::uint32_t> left(members.size());
  std::iota(left.begin(), left.end(), 0u);
  std::vector<double> room;
  for (const std::uint32_t member : left) room.push_back(crowd.room(member));
  while (left.size() > count) {
    const auto most_crowded =
        std::min_element(left.rbegin(), left.rend(), [&](auto a, auto b) { return room[a] < room[b]; });
    for (const std::uint32_t neighbour : crowd.remove(*most_crowded)) room[neighbour] = crowd.room(neighbour);
    left.erase(std::next(most_crowded).base());
  }
  std::vector<std::uint32_t> stay;
  for (const std::uint32_t member : left) stay.push_back(members[member]);
  return stay;
}

/// Returns the points, at most `count`, that survive by layers (Deb et al. 2002): whole layers, the front first, and of
/// the layer that does not fit as a whole the least crowded points. `order` has the indices of all points; of several
/// equally crowded points, the last in it goes first.
inline std::vector<std::uint32_t> best_layers(const std::vector<Point>& points, const std::vector<std::uint32_t>& order,
                                              std::size_t count) {
  const auto layer = pareto_layers(points);
  std::vector<std::vector<std::uint32_t>> layers;
  for (const std::uint32_t i : order) {
    layers.resize(std::max<std::size_t>(layers.size(), layer[i] + 1));
    layers[layer[i]].push_back(i);
  }
  std::vector<std::uint32_t> chosen;
  for (std::size_t depth = 0; depth < layers.size() && chosen.size() < count; ++depth) {
    const auto stay = least_crowded(points, layers[depth], count - chosen.size());
    chosen.insert(chosen.end(), stay.begin(), stay.end());
  }
  return chosen;
}

/// Returns one point for each candidate: its scores.
inline std::vector<Point> points_of(std::span<const Candidate> rows) {
  std::vector<Point> points;
  for (const Candidate& row : rows) points.emplace_back(row.scores.begin(), row.scores.end());
  return points;
}

}  // namespace evodevo
