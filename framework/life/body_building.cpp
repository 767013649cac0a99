#include "life/body_building.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include "analysis/neighbours.hpp"
#include "analysis/stability.hpp"
#include "base/materials.hpp"
#include "base/text.hpp"
#include "threads/parallel.hpp"

namespace evodevo {
namespace {

/// Leaves only the numbers of the items with these indices.
void keep_memory(const std::vector<std::uint32_t>& kept, MemoryByName& memory) {
  for (auto& [name, numbers] : memory) {
    for (std::size_t i = 0; i < kept.size(); ++i) numbers[i] = numbers[kept[i]];
    numbers.resize(kept.size());
  }
}

/// Removes the springs that `goes` names, and what they remember.
void erase_springs(Blueprint& blueprint, const auto& goes) {
  std::vector<Spring>& springs = blueprint.body.springs;
  if (!blueprint.spring_memory.empty()) {
    std::vector<std::uint32_t> kept;
    for (std::uint32_t i = 0; i < springs.size(); ++i)
      if (!goes(springs[i])) kept.push_back(i);
    keep_memory(kept, blueprint.spring_memory);
  }
  std::erase_if(springs, goes);
}

void leave_out_air(Blueprint& blueprint) {
  Body& body = blueprint.body;
  const auto is_of_air = [&](const Spring& spring) { return is_air(body.materials[spring.material]); };
  for (const Spring& spring : body.springs) {
    if (!is_of_air(spring)) continue;
    ++body.masses[spring.a].air_contacts;
    ++body.masses[spring.b].air_contacts;
  }
  erase_springs(blueprint, is_of_air);
}

/// Returns the pairs of masses that springs join, in ascending order. The lower index of each pair comes first.
std::vector<IndexPair> joined_pairs(const std::vector<Spring>& springs) {
  std::vector<IndexPair> pairs;
  pairs.reserve(springs.size());
  for (const Spring& spring : springs) pairs.emplace_back(std::minmax(spring.a, spring.b));
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

/// The materials of springs between masses: the means of the masses' materials. They are appended to a list.
class MeanMaterials {
 public:
  explicit MeanMaterials(std::vector<Material>& materials)
      : list_(materials), materials_(materials), count_(materials.size()), known_(is_small() ? count_ * count_ : 0) {}

  /// Returns the index of the mean of two materials that were in the list at first.
  std::uint32_t index_between(std::int32_t a, std::int32_t b) {
    const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
    if (!is_small()) return index_of_mean(i, j);
    std::optional<std::uint32_t>& known = known_.at(i * count_ + j);
    if (!known) known = index_of_mean(i, j);
    return *known;
  }

 private:
  bool is_small() const { return count_ <= 64; }
  std::uint32_t index_of_mean(std::size_t i, std::size_t j) {
    const Material of_a = materials_.at(i), of_b = materials_.at(j);  // copies, because the list may grow
    return list_.index(mean(of_a, of_b));
  }

  MaterialList list_;
  const std::vector<Material>& materials_;
  std::size_t count_;
  std::vector<std::optional<std::uint32_t>> known_;  ///< by pair; a look-up by the material takes longer
};

void join(Blueprint& blueprint, std::span<const IndexPair> pairs) {
  Body& body = blueprint.body;
  const std::vector<IndexPair> joined_already = joined_pairs(body.springs);
  body.springs.reserve(body.springs.size() + pairs.size());
  MeanMaterials materials(body.materials);
  for (const auto& [a, b] : pairs) {
    if (std::binary_search(joined_already.begin(), joined_already.end(), IndexPair(std::minmax(a, b)))) continue;
    const Mass &mass_a = body.masses[a], &mass_b = body.masses[b];
    body.springs.push_back(
        {a, b, norm(mass_a.rest - mass_b.rest), materials.index_between(mass_a.material, mass_b.material)});
  }
  for (auto& [name, numbers] : blueprint.spring_memory) numbers.resize(body.springs.size(), 0.0);
}

/// Returns the leader of each mass's piece. A piece is a set of masses that springs connect directly or indirectly; its
/// leader is the mass of lowest index.
std::vector<std::uint32_t> pieces(const Body& body) {
  std::vector<std::uint32_t> leader(body.masses.size());
  std::iota(leader.begin(), leader.end(), 0u);
  const auto find = [&](std::uint32_t i) {
    while (leader[i] != i) i = leader[i] = leader[leader[i]];
    return i;
  };
  std::size_t count = leader.size();
  for (const Spring& spring : body.springs) {
    if (leader[spring.a] == leader[spring.b]) continue;  // most masses know the leader of their piece
    const auto [low, high] = std::minmax({find(spring.a), find(spring.b)});
    if (low == high) continue;
    leader[high] = low;
    if (--count == 1) break;  // the other springs join what is one piece already
  }
  for (std::uint32_t i = 0; i < leader.size(); ++i) leader[i] = find(i);
  return leader;
}

/// Returns the leader of the piece with the most masses; if several pieces have equally many masses, returns the lowest
/// of their leaders.
std::uint32_t largest_piece(const std::vector<std::uint32_t>& leader) {
  std::vector<std::uint32_t> size(leader.size(), 0);
  for (const std::uint32_t i : leader) ++size[i];
  return static_cast<std::uint32_t>(std::max_element(size.begin(), size.end()) - size.begin());
}

/// Removes all pieces except the largest. Sets the masses of `built` that stay, and counts those in other pieces.
void keep_largest_piece(Blueprint& blueprint, BuiltBody& built) {
  Body& body = blueprint.body;
  const std::vector<std::uint32_t> leader = pieces(body);
  const std::uint32_t largest = largest_piece(leader);
  std::vector<bool> is_joined(body.masses.size(), false);
  for (const Spring& spring : body.springs) is_joined[spring.a] = is_joined[spring.b] = true;
  std::vector<std::uint32_t> new_index(body.masses.size(), 0);
  std::vector<Mass> masses;
  for (std::uint32_t i = 0; i < leader.size(); ++i) {
    if (leader[i] != largest) {
      built.in_other_pieces += is_joined[i];
      continue;
    }
    new_index[i] = static_cast<std::uint32_t>(masses.size());
    built.kept.push_back(i);
    masses.push_back(body.masses[i]);
  }
  erase_springs(blueprint, [&](const Spring& spring) { return leader[spring.a] != largest; });
  for (Spring& spring : body.springs) {
    spring.a = new_index[spring.a];
    spring.b = new_index[spring.b];
  }
  body.masses = std::move(masses);
}

void place_on_origin(Body& body) {
  const std::vector<Vec3> positions = rest_positions(body);
  const Vec3 centre = centre_of_mass(body, positions);
  const Vec3 shift{centre.x, centre.y, bounding_box(positions).low.z};
  for (Mass& mass : body.masses) mass.rest = mass.rest - shift;
}

bool is_finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// Returns the reason why a blueprint cannot become a body, or an empty text if no such reason is known yet.
std::string blueprint_failure(const Blueprint& blueprint) {
  const std::vector<Mass>& masses = blueprint.body.masses;
  if (!blueprint.failure.empty()) return "no body: " + printable(blueprint.failure);
  if (masses.empty()) return "no body: the encoding made no masses";
  if (!std::all_of(masses.begin(), masses.end(), [](const Mass& mass) { return is_finite(mass.rest); }))
    return "no body: the position of a mass is not finite";
  if (!std::all_of(blueprint.paired_at.begin(), blueprint.paired_at.end(), is_finite))
    return "no body: the position at which a mass is paired with its neighbours is not finite";
  return "";
}

/// The positions of the masses for the search of neighbours, m.
std::vector<Vec3> pairing_positions(const Blueprint& blueprint) {
  return blueprint.paired_at.empty() ? rest_positions(blueprint.body) : blueprint.paired_at;
}

/// Returns the identities of the masses that stay: those of the blueprint or, if it has none, their indices in it.
std::vector<std::uint64_t> kept_identities(const std::vector<std::uint32_t>& kept,
                                           const std::vector<std::uint64_t>& identities) {
  std::vector<std::uint64_t> of_kept;
  for (const std::uint32_t i : kept) of_kept.push_back(identities.empty() ? i : identities[i]);
  return of_kept;
}

/// Completes the body of a blueprint whose neighbours have been joined.
BuiltBody finish(Blueprint blueprint) {
  if (std::string failure = blueprint_failure(blueprint); !failure.empty()) return {.failure = std::move(failure)};
  Body& body = blueprint.body;
  leave_out_air(blueprint);
  if (body.springs.empty()) return {.failure = "no springs"};
  BuiltBody built;
  keep_largest_piece(blueprint, built);
  if (!has_extent(rest_positions(body))) return {.failure = "no extent"};
  for (Spring& spring : body.springs) spring.first_length = spring.rest_length;
  place_on_origin(body);
  keep_memory(built.kept, blueprint.mass_memory);
  built.identities = kept_identities(built.kept, blueprint.identities);
  built.body = std::move(body);
  built.mass_memory = std::move(blueprint.mass_memory);
  built.spring_memory = std::move(blueprint.spring_memory);
  return built;
}

/// Returns the first spring that joins a pair of masses which an earlier spring already joins. Groups the springs by
/// their lower mass and marks their upper masses; sorting all springs would take several times as long.
std::optional<std::size_t> doubled_spring(const Body& body) {
  constexpr auto nobody = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::size_t> first(body.masses.size() + 1, 0);  // where the springs of a lower mass start in `by_mass`
  const auto lower = [](const Spring& spring) { return std::min(spring.a, spring.b); };
  for (const Spring& spring : body.springs) ++first[lower(spring) + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::uint32_t> by_mass(body.springs.size()), mark(body.masses.size(), nobody);
  for (std::uint32_t i = 0; i < body.springs.size(); ++i) by_mass[first[lower(body.springs[i])]++] = i;
  std::optional<std::size_t> twin;
  for (const std::uint32_t i : by_mass) {
    const Spring& spring = body.springs[i];
    const std::uint32_t last = std::exchange(mark[std::max(spring.a, spring.b)], lower(spring));
    if (last == lower(spring) && (!twin || i < *twin)) twin = i;
  }
  return twin;
}

/// Throws if two masses have the same identity.
void check_identities(const Blueprint& blueprint) {
  std::vector<std::pair<std::uint64_t, std::size_t>> known;
  for (const std::uint64_t identity : blueprint.identities) known.emplace_back(identity, known.size());
  std::ranges::sort(known);
  const auto twin = std::ranges::adjacent_find(known, {}, &std::pair<std::uint64_t, std::size_t>::first);
  if (twin != known.end())
    throw std::invalid_argument("masses " + std::to_string(twin->second) + " and " +
                                std::to_string(std::next(twin)->second) + " both have the identity " +
                                std::to_string(twin->first) + "; expected different identities");
}

/// Throws unless a memory has a finite number for each of `count` items under every name. `item` is "mass" or "spring".
void check_memory(const MemoryByName& memory, const std::string& item, std::size_t count) {
  for (const auto& [name, numbers] : memory) {
    const std::string place = item + "_memory[\"" + printable(name) + "\"]";
    if (numbers.size() != count)
      throw std::invalid_argument(place + " has " + std::to_string(numbers.size()) + " numbers for " +
                                  std::to_string(count) + (item == "mass" ? " masses" : " springs") +
                                  "; expected one for each");
    for (std::size_t i = 0; i < count; ++i)
      if (!std::isfinite(numbers[i]))
        throw std::invalid_argument(place + " of " + item + " " + std::to_string(i) + " is " + to_text(numbers[i]) +
                                    "; expected a finite number");
  }
}

/// Throws unless the encoding declares the names of what springs remember.
void check_spring_memory(const Blueprint& blueprint, const std::vector<std::string>& names) {
  check_memory(blueprint.spring_memory, "spring", blueprint.body.springs.size());
  for (const auto& [name, numbers] : blueprint.spring_memory)
    if (std::ranges::find(names, name) == names.end())
      throw std::invalid_argument("spring_memory[\"" + printable(name) +
                                  "\"] is not declared; name it in Encoding::spring_memory()");
}

/// Throws, naming an item of the blueprint and its fault, unless `holds`.
void require(bool holds, const char* what, std::size_t index, const std::string& fault) {
  if (!holds) throw std::invalid_argument(std::string(what) + " " + std::to_string(index) + " " + fault);
}

void require_below(std::int64_t count, std::int64_t number, const char* what, std::size_t index, const char* has,
                   const char* counted) {
  if (number >= count)
    throw std::invalid_argument(std::string(what) + " " + std::to_string(index) + " " + has + " " +
                                std::to_string(number) + ", but there are only " + std::to_string(count) + " " +
                                counted + ", numbered from 0");
}

void check_springs(const Body& body) {
  const auto materials = static_cast<std::int64_t>(body.materials.size()),
             masses = static_cast<std::int64_t>(body.masses.size());
  for (std::size_t i = 0; i < body.springs.size(); ++i) {
    const Spring& spring = body.springs[i];
    require_below(masses, std::max(spring.a, spring.b), "spring", i, "joins mass", "masses");
    require(spring.a != spring.b, "spring", i, "joins a mass to itself");
    require(spring.rest_length >= 0 && std::isfinite(spring.rest_length), "spring", i,
            "has a rest length that is not finite or is below 0");
    require_below(materials, spring.material, "spring", i, "has material", "materials");
    require(spring.stiffness_factor > 0 && std::isfinite(body.stiffness(spring)), "spring", i,
            "has a stiffness_factor that is not above 0, or a stiffness that is not finite");
  }
}

}  // namespace

std::vector<Vec3> rest_positions(const Body& body) {
  std::vector<Vec3> positions;
  positions.reserve(body.masses.size());
  for (const Mass& mass : body.masses) positions.push_back(mass.rest);
  return positions;
}

bool has_extent(std::span<const Vec3> positions) {
  constexpr double rounding = 1e-6;  // m; the length of a smaller body cannot serve as a unit of distance
  return !(bounding_box(positions).longest_side() < rounding);
}

void check_blueprint(const Blueprint& blueprint, const EncodingContext& context,
                     const std::vector<std::string>& names) {
  const Body& body = blueprint.body;
  const auto materials = static_cast<std::int64_t>(body.materials.size());
  for (std::size_t i = 0; i < context.materials.size(); ++i)
    require(i < body.materials.size() && body.materials[i] == context.materials[i], "material", i,
            "is not that of the encoding context");
  for (std::size_t i = context.materials.size(); i < body.materials.size(); ++i)
    require(body.materials[i].amplitude >= 0 && body.materials[i].amplitude <= largest_amplitude, "material", i,
            "has an amplitude that is not from 0 to " + to_text(largest_amplitude));
  for (std::size_t i = 0; i < body.masses.size(); ++i) {
    const Mass& mass = body.masses[i];
    require(mass.mass > 0 && std::isfinite(mass.mass), "mass", i, "has a mass that is not finite or not above 0 kg");
    require(mass.material >= no_material, "mass", i, "has a negative material");
    require_below(materials, mass.material, "mass", i, "has material", "materials");
    require(blueprint.neighbours == 0 || mass.material != no_material, "mass", i,
            "has no material, which the springs to its neighbours would have; give it one, or set neighbours = 0");
  }
  check_springs(body);
  if (const std::optional<std::size_t> twin = blueprint.parallel ? std::nullopt : doubled_spring(body)) {
    const Spring& spring = body.springs[*twin];
    throw std::invalid_argument("spring " + std::to_string(*twin) + " joins masses " + std::to_string(spring.a) +
                                " and " + std::to_string(spring.b) + ", which are joined already");
  }
  const auto require_one_for_each_mass = [&](const auto& list, const char* what) {
    if (!list.empty() && list.size() != body.masses.size())
      throw std::invalid_argument(std::to_string(list.size()) + " " + what + " for " +
                                  std::to_string(body.masses.size()) + " masses; expected one for each mass, or none");
  };
  require_one_for_each_mass(blueprint.paired_at, "positions to pair at");
  require_one_for_each_mass(blueprint.origins, "origins");
  require_one_for_each_mass(blueprint.identities, "identities");
  check_identities(blueprint);
  check_memory(blueprint.mass_memory, "mass", body.masses.size());
  check_spring_memory(blueprint, names);
}

void complete(const Encoding& encoding, const EncodingContext& context, Blueprint& blueprint) {
  const std::size_t masses = blueprint.body.masses.size(), springs = blueprint.body.springs.size();
  encoding.joined(blueprint);
  if (!blueprint.failure.empty()) return;
  const Body& body = blueprint.body;
  if (body.masses.size() != masses || body.springs.size() != springs)
    throw std::invalid_argument("joined() leaves " + std::to_string(body.masses.size()) + " masses and " +
                                std::to_string(body.springs.size()) + " springs of " + std::to_string(masses) +
                                " and " + std::to_string(springs) + "; expected the same ones");
  check_blueprint(blueprint, context, encoding.spring_memory());
}

BuiltBody build_body(Blueprint blueprint, const AfterJoining& after_joining) {
  if (std::string failure = blueprint_failure(blueprint); !failure.empty()) return {.failure = std::move(failure)};
  join(blueprint, nearest_pairs(pairing_positions(blueprint), blueprint.neighbours));
  if (blueprint.neighbours > 0 && after_joining) after_joining(0, blueprint);
  return finish(std::move(blueprint));
}

std::vector<BuiltBody> build_bodies(std::vector<Blueprint> blueprints, NeighbourSearch& search, Workers& workers,
                                    const AfterJoining& after_joining) {
  std::vector<BuiltBody> built(blueprints.size());
  std::vector<std::vector<Vec3>> positions(blueprints.size());
  workers.for_each(blueprints.size(), [&](std::size_t i) {
    built[i].failure = blueprint_failure(blueprints[i]);
    if (built[i].failure.empty()) positions[i] = pairing_positions(blueprints[i]);
  });
  std::vector<PointCloud> clouds;
  for (std::size_t i = 0; i < blueprints.size(); ++i) clouds.push_back({positions[i], blueprints[i].neighbours});
  search.find(clouds, workers, [&](std::size_t i, std::span<const IndexPair> pairs) {
    if (!built[i].failure.empty()) return;
    join(blueprints[i], pairs);
    if (blueprints[i].neighbours > 0 && after_joining) after_joining(i, blueprints[i]);
    built[i] = finish(std::move(blueprints[i]));
  });
  return built;
}

void add_payload(Body& body, double share, double top) {
  const Box box = bounding_box(rest_positions(body));
  const double lowest = box.high.z - top * (box.high.z - box.low.z);
  double own = 0;
  std::vector<Mass*> carriers;
  for (Mass& mass : body.masses) {
    own += mass.mass;
    if (mass.mass > 0 && mass.rest.z >= lowest) carriers.push_back(&mass);
  }
  for (Mass* mass : carriers) {
    mass->payload = share * own / static_cast<double>(carriers.size());
    mass->mass += mass->payload;
  }
  place_on_origin(body);
}

std::vector<std::uint32_t> loose_masses(const Body& body) {
  const std::vector<std::uint32_t> leader = pieces(body);
  const std::uint32_t largest = largest_piece(leader);
  std::vector<std::uint32_t> loose;
  for (std::uint32_t i = 0; i < leader.size(); ++i)
    if (leader[i] != largest) loose.push_back(i);
  return loose;
}

}  // namespace evodevo
