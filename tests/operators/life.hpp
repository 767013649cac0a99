// A snapshot of a life, for tests of devo operators.
#pragma once

#include <cmath>
#include <initializer_list>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "life/edits.hpp"
#include "support.hpp"
#include "support/edits.hpp"

namespace evodevo::test {

using testing::causes;
using testing::indices;
using testing::remembered;

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
  std::size_t op = 0;                              ///< index of the operator into `living.memory`
  std::uint64_t draw_seed = 0;

  /// What the operator remembers. The number of values for each item is that of the operator that develops the life.
  OperatorMemory& memory() {
    if (living.memory.size() <= op) living.memory.resize(op + 1);
    return living.memory[op];
  }
  std::vector<double>& mass_memory() { return memory().masses.values; }
  std::vector<double>& spring_memory() { return memory().springs.values; }

  DevoContext context() const {
    DevoContext context{living.body, living.state, 3,      100,    application, applications, time,
                        bounds,      mass,         resets, genome, layout,      own};
    show_records(living, {.stress = true, .peak_force = true, .muscle_work = true, .tension = true}, context);
    context.contact.show(contact);
    context.age.show(age);
    context.degree.show(degree);
    context.load.show(load);
    if (op < living.memory.size()) {
      context.mass_memory = living.memory[op].masses.view("mass");
      context.spring_memory = living.memory[op].springs.view("spring");
      context.body_memory = {living.memory[op].body, "body"};
    }
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
    remember_as_many({devo.mass_memory(), devo.spring_memory(), devo.body_memory()});
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

  /// Lets the operator remember a number for each of these names, which is 0 unless it is given.
  void remember_as_many(const MemoryNames& names) {
    const auto resize = [](ItemMemory& of_items, std::size_t width, std::size_t items) {
      of_items.width = width;
      of_items.values.resize(width * items);
    };
    resize(memory().masses, names.masses.size(), living.body.masses.size());
    resize(memory().springs, names.springs.size(), living.body.springs.size());
    memory().body.resize(names.body.size());
  }

  void add_mass(Vec3 rest, std::int32_t material) {
    living.body.masses.push_back({rest, 0.2, material, 0});
    // its current position differs from its rest position
    living.state.position.push_back(1.25 * rest);
    living.state.velocity.push_back({});
  }
  void add_spring(std::uint32_t a, std::uint32_t b, std::uint32_t material, double stress) {
    const double length = norm(living.body.masses[a].rest - living.body.masses[b].rest);
    living.body.springs.push_back({a, b, length, material, length});
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
  Edits edits(life.living.body);
  Rng rng = stream(seed);
  devo.develop(life.context(), edits, rng);
  return edits;
}

/// Returns all values of the edits in one list, for comparisons.
inline std::vector<double> digest(const Edits& edits) {
  std::vector<double> digest;
  const auto append = [&](std::initializer_list<double> values) { digest.insert(digest.end(), values); };
  const auto cause = [](const auto& edit) { return std::isnan(edit.cause) ? -1e300 : edit.cause; };
  for (const std::vector<Removal>* removals : {&edits.removed_springs, &edits.removed_masses})
    for (const Removal& removal : *removals) append({double(removal.index), cause(removal)});
  if (const auto& s = edits.scaling) append({double(s->number), s->from, s->to, s->whole});
  for (const NewMass& m : edits.new_masses)
    append({m.position.x, m.position.y, m.position.z, m.mass.value_or(-1), double(m.material),
            m.mother ? double(*m.mother) : -1.0, cause(m)});
  for (const NewSpring& s : edits.new_springs)
    append({double(s.a), double(s.b), s.material.stiffness, s.material.phase, s.stiffness_factor,
            s.like ? double(*s.like) : -1.0, cause(s)});
  for (const ChangedSpring& c : edits.changed_springs)
    append({double(c.spring), c.rest_length.value_or(-1), c.stiffness_factor.value_or(-1),
            c.material.value_or(Material{}).stiffness, c.material.value_or(Material{}).amplitude, cause(c)});
  for (const MemoryEdits* memory : {&edits.mass_memory, &edits.spring_memory}) {
    digest.insert(digest.end(), memory->items.begin(), memory->items.end());
    digest.insert(digest.end(), memory->values.begin(), memory->values.end());
  }
  if (edits.body_memory) digest.insert(digest.end(), edits.body_memory->begin(), edits.body_memory->end());
  return digest;
}

/// Applies the edits with the host's checks; returns the changed body, with what the operator remembers from now on.
inline LivingBody after(const Life& life, const Edits& edits) {
  Life changed = life;
  const auto names = [](const MemoryEdits& given, const ItemMemory& memory, std::size_t items) {
    const std::size_t before = items > 0 ? memory.values.size() / items : memory.width;
    return std::vector<std::string>(given.counts.empty() ? before : given.counts.front(), "name");
  };
  const Body& body = changed.living.body;
  OperatorMemory& memory = changed.memory();
  const MemoryNames all{names(edits.mass_memory, memory.masses, body.masses.size()),
                        names(edits.spring_memory, memory.springs, body.springs.size()),
                        std::vector<std::string>(edits.body_memory ? edits.body_memory->size() : memory.body.size())};
  changed.remember_as_many(all);
  remember(edits, all, body, memory);
  apply(resolved(edits, changed.context()), changed.living, static_cast<std::uint32_t>(changed.op));
  return changed.living;
}

}  // namespace evodevo::test
