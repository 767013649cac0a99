#include "body_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
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

using Cells = std::map<std::array<std::int64_t, 3>, double>;

/// Adds `share` (1) of all mass at a place, in units of a cell's edge, to the nearest cells.
void add_to_cells(const Vec3& place, double share, Cells& cells) {
  const double at[] = {place.x, place.y, place.z};
  for (int corner = 0; corner < 8; ++corner) {
    std::array<std::int64_t, 3> cell;
    double part = share;
    for (std::size_t c = 0; c < 3; ++c) {
      const double below = std::floor(at[c]), above = at[c] - below;
      const bool upper = corner >> c & 1;
      cell[c] = static_cast<std::int64_t>(below) + upper;
      part *= upper ? above : 1 - above;
    }
    cells[cell] += part;
  }
}

/// The parts of a body's mass in cells of `edge` (m).
Cells distribution(const GrownBody& grown, double edge) {
  Cells cells;
  const Vec3 centre = centre_of_mass(grown.body, grown.places);
  double total = 0;
  for (const Mass& mass : grown.body.masses) total += mass.mass;
  for (std::size_t i = 0; i < grown.places.size(); ++i)
    add_to_cells((1 / edge) * (grown.places[i] - centre), grown.body.masses[i].mass / total, cells);
  return cells;
}

}  // namespace

double spring_distance(const GrownBody& a, const GrownBody& b) {
  const Pairs of_a = joined_masses(a), of_b = joined_masses(b);
  const auto in_b = [&](const auto& pair) { return of_b.contains(pair); };
  const auto common = static_cast<double>(std::count_if(of_a.begin(), of_a.end(), in_b));
  const double all = static_cast<double>(of_a.size() + of_b.size()) - common;
  return all > 0 ? 1 - common / all : 0;
}

double mass_distance(const GrownBody& a, const GrownBody& b) {
  const double longest = std::max(bounding_box(a.places).longest_side(), bounding_box(b.places).longest_side());
  const double edge = longest > 0 ? longest / 10 : 1;
  Cells difference = distribution(a, edge);
  for (const auto& [cell, share] : distribution(b, edge)) difference[cell] -= share;
  double sum = 0;
  for (const auto& [cell, share] : difference) sum += std::abs(share);
  return sum / 2;
}

}  // namespace evodevo
