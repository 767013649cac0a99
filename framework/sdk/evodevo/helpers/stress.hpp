// For devo operators: what counts as stress, and the choice of springs by it.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>
#include <span>
#include <tuple>
#include <vector>

#include "evodevo/helpers/chance.hpp"

namespace evodevo {

/// Returns the number at place `count` (from 1) of the ascending order of `numbers`; infinity if there are fewer.
inline double nth_smallest(std::span<const double> numbers, std::size_t count) {
  double bound = std::numeric_limits<double>::infinity();  // at least `count` numbers seen so far are not above it
  std::vector<double> least;                               // below bounds so far
  const auto nth = [&] { return least.begin() + static_cast<std::ptrdiff_t>(count - 1); };
  const auto lower_bound = [&] {
    std::nth_element(least.begin(), nth(), least.end());
    least.resize(count);
    bound = least.back();
  };
  for (const double number : numbers) {  // `count` is small, so most numbers are compared only once
    if (!(number < bound)) continue;
    least.push_back(number);
    if (least.size() == 2 * count) lower_bound();
  }
  if (least.size() >= count) lower_bound();
  return bound;
}

/// Returns the `count` springs with the smallest `key`, or all springs if there are fewer; smallest first, ties in
/// random order. No key may be NaN.
inline std::vector<std::uint32_t> springs_of_least(const std::vector<double>& key, std::size_t count, Chance& chance) {
  count = std::min(count, key.size());
  if (count == 0) return {};
  const double bound = nth_smallest(key, count);
  using Ranked = std::tuple<double, double, std::uint32_t>;
  std::vector<Ranked> ranked;
  for (std::uint32_t s = 0; s < key.size(); ++s)
    if (key[s] <= bound) ranked.emplace_back(key[s], chance.tie(s), s);
  std::sort(ranked.begin(), ranked.end());
  std::vector<std::uint32_t> springs;
  for (std::size_t i = 0; i < count; ++i) springs.push_back(std::get<2>(ranked[i]));
  return springs;
}

/// Returns the `count` least stressed springs, least stressed first. A stress of NaN counts as the greatest.
inline std::vector<std::uint32_t> least_stressed(std::span<const double> stress, std::size_t count, Chance& chance) {
  std::vector<double> key(stress.begin(), stress.end());
  for (double& value : key)
    if (std::isnan(value)) value = std::numeric_limits<double>::infinity();
  return springs_of_least(key, count, chance);
}

/// Returns the `count` most stressed springs, most stressed first. A stress of NaN counts as the least.
inline std::vector<std::uint32_t> most_stressed(std::span<const double> stress, std::size_t count, Chance& chance) {
  std::vector<double> key(stress.begin(), stress.end());
  for (double& value : key) value = std::isnan(value) ? std::numeric_limits<double>::infinity() : -value;
  return springs_of_least(key, count, chance);
}

/// The parameter `by`, which all these operators share: the quantity that counts as the stress of a spring.
class StressMeasure {
 public:
  void declare(Parameters& p) {
    p.choice(by_, "by", {"mean-force", "peak", "work", "tension", "compression"},
             "What counts as stress: a spring's mean or largest absolute force over the cycle, the work of its muscle, "
             "or the mean force with which it pulls (tension) or pushes (compression).");
  }

  RecordRequest request() const {
    return {.stress = by_ == "mean-force",
            .peak_force = by_ == "peak",
            .muscle_work = by_ == "work",
            .tension = by_ == "tension" || by_ == "compression"};
  }

  Measure measure() const { return {by_, by_ == "work" ? "J" : "N"}; }

  /// Returns the chosen quantity of every spring, N or J.
  std::vector<double> of(const DevoContext& context) const {
    const RequestedRecord& record = by_ == "mean-force" ? context.stress
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

/// Draws springs with probability proportional to their stress, or uniformly if no spring has stress. A spring can be
/// drawn several times. A stress that is negative or not finite counts as zero.
///
/// With inherited draws, each spring arrives again and again, after times that are exponentially distributed, at a rate
/// equal to its stress, and the springs are drawn in the order of their arrivals. One spring more or less thus leaves
/// the order of the others as it is.
class StressLottery {
 public:
  /// Makes a lottery without springs, for which draw() must not be called.
  StressLottery() = default;
  explicit StressLottery(std::span<const double> stress) {
    for (const double value : stress) {
      stress_.push_back(value > 0 && std::isfinite(value) ? value : 0);
      total_ += stress_.back();
    }
    if (total_ > 0 && std::isfinite(total_)) return;
    stress_.assign(stress_.size(), 1);
    total_ = 0;
  }

  bool empty() const { return stress_.empty(); }

  struct Drawn {
    std::uint32_t spring;
    std::uint64_t times;  ///< how often it had been drawn before; 0 unless draws are inherited
  };

  Drawn draw(Chance& chance) {
    if (chance.inherited()) return next_arrival(chance);
    if (!(total_ > 0)) return {chance.rng().below(static_cast<std::uint32_t>(stress_.size())), 0};
    if (sums_.empty()) std::partial_sum(stress_.begin(), stress_.end(), std::back_inserter(sums_));
    const auto drawn = std::upper_bound(sums_.begin(), sums_.end(), chance.rng().uniform() * total_);
    // the product can be rounded up to the total
    const auto last = std::lower_bound(sums_.begin(), sums_.end(), total_);
    return {static_cast<std::uint32_t>(std::min(drawn, last) - sums_.begin()), 0};
  }

 private:
  struct Arrival {
    double time;
    std::uint32_t spring;
    std::uint64_t times;
    bool operator>(const Arrival& other) const { return time > other.time; }
  };

  Drawn next_arrival(Chance& chance) {
    const auto after = [&](double time, std::uint32_t spring, std::uint64_t times) {
      return Arrival{time - std::log1p(-chance.number_of(spring, {"arrival", times})) / stress_[spring], spring, times};
    };
    if (arrivals_.empty()) {
      for (std::uint32_t s = 0; s < stress_.size(); ++s)
        if (stress_[s] > 0) arrivals_.push_back(after(0, s, 0));
      std::ranges::make_heap(arrivals_, std::greater());
    }
    std::ranges::pop_heap(arrivals_, std::greater());
    const auto [time, spring, times] = arrivals_.back();
    arrivals_.back() = after(time, spring, times + 1);
    std::ranges::push_heap(arrivals_, std::greater());
    return {spring, times};
  }

  std::vector<double> stress_;     ///< of each spring; 1 of all if none has stress
  double total_ = 0;               ///< sum of all stress, N; 0 if none has stress
  std::vector<double> sums_;       ///< for each spring, the sum over the springs up to and including it
  std::vector<Arrival> arrivals_;  ///< the next of each spring: a heap, the earliest first
};

}  // namespace evodevo
