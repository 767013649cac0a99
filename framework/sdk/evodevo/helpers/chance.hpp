// For devo operators: choices at random that follow `[development] draws`.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "evodevo/devo.hpp"

namespace evodevo {

/// Items on a ring, each at a place from 0 to 1. If places are drawn by identity, one item more or less changes only
/// what is drawn from the arc before it.
class Ring {
 public:
  Ring() = default;
  /// `items` are places and what lies there.
  explicit Ring(std::vector<std::pair<double, std::uint32_t>> items) : items_(std::move(items)) {
    std::ranges::sort(items_);
  }

  /// Returns the first item at a place or after it that is not `other`. The ring must have such an item.
  std::uint32_t at(double place, std::optional<std::uint32_t> other = std::nullopt) const {
    auto found = std::ranges::lower_bound(items_, std::pair(place, std::uint32_t{0}));
    for (;; ++found) {
      if (found == items_.end()) found = items_.begin();
      if (found->second != other) return found->second;
    }
  }

 private:
  std::vector<std::pair<double, std::uint32_t>> items_;  ///< places, ascending, and the items there
};

/// The random choices of one application of a devo operator.
///
/// With inherited draws, every choice follows from numbers that are drawn by identity (DevoContext::draw), so that
/// relatives that are alike make the same choices, and one mass more or less changes few of them. Otherwise all choices
/// follow one after the other from the stream `rng` of the individual.
class Chance {
 public:
  Chance(const DevoContext& context, Rng& rng) : context_(context), rng_(rng) {}

  bool inherited() const { return context_.draws.inherited(); }
  Rng& rng() { return rng_; }  ///< the stream of the individual

  /// Returns a stream for a tag, and for identities if given: of its own with inherited draws, valid until the next
  /// call; otherwise that of the individual.
  Rng& stream(const Tag& tag, std::initializer_list<std::uint64_t> identities = {}) {
    return inherited() ? own_.emplace(context_.draws.stream(tag, identities)) : rng_;
  }

  /// Returns what stands for a pair of masses, in either order, and for a spring: its pair, and how many springs of
  /// lower index join the same pair.
  std::uint64_t key_of(std::uint32_t a, std::uint32_t b) const {
    const auto [low, high] = std::minmax({context_.identity(a), context_.identity(b)});
    return mixed(low, high);
  }
  std::uint64_t key_of(std::uint32_t spring) {
    const Spring& s = context_.body.springs[spring];
    return mixed(key_of(s.a, s.b), ordinal(spring));
  }

  /// Returns a number from [0, 1) for a spring, a function of its key.
  double number_of(std::uint32_t spring, const Tag& tag) { return context_.draws.number(tag, {key_of(spring)}); }

  /// Returns a number that orders springs whose keys are equal. To be called once for each.
  double tie(std::uint32_t spring) { return inherited() ? number_of(spring, "tie") : rng_(); }

  /// Returns one of several masses, of which there is at least one; all are equally likely. With inherited draws, it is
  /// that with the smallest number.
  std::uint32_t one_of(std::span<const std::uint32_t> masses, const Tag& tag) {
    if (!inherited()) return masses[rng_.below(static_cast<std::uint32_t>(masses.size()))];
    return *std::ranges::min_element(masses, {}, [&](std::uint32_t mass) { return context_.draw(mass, tag); });
  }

  /// Returns all springs in the order of their numbers, or all masses.
  std::vector<std::uint32_t> springs_by_number(const Tag& tag) {
    return in_order(context_.body.springs.size(), [&](std::uint32_t s) { return number_of(s, tag); });
  }
  std::vector<std::uint32_t> masses_by_number(const Tag& tag) const {
    return in_order(context_.body.masses.size(), [&](std::uint32_t i) { return context_.draw(i, tag); });
  }

  /// Returns some masses of the body on a ring, or all springs.
  Ring ring_of(std::span<const std::uint32_t> masses) const {
    std::vector<std::pair<double, std::uint32_t>> places;
    for (const std::uint32_t mass : masses) places.emplace_back(context_.draw(mass, "ring"), mass);
    return Ring(std::move(places));
  }
  Ring ring_of_springs() {
    std::vector<std::pair<double, std::uint32_t>> places;
    for (std::uint32_t s = 0; s < context_.body.springs.size(); ++s) places.emplace_back(number_of(s, "ring"), s);
    return Ring(std::move(places));
  }

 private:
  /// Returns the indices of `count` items in the order of their numbers.
  static std::vector<std::uint32_t> in_order(std::size_t count, const auto& number_of) {
    std::vector<std::pair<double, std::uint32_t>> order;
    for (std::uint32_t i = 0; i < count; ++i) order.emplace_back(number_of(i), i);
    std::ranges::sort(order);
    std::vector<std::uint32_t> items;
    for (const auto& [number, item] : order) items.push_back(item);
    return items;
  }

  /// Returns the number of springs of lower index that join the same two masses.
  std::uint64_t ordinal(std::uint32_t spring) {
    if (ordinals_.empty()) count_parallel();
    return ordinals_[spring];
  }

  void count_parallel() {
    const std::vector<Spring>& springs = context_.body.springs;
    const auto pair = [&](std::uint32_t s) { return std::minmax({springs[s].a, springs[s].b}); };
    ordinals_.resize(springs.size());
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
    for (std::uint32_t s = 0; s < springs.size(); ++s)
      order.emplace_back(std::uint64_t{pair(s).first} << 32 | pair(s).second, s);
    std::ranges::sort(order);
    for (std::size_t i = 1; i < order.size(); ++i)
      if (order[i].first == order[i - 1].first) ordinals_[order[i].second] = ordinals_[order[i - 1].second] + 1;
  }

  const DevoContext& context_;
  Rng& rng_;
  std::optional<Rng> own_;
  std::vector<std::uint32_t> ordinals_;  ///< of each spring; empty until one is needed
};

}  // namespace evodevo
