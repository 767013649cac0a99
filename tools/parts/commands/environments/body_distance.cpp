#include "environments/body_distance.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <utility>

namespace evodevo {
namespace {

using Pairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;

/// A name for each mass of two bodies. A mass of one body and a mass of the other have equal names if they count as the
/// same mass.
struct Names {
  std::vector<std::uint32_t> of_a, of_b;  ///< by the indices of the masses
};

std::vector<std::uint32_t> own_names(const GrownBody& grown, std::size_t first_of_later) {
  std::vector<std::uint32_t> names = grown.numbers;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (grown.came_later(i)) names[i] = static_cast<std::uint32_t>(first_of_later + i);
  return names;
}

Names shared_names(const GrownBody& a, const GrownBody& b) {
  const std::size_t born = std::max(a.born, b.born);
  Names names{own_names(a, born), own_names(b, born + a.numbers.size())};
  std::vector<std::tuple<double, std::size_t, std::size_t>> near;  // distance, mass of a, mass of b
  for (std::size_t i = 0; i < a.numbers.size(); ++i)
    for (std::size_t j = 0; a.came_later(i) && j < b.numbers.size(); ++j)
      if (const double distance = norm(a.rest_positions[i] - b.rest_positions[j]);
          b.came_later(j) && distance < same_position)
        near.emplace_back(distance, i, j);
  std::sort(near.begin(), near.end());
  std::vector<char> taken_of_a(a.numbers.size()), taken_of_b(b.numbers.size());
  for (const auto& [_, i, j] : near) {
    if (taken_of_a[i] || taken_of_b[j]) continue;
    taken_of_a[i] = taken_of_b[j] = true;
    names.of_b[j] = names.of_a[i];
  }
  return names;
}

Pairs joined_masses(const Body& body, const std::vector<std::uint32_t>& names) {
  Pairs pairs;
  for (const Spring& spring : body.springs) pairs.insert(std::minmax(names[spring.a], names[spring.b]));
  return pairs;
}

/// One point mass in the distribution of a body's mass along one axis.
struct Portion {
  double position;  ///< rest position, body lengths at birth
  double mass;      ///< fraction of the body's total mass
};

/// Returns the distribution of a body's mass along an axis, by ascending position.
std::vector<Portion> portions_along(double Vec3::*axis, const GrownBody& grown) {
  std::vector<Portion> portions;
  double all = 0;
  for (std::size_t i = 0; i < grown.rest_positions.size(); ++i) {
    const Mass& mass = grown.body.masses[i];
    portions.push_back({grown.rest_positions[i].*axis, mass.mass - mass.payload});
    all += portions.back().mass;
  }
  for (Portion& portion : portions) portion.mass /= all;
  std::sort(portions.begin(), portions.end(), [](const Portion& a, const Portion& b) {
    return std::pair(a.position, a.mass) < std::pair(b.position, b.mass);
  });
  return portions;
}

/// Returns the integral of the absolute difference of the two cumulative distribution functions (Vallender 1974).
double wasserstein_distance(const std::vector<Portion>& a, const std::vector<Portion>& b) {
  double below_a = 0, below_b = 0;  // mass at lower positions
  double distance = 0, last = 0;
  for (auto i = a.begin(), j = b.begin(); i != a.end() || j != b.end();) {
    const double position = j == b.end() || (i != a.end() && i->position < j->position) ? i->position : j->position;
    distance += std::abs(below_a - below_b) * (position - last);
    last = position;
    for (; i != a.end() && i->position == position; ++i) below_a += i->mass;
    for (; j != b.end() && j->position == position; ++j) below_b += j->mass;
  }
  return distance;
}

}  // namespace

double spring_distance(const GrownBody& a, const GrownBody& b) {
  const Names names = shared_names(a, b);
  const Pairs of_a = joined_masses(a.body, names.of_a), of_b = joined_masses(b.body, names.of_b);
  const auto in_b = [&](const auto& pair) { return of_b.contains(pair); };
  const auto common = static_cast<double>(std::count_if(of_a.begin(), of_a.end(), in_b));
  const double all = static_cast<double>(of_a.size() + of_b.size()) - common;
  return all > 0 ? 1 - common / all : 0;
}

double mass_distance(const GrownBody& a, const GrownBody& b) {
  double sum = 0;
  for (const auto axis : {&Vec3::x, &Vec3::y, &Vec3::z})
    sum += wasserstein_distance(portions_along(axis, a), portions_along(axis, b));
  return sum / 3;
}

}  // namespace evodevo
