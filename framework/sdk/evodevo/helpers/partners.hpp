// For devo operators: which masses are joined, which are nearest, and how many springs each has.
#pragma once

#include <algorithm>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "evodevo/devo.hpp"

namespace evodevo {

/// For every mass, the masses that springs join it to (its partners), all in one array. Takes time and memory in
/// proportion to the number of springs.
class Partners {
 public:
  explicit Partners(const Body& body)
      : first_(body.masses.size() + 1), partners_(2 * body.springs.size()), springs_(2 * body.springs.size()) {
    for (const Spring& spring : body.springs) {
      ++first_[spring.a + 1];
      ++first_[spring.b + 1];
    }
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    auto next = first_;
    for (std::uint32_t s = 0; s < body.springs.size(); ++s)
      for (const auto& [mass, other] :
           {std::pair(body.springs[s].a, body.springs[s].b), {body.springs[s].b, body.springs[s].a}}) {
        partners_[next[mass]] = other;
        springs_[next[mass]++] = s;
      }
  }

  /// Returns the partners of a mass, in the order of the springs. If several springs join it to the same partner, that
  /// partner is there once for each.
  std::span<const std::uint32_t> of(std::uint32_t mass) const {
    return {partners_.data() + first_[mass], first_[mass + 1] - first_[mass]};
  }

  /// Returns the indices of the springs of a mass, ascending.
  std::span<const std::uint32_t> springs_of(std::uint32_t mass) const {
    return {springs_.data() + first_[mass], first_[mass + 1] - first_[mass]};
  }

  bool joined(std::uint32_t a, std::uint32_t b) const {
    const auto partners = of(a);
    return std::find(partners.begin(), partners.end(), b) != partners.end();
  }

 private:
  std::vector<std::uint32_t> first_;  ///< for each mass, the index of its first partner in `partners_`
  std::vector<std::uint32_t> partners_, springs_;
};

/// Returns the number of springs of each mass, including its contacts to air (paper, section IV-D3).
inline std::vector<std::int64_t> degrees(const Body& body) {
  std::vector<std::int64_t> degree;
  for (const Mass& mass : body.masses) degree.push_back(mass.air_contacts);
  for (const Spring& spring : body.springs) {
    ++degree[spring.a];
    ++degree[spring.b];
  }
  return degree;
}

/// Moves the `count` masses that are nearest to a position to the front of `masses`, nearest first, ties by
/// DevoContext::rank(). The order of the others is not specified. Distances are those of DevoContext::position().
inline void sort_nearest_first(std::vector<std::uint32_t>& masses, std::size_t count, const Vec3& position,
                               const DevoContext& context) {
  std::vector<std::tuple<double, std::uint64_t, std::uint32_t>> order;
  for (const std::uint32_t i : masses) order.emplace_back(norm(context.position(i) - position), context.rank(i), i);
  const auto needed = static_cast<std::ptrdiff_t>(std::min(order.size(), count));
  std::partial_sort(order.begin(), order.begin() + needed, order.end());
  std::transform(order.begin(), order.end(), masses.begin(), [](const auto& item) { return std::get<2>(item); });
}

}  // namespace evodevo
