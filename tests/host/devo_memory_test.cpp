// What devo operators remember about masses and springs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "evolution/breeding.hpp"
#include "evolution/evolution.hpp"
#include "support/messages.hpp"
#include "support/scratch.hpp"
#include "support/told.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using testing::add_mass;
using testing::all_of_masses;
using ::testing::ElementsAre;
using testing::error_of;
using testing::matured;
using testing::naming;
using testing::numbers_of;
using testing::simulator_for;
using testing::Told;
using testing::unwatched;
using testing::with;

/// What tells a mass or a spring apart throughout its life: rest positions, which never change.
std::vector<double> signs_of_mass(const Body& body, std::size_t mass) {
  const Vec3& rest = body.masses[mass].rest;
  return {rest.x, rest.y, rest.z + 1};  // no new mass has a sign of zeros
}

std::vector<double> signs_of_spring(const Body& body, std::size_t spring) {
  const Vec3 sign = body.masses[body.springs[spring].a].rest + 10.0 * body.masses[body.springs[spring].b].rest;
  return {sign.x, sign.y, sign.z + 1};
}

/// What became of the items of a body.
struct Fates {
  int known = 0, unknown = 0;
};

/// Checks that every item is either remembered by its own signs or, if it is new, by zeros.
template <class Signs>
Fates fates(const Body& body, const Memory& memory, std::size_t items, const Signs& signs) {
  EXPECT_EQ(memory.size(), items);
  EXPECT_EQ(memory.width(), 3u);
  Fates fates;
  for (std::size_t i = 0; i < std::min(items, memory.size()); ++i) {
    const std::vector<double> values = numbers_of(memory[i]);
    if (values == std::vector<double>{0, 0, 0}) {
      ++fates.unknown;
    } else {
      EXPECT_EQ(values, signs(body, i)) << i;
      ++fates.known;
    }
  }
  return fates;
}

/// An operator that remembers the signs of all masses and springs from cycle 1 on. In that cycle, it also removes a
/// spring and adds a mass, whose signs it remembers, but not those of the new springs.
Told witness(std::vector<std::pair<Fates, Fates>>& seen) {
  Told told({}, [&](const DevoContext& context, Edits& edits) {
    const Body& body = context.body;
    seen.emplace_back(fates(body, context.mass_memory, body.masses.size(), signs_of_mass),
                      fates(body, context.spring_memory, body.springs.size(), signs_of_spring));
    if (context.cycle != 1) return;
    edits.removed_springs = {0};
    add_mass(context, edits);
    const auto remember_signs = [](std::vector<double>& memory, const std::vector<double>& signs) {
      memory.insert(memory.end(), signs.begin(), signs.end());
    };
    for (std::size_t i = 0; i < body.masses.size(); ++i) remember_signs(edits.mass_memory, signs_of_mass(body, i));
    const Vec3 rest = edits.new_masses.front().position;
    remember_signs(edits.mass_memory, {rest.x, rest.y, rest.z + 1});
    for (std::size_t i = 0; i < body.springs.size(); ++i) remember_signs(edits.spring_memory, signs_of_spring(body, i));
    for (int i = 0; i < 2; ++i) remember_signs(edits.spring_memory, {0, 0, 0});
  });
  told.of_masses = {"x", "y", "z"};
  told.of_springs = {"x", "y", "z"};
  return told;
}

/// An operator without memory that removes and adds a mass, and tears off another one.
Told another() {
  return Told({}, [](const DevoContext& context, Edits& edits) {
    edits.removed_masses = {5};
    add_mass(context, edits);
    const auto last = static_cast<std::uint32_t>(11);  // at birth, the last corner
    for (std::uint32_t s = 0; s < context.body.springs.size(); ++s)
      if (context.cycle == 1 && (context.body.springs[s].a == last || context.body.springs[s].b == last))
        edits.removed_springs.push_back(s);
  });
}

TEST(DevoMemory, FollowsAllThatComesAndGoes) {
  for (const char* control : {"off", "shuffled-stress", "random-places"}) {
    SCOPED_TRACE(control);
    std::vector<std::pair<Fates, Fates>> seen;
    Told stranger({}, [](const DevoContext& context, Edits&) {
      for (std::size_t i = 0; i < context.mass_memory.size(); ++i) EXPECT_EQ(context.mass_memory[i][0], 0);
      EXPECT_EQ(context.spring_memory.size(), 0u);
    });
    stranger.of_masses = {"x"};
    matured(with({witness(seen), another(), stranger},
                 {{"development.control", control, "--set"}, {"development.cycles", "3", ""}}));
    ASSERT_EQ(seen.size(), 3u);
    const auto masses = [&](std::size_t cycle) {
      return std::pair(seen[cycle].first.known, seen[cycle].first.unknown);
    };
    EXPECT_EQ(masses(0), std::pair(0, 12)) << "at birth";
    EXPECT_EQ(masses(1), std::pair(11, 1)) << "one came with its signs, one went, one was torn off, one came without";
    EXPECT_EQ(masses(2), std::pair(10, 2));
    EXPECT_EQ(seen[1].second.unknown, 4) << "springs of the two new masses";
    EXPECT_GT(seen[1].second.known, 20);
    EXPECT_EQ(seen[2].second.unknown, 6);
  }
}

TEST(DevoMemory, AloneIsNoChangeOfTheBody) {
  std::vector<std::vector<double>> seen;
  Told told({}, [&](const DevoContext& context, Edits& edits) {
    seen.push_back(numbers_of(context.mass_memory[2]));
    edits.mass_memory.assign(2 * context.body.masses.size(), context.cycle);
  });
  told.of_masses = {"one", "two"};
  const Life life = matured(with({told}));
  EXPECT_THAT(seen, ElementsAre(ElementsAre(0, 0), ElementsAre(1, 1)));
  EXPECT_TRUE(life.result.record.empty());
}

TEST(DevoMemory, FaultsAreNamed) {
  const auto fault = [](const std::function<void(const DevoContext&, Edits&)>& act) {
    Told told({}, act);
    told.of_masses = {"one", "two"};
    told.of_springs = {"three"};
    return error_of(with({told}));
  };
  EXPECT_THAT(fault([](const DevoContext& context, Edits& edits) {
                add_mass(context, edits);
                edits.mass_memory.assign(24, 0.0);
              }),
              naming("devo operator", "cycle 1", "24", "Edits::mass_memory", "12 masses", "26"));
  EXPECT_THAT(fault([](const DevoContext& context, Edits& edits) {
                add_mass(context, edits);
                edits.spring_memory.assign(50, 0.0);
              }),
              naming("devo operator", "50", "Edits::spring_memory", "50 springs", "52"));
  EXPECT_THAT(fault([](const DevoContext&, Edits& edits) {
                edits.mass_memory.assign(24, 0.0);
                edits.mass_memory[7] = std::numeric_limits<double>::quiet_NaN();
              }),
              naming("\"two\"", "mass 3", "Edits::mass_memory", "not a number", "finite"));
  EXPECT_THAT(fault([](const DevoContext&, Edits& edits) {
                edits.spring_memory.assign(50, 0.0);
                edits.spring_memory[9] = std::numeric_limits<double>::infinity();
              }),
              naming("\"three\"", "spring 9", "Edits::spring_memory", "infinity", "finite"));
  EXPECT_THAT(fault([](const DevoContext& context, Edits&) { static_cast<void>(context.mass_memory[12]); }),
              naming("mass 12", "12"));
  EXPECT_THAT(fault([](const DevoContext& context, Edits&) { static_cast<void>(context.mass_memory[0][2]); }),
              naming("value 2 of 2", "Devo::mass_memory()"));
  EXPECT_THAT(error_of(with({Told({}, [](const DevoContext&, Edits& edits) { edits.mass_memory = {1}; })})),
              naming("1 numbers", "Edits::mass_memory", "expected 0", "mass_memory()"));
  const Told reads({}, [](const DevoContext& context, Edits&) { static_cast<void>(context.spring_memory[0]); });
  EXPECT_THAT(error_of(with({reads})), naming("each spring", "Devo::spring_memory()", "nothing"));
}

TEST(DevoMemory, NamesMustDiffer) {
  Told told({}, [](const DevoContext&, Edits&) {});
  told.of_springs = {"one", "two", "one"};
  EXPECT_THAT(error_of(with({told})), naming("devo operator", "spring_memory()", "\"one\" twice"));
  told.of_springs = {};
  told.of_masses = {""};
  EXPECT_THAT(error_of(with({told})), naming("devo operator", "mass_memory()", "\"\"", "not empty"));
}

/// An encoding of a row of masses, the first of which is loose, and of what they remember.
struct Row final : Encoding {
  MemoryByName memory;

  explicit Row(MemoryByName given) : memory(std::move(given)) {}
  Layout layout(const EncodingContext&) const override { return {}; }
  Blueprint decode(const Genome&, const Layout&, const EncodingContext& context) const override {
    Blueprint blueprint;
    blueprint.body.materials = context.materials;
    for (int i = 0; i < 4; ++i) blueprint.body.masses.push_back({{0.5 * i, 0, 0}, 0.2, 1, 0});
    blueprint.body.springs = {{1, 2, 0.5, 1}, {2, 3, 0.5, 1}};
    blueprint.mass_memory = memory;
    return blueprint;
  }
};

TEST(DevoMemory, BeginsWithWhatTheEncodingGivesByName) {
  std::vector<std::vector<double>> seen;
  Told told({}, [&](const DevoContext& context, Edits&) {
    for (std::size_t i = 0; i < context.mass_memory.size(); ++i) seen.push_back(numbers_of(context.mass_memory[i]));
  });
  told.of_masses = {"other", "stem"};
  Experiment experiment = with({told}, {{"development.cycles", "1", ""}});
  experiment.encoding = std::make_unique<Row>(MemoryByName{{"stem", {9, 1, 2, 3}}, {"unasked", {8, 8, 8, 8}}});
  matured(experiment);
  EXPECT_THAT(seen, ElementsAre(ElementsAre(0, 1), ElementsAre(0, 2), ElementsAre(0, 3)));

  const auto fault = [&](std::vector<double> numbers) {
    experiment.encoding = std::make_unique<Row>(MemoryByName{{"stem", std::move(numbers)}});
    return error_of(experiment);
  };
  EXPECT_THAT(fault({1, 2, 3}), naming("encoding", "mass_memory[\"stem\"]", "3 numbers", "4 masses"));
  EXPECT_THAT(fault({1, 2, -std::numeric_limits<double>::infinity(), 4}),
              naming("encoding", "mass_memory[\"stem\"]", "mass 2", "-infinity", "finite"));
}

// lives that depend on all of it -------------------------------------------------------------------------------------

/// An operator that adds up what it sees of each mass, and in each cycle replaces the spring with the smallest sum,
/// then remembers in which cycle each spring came.
Told accountant(int* calls = nullptr) {
  Told told(all_of_masses, [calls](const DevoContext& context, Edits& edits) {
    if (calls != nullptr) ++*calls;
    const Body& body = context.body;
    for (std::size_t i = 0; i < body.masses.size(); ++i)
      edits.mass_memory.push_back(context.mass_memory[i][0] + 50 * context.contact[i] + context.age[i] +
                                  context.degree[i] + context.load[i]);
    const auto sum = [&](std::uint32_t s) {
      return edits.mass_memory[body.springs[s].a] + edits.mass_memory[body.springs[s].b] + context.spring_memory[s][0];
    };
    std::uint32_t least = 0;
    for (std::uint32_t s = 0; s < body.springs.size(); ++s)
      if (sum(s) < sum(least)) least = s;
    edits.removed_springs = {least};
    add_mass(context, edits);
    edits.mass_memory.push_back(1);
    for (std::size_t s = 0; s < body.springs.size(); ++s) edits.spring_memory.push_back(context.spring_memory[s][0]);
    edits.spring_memory.insert(edits.spring_memory.end(), 2, context.cycle);
  });
  told.of_masses = {"sum"};
  told.of_springs = {"came"};
  return told;
}

const std::vector<Override> four_cycles = {{"development.cycles", "4", ""}, {"encoding.size", "[2, 2, 2]", ""}};

void expect_same_results(const Result& a, const Result& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.objectives, b.objectives);
  EXPECT_TRUE(a.record == b.record);
}

TEST(DevoMemory, LivesDoNotDependOnThreadsOrCompany) {
  const Experiment experiment = with({accountant()}, four_cycles);
  const std::vector<Individual> individuals = breed(experiment, {}, 0, 0, 8);
  std::vector<Newborn> newborns;
  for (const Individual& individual : individuals)
    newborns.push_back({individual.id, individual.born, &individual.genome});
  const auto one = simulator_for(experiment, 1), three = simulator_for(experiment, 3);
  const std::vector<Result> together = Evaluation(experiment, *three).evaluate(newborns, unwatched);
  std::size_t changed = 0;
  for (std::size_t i = 0; i < together.size(); ++i) {
    changed += !together[i].record.empty();
    expect_same_results(Evaluation(experiment, *one).evaluate(std::span(newborns).subspan(i, 1), unwatched).front(),
                        together[i]);
  }
  EXPECT_GT(changed, 3u);
}

TEST(DevoMemory, ALifeFromItsRecordIsTheSameAndCallsNobody) {
  int calls = 0;
  const Experiment experiment = with({accountant(&calls)}, {{"development.cycles", "4", ""}});
  const Life lived = matured(experiment);
  EXPECT_EQ(calls, 4);
  const Life again = matured(experiment, lived.result.record);
  EXPECT_EQ(calls, 4);
  EXPECT_EQ(again.living.state.position, lived.living.state.position);
  EXPECT_EQ(again.living.state.velocity, lived.living.state.velocity);
  EXPECT_EQ(again.living.state.start_energy, lived.living.state.start_energy);
  EXPECT_EQ(again.result.record, lived.result.record);
  ASSERT_EQ(again.living.body.springs.size(), lived.living.body.springs.size());
  for (std::size_t s = 0; s < lived.living.body.springs.size(); ++s) {
    EXPECT_EQ(again.living.body.springs[s].a, lived.living.body.springs[s].a);
    EXPECT_EQ(again.living.body.springs[s].b, lived.living.body.springs[s].b);
    EXPECT_EQ(again.living.body.springs[s].rest_length, lived.living.body.springs[s].rest_length);
  }
}

TEST(DevoMemory, AResumedRunGivesTheSameRows) {
  const Experiment experiment = with({accountant()}, four_cycles);
  const testing::Scratch scratch;
  const auto evolve_to = [&](Archive& archive, std::size_t generations) {
    std::atomic<bool> stop = false;
    Observer observer;
    observer.generation_done = [&](const Summary& summary) { stop = summary.generation + 1 >= generations; };
    evolve(experiment, *simulator_for(experiment), archive, stop, observer);
  };
  Archive straight = Archive::create(scratch / "straight", experiment, "test");
  evolve_to(straight, 4);
  {
    Archive stopped = Archive::create(scratch / "stopped", experiment, "test");
    evolve_to(stopped, 2);
  }
  Archive resumed = Archive::resume(scratch / "stopped");
  evolve_to(resumed, 4);
  for (std::uint32_t id = 0; id < 24; ++id) {
    SCOPED_TRACE(id);
    const auto a = straight.individual(id), b = resumed.individual(id);
    ASSERT_TRUE(a.has_value());
    ASSERT_TRUE(b.has_value());
    EXPECT_EQ(a->genome, b->genome);
    EXPECT_EQ(a->result.objectives, b->result.objectives);
    EXPECT_EQ(straight.life(id), resumed.life(id));
  }
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
