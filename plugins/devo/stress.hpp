// What the devo operators share: springs chosen by their stress.
#pragma once

#include <tuple>

#include "evodevo/devo.hpp"

/// The `count` springs with the smallest `key`, or all springs if there are fewer, smallest first, ties in random
/// order. No key may be NaN.
inline std::vector<std::uint32_t> springs_of_least(const std::vector<double>& key, std::size_t count,
                                                   evodevo::Rng& rng) {
  count = std::min(count, key.size());
  if (count == 0) return {};
  std::vector<double> least(count);  // few of many: most keys are looked at once
  std::partial_sort_copy(key.begin(), key.end(), least.begin(), least.end());
  using Ranked = std::tuple<double, std::uint32_t, std::uint32_t>;
  std::vector<Ranked> ranked;
  for (std::uint32_t s = 0; s < key.size(); ++s)
    if (key[s] <= least.back()) ranked.emplace_back(key[s], rng(), s);
  std::sort(ranked.begin(), ranked.end());
  std::vector<std::uint32_t> springs;
  for (std::size_t i = 0; i < count; ++i) springs.push_back(std::get<2>(ranked[i]));
  return springs;
}

/// The least stressed springs, least first. A stress that is not a number counts as the greatest.
inline std::vector<std::uint32_t> least_stressed(std::span<const double> stress, std::size_t count, evodevo::Rng& rng) {
  std::vector<double> key(stress.begin(), stress.end());
  for (double& value : key)
    if (std::isnan(value)) value = std::numeric_limits<double>::infinity();
  return springs_of_least(key, count, rng);
}

/// The most stressed springs, most first. A stress that is not a number counts as the least.
inline std::vector<std::uint32_t> most_stressed(std::span<const double> stress, std::size_t count, evodevo::Rng& rng) {
  std::vector<double> key(stress.begin(), stress.end());
  for (double& value : key) value = std::isnan(value) ? std::numeric_limits<double>::infinity() : -value;
  return springs_of_least(key, count, rng);
}

/// What springs are judged by, as a parameter that all operators have in common.
class StressMeasure {
 public:
  void declare(evodevo::Parameters& p) {
    p.choice(by_, "by", {"mean-force", "peak", "work", "tension", "compression"},
             "What counts as stress: a spring's mean or largest absolute force over the cycle, the work of its muscle, "
             "or the mean force by which it pulled or pushed.");
  }

  evodevo::SpringRequest request() const {
    return {.stress = by_ == "mean-force",
            .peak_force = by_ == "peak",
            .muscle_work = by_ == "work",
            .tension = by_ == "tension" || by_ == "compression"};
  }

  evodevo::Measure measure() const { return {by_, by_ == "work" ? "J" : "N"}; }

  /// Of every spring, N or J.
  std::vector<double> of(const evodevo::DevoContext& context) const {
    const std::span<const double> record = by_ == "mean-force" ? context.stress
                                           : by_ == "peak"     ? context.peak_force
                                           : by_ == "work"     ? context.muscle_work
                                                               : context.tension;
    std::vector<double> stress(record.begin(), record.end());
    if (by_ == "compression")
      for (double& value : stress) value = -value;
    return stress;
  }

 private:
  std::string by_ = "mean-force";
};

/// Draws springs with probability in proportion to their stress; all alike where no spring has any. A stress that is
/// not finite counts as none.
class StressLottery {
 public:
  /// Without springs; nothing can be drawn.
  StressLottery() = default;
  explicit StressLottery(std::span<const double> stress) {
    double sum = 0;
    for (const double value : stress) sums_.push_back(sum += value > 0 && std::isfinite(value) ? value : 0);
  }

  bool empty() const { return sums_.empty(); }

  std::uint32_t draw(evodevo::Rng& rng) const {
    const double total = sums_.back();
    if (!(total > 0) || !std::isfinite(total)) return rng.below(static_cast<std::uint32_t>(sums_.size()));
    const auto drawn = std::upper_bound(sums_.begin(), sums_.end(), rng.uniform() * total);
    // rounding may make the product as great as the total
    const auto last = std::lower_bound(sums_.begin(), sums_.end(), total);
    return static_cast<std::uint32_t>(std::min(drawn, last) - sums_.begin());
  }

 private:
  std::vector<double> sums_;  ///< of the stress up to each spring
};
