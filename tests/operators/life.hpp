// A snapshot of a life, for tests of devo operators.
#pragma once

#include <cmath>
#include <set>
#include <tuple>
#include <utility>

#include "life/edits.hpp"
#include "support.hpp"

namespace evodevo::test {

/// Whether draws are inherited in the lives of the test that runs; see TEST_BOTH_DRAWS.
inline bool draws_are_inherited = false;

/// A test that is made with draws of the individual, and again with inherited draws.
#define TEST_BOTH_DRAWS(suite, name)                                    \
  static void suite##name();                                            \
  TEST(suite, name) {                                                   \
    for (const bool inherited : {false, true}) {                        \
      SCOPED_TRACE(inherited ? "inherited draws" : "individual draws"); \
      draws_are_inherited = inherited;                                  \
      suite##name();                                                    \
      draws_are_inherited = false;                                      \
      if (::testing::Test::HasFatalFailure()) return;                   \
    }                                                                   \
  }                                                                     \
  static void suite##name()

/// A living body, and the other values from which a DevoContext is made.
struct Life {
  LivingBody living;
  double time = 3.3;
  Box bounds = {{-2, -2, 0}, {2, 2, 2}};
  double mass = 0.35;  // differs from the mass of each of the body's masses
  bool resets = false;
  int application = 3, applications = 100;
  double first_time = 1.1, last_time = 110;
  Genome genome;
  Layout layout;
  Genome own;                                      ///< genes of the operator
  std::vector<double> contact, age, degree, load;  ///< [masses]
  std::vector<double> mass_memory, spring_memory;  ///< what the operator remembers
  std::size_t mass_width = 0, spring_width = 0;    ///< numbers that it remembers about each mass and each spring
  std::uint64_t draw_seed = 0;

  DevoContext context() const {
    DevoContext context{living.body, living.state, 3,      100,    application, applications, time,
                        bounds,      mass,         resets, genome, layout,      own};
    show_records(living, {.stress = true, .peak_force = true, .muscle_work = true, .tension = true}, context);
    context.contact.show(contact);
    context.age.show(age);
    context.degree.show(degree);
    context.load.show(load);
    context.mass_memory = Memory(mass_memory, mass_width, "mass");
    context.spring_memory = Memory(spring_memory, spring_width, "spring");
    context.first_time = first_time;
    context.last_time = last_time;
    context.identities = living.numbers.identities();
    context.daughters = living.numbers.daughters();
    context.draws = Draws(philox, draw_seed, 1, draws_are_inherited);
    return context;
  }

  /// Adds what the operator needs and the life does not have: random genes, records of the springs and memory of 0, and
  /// records of masses that fit the springs.
  void complete_for(const Devo& devo) {
    const Body& body = living.body;
    if (own.empty()) {
      Rng rng = stream(17);
      own = devo.random(devo.layout(test::context()), rng);
    }
    mass_width = devo.mass_memory().size();
    spring_width = devo.spring_memory().size();
    mass_memory.resize(mass_width * body.masses.size());
    spring_memory.resize(spring_width * body.springs.size());
    living.tension.resize(body.springs.size());
    living.muscle_work.resize(body.springs.size());
    contact.resize(body.masses.size());
    age.resize(body.masses.size());
    degree.assign(body.masses.size(), 0);
    load.assign(body.masses.size(), 0);
    for (std::size_t s = 0; s < body.springs.size(); ++s)
      for (const std::uint32_t end : {body.springs[s].a, body.springs[s].b}) {
        ++degree[end];
        if (s < living.stress.size()) load[end] += living.stress[s];
      }
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

inline Edits develop(const Devo& devo, Life life, std::uint64_t seed) {
  life.complete_for(devo);
  life.draw_seed = mixed(seed, 1);
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
    digest.insert(digest.end(), {double(s.a), double(s.b), s.material.stiffness, s.material.phase, s.stiffness_factor,
                                 s.phase_growth});
  for (const ChangedSpring& c : edits.changed_springs)
    digest.insert(digest.end(), {double(c.spring), c.rest_length.value_or(-1), c.stiffness_factor.value_or(-1),
                                 c.material.value_or(Material{}).stiffness, c.material.value_or(Material{}).amplitude});
  digest.insert(digest.end(), edits.mass_memory.begin(), edits.mass_memory.end());
  digest.insert(digest.end(), edits.spring_memory.begin(), edits.spring_memory.end());
  return digest;
}

/// Applies the edits with the host's checks; returns the changed body.
inline LivingBody after(const Life& life, const Edits& edits) {
  Life changed = life;
  apply(resolved(edits, changed.context()), changed.living);
  return changed.living;
}

}  // namespace evodevo::test
