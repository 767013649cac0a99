// A snapshot of a life, for tests of devo operators.
#pragma once

#include <cmath>
#include <set>
#include <tuple>
#include <utility>

#include "life/edits.hpp"
#include "support.hpp"

namespace evodevo::test {

/// A living body, and the other values from which a DevoContext is made.
struct Life {
  LivingBody living;
  double time = 3.3;
  Box bounds = {{-2, -2, 0}, {2, 2, 2}};
  double mass = 0.35;  // differs from the mass of each of the body's masses
  bool resets = false;
  int application = 3, applications = 100;
  Genome genome;
  Layout layout;

  DevoContext context() const {
    DevoContext context{living.body, living.state, 3,    100,    application, applications,
                        time,        bounds,       mass, resets, genome,      layout};
    show_records(living, {.stress = true, .peak_force = true, .muscle_work = true, .tension = true}, context);
    return context;
  }

  void add_mass(Vec3 rest, std::int32_t material) {
    living.body.masses.push_back({rest, 0.2, material, 0});
    // its current position differs from its rest position
    living.state.position.push_back(1.25 * rest);
    living.state.velocity.push_back({});
  }
  void add_spring(std::uint32_t a, std::uint32_t b, std::uint32_t material, double stress) {
    const double length = norm(living.body.masses[a].rest - living.body.masses[b].rest);
    living.body.springs.push_back({a, b, length, material, 1, length});
    living.stress.push_back(stress);
  }
};

/// A life of `masses` masses at random positions; the masses cycle through the world's materials.
inline Life life_of_masses(std::uint32_t masses, bool with_materials = true) {
  Life life;
  life.living.body.materials = context().materials;
  Rng rng = stream(99);
  for (std::uint32_t i = 0; i < masses; ++i)
    life.add_mass({rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(0, 1)},
                  with_materials ? static_cast<std::int32_t>(i % 5) : no_material);
  return life;
}

/// Two chains of three masses each, far from each other. The springs of the first have stress 3 N, those of the second
/// 1 N.
inline Life two_chains() {
  Life life = life_of_masses(6, false);
  for (std::uint32_t i = 0; i < 6; ++i) life.living.state.position[i] = {i < 3 ? 0.0 : 100.0, double(i), 1.0};
  for (const auto& [a, b, stress] : {std::tuple{0u, 1u, 3.0}, {1u, 2u, 3.0}, {3u, 4u, 1.0}, {4u, 5u, 1.0}})
    life.add_spring(a, b, bone, stress);
  return life;
}

using Pair = std::pair<std::uint32_t, std::uint32_t>;
inline Pair ordered(std::uint32_t a, std::uint32_t b) { return std::minmax(a, b); }

/// Returns the pairs of masses that springs join.
inline std::set<Pair> joined(const Body& body) {
  std::set<Pair> pairs;
  for (const Spring& spring : body.springs) pairs.insert(ordered(spring.a, spring.b));
  return pairs;
}

inline Edits develop(const Devo& devo, const Life& life, std::uint64_t seed) {
  Edits edits;
  Rng rng = stream(seed);
  devo.develop(life.context(), edits, rng);
  return edits;
}

/// Returns all values of the edits in one list, for comparisons.
inline std::vector<double> digest(const Edits& edits) {
  std::vector<double> digest(edits.removed_springs.begin(), edits.removed_springs.end());
  if (edits.growth) digest.insert(digest.end(), {edits.growth->from, edits.growth->to, edits.growth->whole});
  digest.insert(digest.end(), edits.removed_masses.begin(), edits.removed_masses.end());
  for (const NewMass& m : edits.new_masses)
    digest.insert(digest.end(), {m.position.x, m.position.y, m.position.z, m.mass, static_cast<double>(m.material)});
  for (const NewSpring& s : edits.new_springs)
    digest.insert(digest.end(), {double(s.a), double(s.b), s.material.stiffness, s.material.phase});
  for (const ChangedSpring& c : edits.changed_springs)
    digest.insert(digest.end(), {double(c.spring), c.rest_length.value_or(-1),
                                 c.material.value_or(Material{}).stiffness, c.material.value_or(Material{}).amplitude});
  return digest;
}

/// Applies the edits with the host's checks; returns the changed body.
inline LivingBody after(const Life& life, const Edits& edits) {
  Life changed = life;
  apply(resolved(edits, changed.context()), changed.living);
  return changed.living;
}

}  // namespace evodevo::test
