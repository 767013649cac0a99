#include "body_distance.hpp"

#include <algorithm>
#include <set>

namespace evodevo {
namespace {

using Pairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;

Pairs joined_masses(const GrownBody& grown) {
  Pairs pairs;
  for (const Spring& spring : grown.body.springs)
    pairs.insert(std::minmax(grown.numbers.at(spring.a), grown.numbers.at(spring.b)));
  return pairs;
}

/// The part of all items of two sets that only one of them holds.
template <class Item>
double jaccard_distance(const std::set<Item>& a, const std::set<Item>& b) {
  const auto in_b = [&](const Item& item) { return b.contains(item); };
  const auto common = static_cast<double>(std::count_if(a.begin(), a.end(), in_b));
  const double all = static_cast<double>(a.size() + b.size()) - common;
  return all > 0 ? 1 - common / all : 0;
}

}  // namespace

double spring_distance(const GrownBody& a, const GrownBody& b) {
  return jaccard_distance(joined_masses(a), joined_masses(b));
}

double mass_distance(const GrownBody& a, const GrownBody& b) {
  return jaccard_distance(std::set(a.numbers.begin(), a.numbers.end()), std::set(b.numbers.begin(), b.numbers.end()));
}

}  // namespace evodevo
