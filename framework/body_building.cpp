#include "body_building.hpp"

#include <numeric>

#include "neighbours.hpp"
#include "stability.hpp"
#include "text.hpp"

namespace evodevo {
namespace {

void leave_out_air(Body& body) {
  std::erase_if(body.springs, [&](const Spring& spring) {
    const bool air = body.materials[spring.material].stiffness == 0;
    if (air) {
      ++body.masses[spring.a].air_contacts;
      ++body.masses[spring.b].air_contacts;
    }
    return air;
  });
}

void join_neighbours(Body& body, std::uint32_t neighbours) {
  std::vector<Vec3> places;
  for (const Mass& mass : body.masses) places.push_back(mass.rest);
  for (const auto& [a, b] : nearest_pairs(places, neighbours)) {
    // by value: the list of materials may grow
    const Material of_a = body.materials.at(static_cast<std::size_t>(body.masses[a].material));
    const Material of_b = body.materials.at(static_cast<std::size_t>(body.masses[b].material));
    body.springs.push_back({a, b, norm(places[a] - places[b]), body.material_index(mean(of_a, of_b))});
  }
}

/// For every mass the lowest index among the masses that springs tie it to.
std::vector<std::uint32_t> pieces(const Body& body) {
  std::vector<std::uint32_t> leader(body.masses.size());
  std::iota(leader.begin(), leader.end(), 0u);
  const auto find = [&](std::uint32_t i) {
    while (leader[i] != i) i = leader[i] = leader[leader[i]];
    return i;
  };
  for (const Spring& spring : body.springs) {
    const auto [low, high] = std::minmax({find(spring.a), find(spring.b)});
    leader[high] = low;
  }
  for (std::uint32_t i = 0; i < leader.size(); ++i) leader[i] = find(i);
  return leader;
}

/// Keeps the piece with most masses; of equal ones that of the lowest index.
void keep_largest_piece(Body& body) {
  const std::vector<std::uint32_t> leader = pieces(body);
  std::vector<std::uint32_t> size(body.masses.size(), 0);
  for (const std::uint32_t i : leader) ++size[i];
  const auto largest = static_cast<std::uint32_t>(std::max_element(size.begin(), size.end()) - size.begin());

  std::vector<std::uint32_t> new_index(body.masses.size(), 0);
  std::vector<Mass> kept;
  for (std::uint32_t i = 0; i < leader.size(); ++i) {
    if (leader[i] != largest) continue;
    new_index[i] = static_cast<std::uint32_t>(kept.size());
    kept.push_back(body.masses[i]);
  }
  std::erase_if(body.springs, [&](const Spring& spring) { return leader[spring.a] != largest; });
  for (Spring& spring : body.springs)
    spring = {new_index[spring.a], new_index[spring.b], spring.rest_length, spring.material};
  body.masses = std::move(kept);
}

void place_on_origin(Body& body) {
  std::vector<Vec3> places;
  for (const Mass& mass : body.masses) places.push_back(mass.rest);
  const Vec3 centre = centre_of_mass(body, places);
  const Vec3 shift{centre.x, centre.y, bounding_box(places).low.z};
  for (Mass& mass : body.masses) mass.rest = mass.rest - shift;
}

bool is_finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

}  // namespace

BuiltBody build_body(Blueprint blueprint) {
  Body& body = blueprint.body;
  if (!blueprint.failure.empty()) return {{}, "no body: " + blueprint.failure};
  if (body.masses.empty()) return {{}, "no body: no masses"};
  for (const Mass& mass : body.masses)
    if (!is_finite(mass.rest)) return {{}, "no body: a place that is not finite"};
  if (blueprint.neighbours > 0) join_neighbours(body, blueprint.neighbours);
  leave_out_air(body);
  if (body.springs.empty()) return {{}, "no springs"};
  keep_largest_piece(body);
  place_on_origin(body);
  return {std::move(body), ""};
}

std::string step_failure(const Body& body, std::span<const Vec3> places, const Scene& scene, const Stepping& stepping) {
  double lightest = std::numeric_limits<double>::infinity();
  for (const Mass& mass : body.masses) lightest = std::min(lightest, mass.mass);
  const bool contact_holds = stepping.dt <= largest_contact_dt(scene, lightest, stepping.method);
  if (contact_holds && is_stable(body, places, stepping)) return "";
  return "unstable dt: " + to_text(stepping.dt) + " s is too long for the body's " +
         (contact_holds ? "springs" : "lightest mass on this floor");
}

}  // namespace evodevo
