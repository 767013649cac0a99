// Pareto layers and crowding, for selection operators.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "evodevo/selection.hpp"

namespace evodevo {

/// Objectives of one candidate, greater is better. Empty: it failed, and is dominated by every candidate that did not.
using Point = std::vector<double>;

/// Whether `a` is at least as good as `b` everywhere and better somewhere.
inline bool dominates(const Point& a, const Point& b) {
  if (a.empty() || b.empty()) return !a.empty() && b.empty();
  bool better = false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] < b[i]) return false;
    better |= a[i] > b[i];
  }
  return better;
}

/// The candidates' scores and, as a last objective, their youth.
inline std::vector<Point> scores_and_youth(std::span<const Candidate> rows) {
  std::vector<Point> points;
  for (const Candidate& row : rows) {
    points.emplace_back(row.scores.begin(), row.scores.end());
    if (row.ok()) points.back().push_back(-static_cast<double>(row.age));
  }
  return points;
}

/// Every point's Pareto layer: 0 for the front, 1 for the front of the rest, and so on (paper, section IV-F). Failed
/// points share one layer behind all others. By efficient non-dominated sort (Zhang et al. 2015): in descending order a
/// point is dominated by earlier ones only, and lies in the first layer where none of them does so.
inline std::vector<std::uint32_t> pareto_layers(const std::vector<Point>& points) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return points[b] < points[a]; });
  std::vector<std::uint32_t> layer(points.size());
  std::vector<std::vector<std::uint32_t>> layers;
  for (const std::uint32_t i : order) {
    const auto admits = [&](const std::vector<std::uint32_t>& members) {
      return std::none_of(members.rbegin(), members.rend(), [&](auto j) { return dominates(points[j], points[i]); });
    };
    const auto first = std::find_if(layers.begin(), layers.end(), admits);
    layer[i] = static_cast<std::uint32_t>(first - layers.begin());
    if (first == layers.end()) layers.emplace_back();
    layers[layer[i]].push_back(i);
  }
  return layer;
}

/// Points of one layer, each between its neighbours along every objective in which the points differ.
class Crowd {
 public:
  Crowd(const std::vector<Point>& points, const std::vector<std::uint32_t>& members) {
    const std::size_t objectives = members.empty() ? 0 : points[members.front()].size();
    for (std::size_t o = 0; o < objectives; ++o) add_objective(points, members, o);
  }

  /// How much room a member (its place in `members`) has between its neighbours, as a share of the range and summed
  /// over the objectives; infinitely much at an end (crowding distance, Deb et al. 2002).
  double room(std::uint32_t member) const {
    double sum = 0;
    for (const Line& line : lines_) {
      const std::uint32_t before = line.before[member], after = line.after[member];
      if (before == none || after == none) return std::numeric_limits<double>::infinity();
      sum += line.value[after] - line.value[before];
    }
    return sum;
  }

  /// Takes a member out; returns those that got room by it.
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
    std::vector<double> value;  ///< in units of the range
    std::vector<std::uint32_t> before, after;
  };

  void add_objective(const std::vector<Point>& points, const std::vector<std::uint32_t>& members, std::size_t o) {
    std::vector<std::uint32_t> order(members.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto value = [&](std::uint32_t i) { return points[members[i]][o]; };
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return value(a) < value(b); });
    // halves, since the range of two finite numbers may be infinite
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

/// The `count` members that stay when the most crowded go, one after the other. A member whose neighbour is gone has
/// more room than before. Of equally crowded members the last of `members` goes.
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

}  // namespace evodevo
