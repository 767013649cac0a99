#include "body_building.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "parallel.hpp"
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

std::vector<Vec3> rest_places(const Body& body) {
  std::vector<Vec3> places;
  places.reserve(body.masses.size());
  for (const Mass& mass : body.masses) places.push_back(mass.rest);
  return places;
}

void join(Body& body, std::span<const IndexPair> pairs) {
  body.springs.reserve(body.springs.size() + pairs.size());
  for (const auto& [a, b] : pairs) {
    const Mass &mass_a = body.masses[a], &mass_b = body.masses[b];
    // by value: the list of materials may grow
    const Material of_a = body.materials.at(static_cast<std::size_t>(mass_a.material));
    const Material of_b = body.materials.at(static_cast<std::size_t>(mass_b.material));
    body.springs.push_back({a, b, norm(mass_a.rest - mass_b.rest), body.material_index(mean(of_a, of_b))});
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

/// Keeps the piece with most masses; of equal ones that of the lowest index. Returns the masses kept.
std::vector<std::uint32_t> keep_largest_piece(Body& body) {
  const std::vector<std::uint32_t> leader = pieces(body);
  std::vector<std::uint32_t> size(body.masses.size(), 0);
  for (const std::uint32_t i : leader) ++size[i];
  const auto largest = static_cast<std::uint32_t>(std::max_element(size.begin(), size.end()) - size.begin());

  std::vector<std::uint32_t> new_index(body.masses.size(), 0), kept;
  std::vector<Mass> masses;
  for (std::uint32_t i = 0; i < leader.size(); ++i) {
    if (leader[i] != largest) continue;
    new_index[i] = static_cast<std::uint32_t>(masses.size());
    kept.push_back(i);
    masses.push_back(body.masses[i]);
  }
  std::erase_if(body.springs, [&](const Spring& spring) { return leader[spring.a] != largest; });
  for (Spring& spring : body.springs)
    spring = {new_index[spring.a], new_index[spring.b], spring.rest_length, spring.material};
  body.masses = std::move(masses);
  return kept;
}

void place_on_origin(Body& body) {
  const std::vector<Vec3> places = rest_places(body);
  const Vec3 centre = centre_of_mass(body, places);
  const Vec3 shift{centre.x, centre.y, bounding_box(places).low.z};
  for (Mass& mass : body.masses) mass.rest = mass.rest - shift;
}

bool is_finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// Why a blueprint cannot become a body; empty where it may.
std::string blueprint_failure(const Blueprint& blueprint) {
  const std::vector<Mass>& masses = blueprint.body.masses;
  if (!blueprint.failure.empty()) return "no body: " + blueprint.failure;
  if (masses.empty()) return "no body: no masses";
  if (!std::all_of(masses.begin(), masses.end(), [](const Mass& mass) { return is_finite(mass.rest); }))
    return "no body: a place that is not finite";
  return "";
}

/// What is left to do once neighbours are joined.
BuiltBody finish(Body body) {
  leave_out_air(body);
  if (body.springs.empty()) return {{}, "no springs", {}};
  std::vector<std::uint32_t> kept = keep_largest_piece(body);
  place_on_origin(body);
  return {std::move(body), "", std::move(kept)};
}

}  // namespace

BuiltBody build_body(Blueprint blueprint) {
  if (std::string failure = blueprint_failure(blueprint); !failure.empty()) return {{}, std::move(failure), {}};
  join(blueprint.body, nearest_pairs(rest_places(blueprint.body), blueprint.neighbours));
  return finish(std::move(blueprint.body));
}

std::vector<BuiltBody> build_bodies(std::vector<Blueprint> blueprints, NeighbourSearch& search, Workers& workers) {
  std::vector<BuiltBody> built(blueprints.size());
  std::vector<std::vector<Vec3>> places(blueprints.size());
  workers.for_each(blueprints.size(), [&](std::size_t i) {
    built[i].failure = blueprint_failure(blueprints[i]);
    if (built[i].failure.empty()) places[i] = rest_places(blueprints[i].body);
  });
  std::vector<PointCloud> clouds;
  for (std::size_t i = 0; i < blueprints.size(); ++i) clouds.push_back({places[i], blueprints[i].neighbours});
  search.find(clouds, [&](std::size_t i, std::span<const IndexPair> pairs) {
    if (!built[i].failure.empty()) return;
    join(blueprints[i].body, pairs);
    built[i] = finish(std::move(blueprints[i].body));
  });
  return built;
}

}  // namespace evodevo
