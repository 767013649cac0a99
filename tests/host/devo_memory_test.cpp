// What devo operators remember about masses, springs and the body, and lives that they give up.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <limits>
#include <ranges>

#include "support/edits.hpp"
#include "support/lives.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"
#include "support/told.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using testing::add_mass;
using ::testing::ElementsAre;
using testing::error_of;
using testing::matured;
using testing::naming;
using testing::numbers_of;
using testing::Told;
using testing::with;

const Material bone{10000, 0, 0, 0};
constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();

/// What tells a mass or a spring apart throughout its life: rest positions, which never change.
std::vector<double> signs_of_mass(const Body& body, std::size_t mass) {
  const Vec3& rest = body.masses[mass].rest;
  return {rest.x, rest.y, rest.z + 1};  // no new mass has a sign of zeros
}

std::vector<double> signs_of_spring(const Body& body, std::size_t spring) {
  const Vec3 sign = body.masses[body.springs[spring].a].rest + 10.0 * body.masses[body.springs[spring].b].rest;
  return {sign.x, sign.y, sign.z + 1};
}

/// Checks that every item is either remembered by its own signs or, if it is new, by zeros. Returns how many are
/// remembered, and how many are not.
template <class Signs>
std::pair<int, int> fates(const Body& body, const Memory& memory, std::size_t items, const Signs& signs) {
  EXPECT_EQ(memory.size(), items);
  EXPECT_EQ(memory.width(), 3u);
  std::pair fates(0, 0);
  for (std::size_t i = 0; i < std::min(items, memory.size()); ++i) {
    const std::vector<double> values = numbers_of(memory[i]);
    const bool is_new = values == std::vector<double>{0, 0, 0};
    if (!is_new) {
      EXPECT_EQ(values, signs(body, i)) << i;
    }
    ++(is_new ? fates.second : fates.first);
  }
  return fates;
}

/// An operator that remembers the signs of all masses and springs from cycle 1 on. In that cycle, it also removes a
/// spring and adds a mass, whose signs it remembers, but not those of the new springs.
Told witness(std::vector<std::pair<int, int>>& masses, std::vector<std::pair<int, int>>& springs) {
  Told told({}, [&](const DevoContext& context, Edits& edits) {
    const Body& body = context.body;
    masses.push_back(fates(body, context.mass_memory, body.masses.size(), signs_of_mass));
    springs.push_back(fates(body, context.spring_memory, body.springs.size(), signs_of_spring));
    if (context.cycle != 1) return;
    edits.remove_spring(0);
    add_mass(context, edits);
    const auto masses_of_body = static_cast<std::uint32_t>(body.masses.size());
    for (std::uint32_t i = 0; i < masses_of_body; ++i) edits.remember_mass(i, signs_of_mass(body, i));
    const Vec3 rest = edits.new_masses.front().position;
    edits.remember_mass(masses_of_body, {rest.x, rest.y, rest.z + 1});
    for (std::uint32_t i = 0; i < body.springs.size(); ++i) edits.remember_spring(i, signs_of_spring(body, i));
  });
  told.of_masses = {"x", "y", "z"};
  told.of_springs = {"x", "y", "z"};
  return told;
}

/// An operator without memory that removes and adds a mass, and tears off another one.
Told another() {
  return Told({}, [](const DevoContext& context, Edits& edits) {
    edits.remove_mass(5);
    add_mass(context, edits);
    const auto last = static_cast<std::uint32_t>(11);  // at birth, the last corner
    for (std::uint32_t s = 0; s < context.body.springs.size(); ++s)
      if (context.cycle == 1 && (context.body.springs[s].a == last || context.body.springs[s].b == last))
        edits.remove_spring(s);
  });
}

TEST(DevoMemory, FollowsAllThatComesAndGoes) {
  for (const char* control : {"off", "shuffled-stress", "random-places"}) {
    SCOPED_TRACE(control);
    std::vector<std::pair<int, int>> masses, springs;
    Told stranger({}, [](const DevoContext& context, Edits&) {
      for (std::size_t i = 0; i < context.mass_memory.size(); ++i) EXPECT_EQ(context.mass_memory[i][0], 0);
      EXPECT_EQ(context.spring_memory.size(), 0u);
    });
    stranger.of_masses = {"x"};
    matured(with({witness(masses, springs), another(), stranger},
                 {{"development.control", control, "--set"}, {"development.cycles", "3", ""}}));
    // at birth none; then one came with its signs, one went, one was torn off, one came without
    EXPECT_THAT(masses, ElementsAre(std::pair(0, 12), std::pair(11, 1), std::pair(10, 2)));
    ASSERT_EQ(springs.size(), 3u);
    EXPECT_EQ(springs[1].second, 4) << "springs of the two new masses";
    EXPECT_GT(springs[1].first, 20);
    EXPECT_EQ(springs[2].second, 6);
  }
}

TEST(DevoMemory, AloneIsNoChangeOfTheBodyAndALifeFromItsRecordCallsNobody) {
  std::vector<std::vector<double>> seen;
  Told told({}, [&](const DevoContext& context, Edits& edits) {
    seen.push_back(numbers_of(context.mass_memory[2]));
    for (std::uint32_t i = 0; i < context.body.masses.size(); ++i)
      edits.remember_mass(i, std::vector<double>(2, context.cycle));
  });
  told.of_masses = {"one", "two"};
  const Experiment experiment = with({told});
  const Life life = matured(experiment);
  EXPECT_THAT(seen, ElementsAre(ElementsAre(0, 0), ElementsAre(1, 1)));
  EXPECT_TRUE(life.record.empty());
  matured(experiment, {life.record});
  EXPECT_THAT(seen, ::testing::SizeIs(2));
}

TEST(DevoMemory, OfItemsThatAreNotNamedStaysAndThatOfTheBodyIsItsOwn) {
  std::vector<std::vector<double>> masses, springs, of_body, of_other;
  Told told({}, [&](const DevoContext& context, Edits& edits) {
    masses.push_back({context.mass_memory[0][0], context.mass_memory[1][0]});
    springs.push_back({context.spring_memory[3][0], context.spring_memory[4][0]});
    of_body.push_back(numbers_of(context.body_memory));
    if (context.cycle == 1) edits.remember_mass(1, {0.1}), edits.remember_spring(3, {0.3});
    if (context.cycle == 2) edits.remember_mass(0, {-5}), edits.remember_mass(0, {5}), edits.remember_spring(4, {0.4});
    if (context.cycle != 3) edits.remember_body({0.1 * context.cycle, of_body.back()[1] + 1});
  });
  told.of_masses = told.of_springs = {"x"};
  told.of_body = {"some", "count"};
  Told other({}, [&](const DevoContext& context, Edits& edits) {
    of_other.push_back(numbers_of(context.body_memory));
    edits.remember_body({-1});
  });
  other.of_body = {"count"};
  matured(with({told, other}, {{"development.cycles", "4", ""}}));
  EXPECT_THAT(masses, ElementsAre(ElementsAre(0, 0), ElementsAre(0, 0.1), ElementsAre(5, 0.1), ElementsAre(5, 0.1)))
      << "the last that is given holds";
  EXPECT_THAT(springs,
              ElementsAre(ElementsAre(0, 0), ElementsAre(0.3, 0), ElementsAre(0.3, 0.4), ElementsAre(0.3, 0.4)));
  EXPECT_THAT(of_body, ElementsAre(ElementsAre(0, 0), ElementsAre(0.1, 1), ElementsAre(0.2, 2), ElementsAre(0.2, 2)));
  EXPECT_THAT(of_other, ElementsAre(ElementsAre(0), ElementsAre(-1), ElementsAre(-1), ElementsAre(-1)));
}

/// An operator that numbers the springs of a body at birth in what it remembers, and stores what it sees in the last
/// cycle about springs that joined these masses.
Told numbering(std::vector<std::string> names, std::vector<std::vector<double>>& last) {
  const std::size_t width = names.size();
  Told told({}, [=, &last](const DevoContext& context, Edits& edits) {
    const auto springs = static_cast<std::uint32_t>(context.body.springs.size());
    std::vector<double> values;
    for (std::uint32_t s = 0; s < springs && context.cycle == 1; ++s) {
      values.clear();
      for (std::size_t i = 0; i < width; ++i) values.push_back(1 + s + static_cast<double>(i) / 10);
      edits.remember_spring(s, values);
    }
    for (std::uint32_t s = springs - 4; s < springs && context.cycle == context.cycles; ++s)
      last.push_back(numbers_of(context.spring_memory[s]));
  });
  told.of_springs = std::move(names);
  return told;
}

TEST(DevoMemory, OfASpringThatIsLikeAnotherOneIsThatOfTheOtherForAllOperators) {
  std::vector<std::vector<double>> first, second;
  Told editor({}, [](const DevoContext& context, Edits& edits) {
    if (context.cycle != 2) return;
    const Body& body = context.body;
    const std::uint32_t newest = edits.add_mass(0.5 * (context.bounds.low + context.bounds.high));
    edits.remove_spring(7);
    for (const std::uint32_t model : {7, 20}) {  // one goes, and one stays
      const std::uint32_t material = body.springs[model].material;
      edits.join(model == 7 ? 0 : 1, newest, body.materials[material], {.like = model});
    }
    edits.join(2, newest, bone);
    edits.remember_spring(edits.join(3, newest, bone, {.like = 7}), {99});
  });
  editor.of_springs = {"mine"};
  const Experiment experiment =
      with({numbering({"one", "two"}, first), editor, numbering({"three"}, second)}, {{"development.cycles", "3", ""}});
  const Life life = matured(experiment);
  const auto two = [](double spring) { return ElementsAre(1 + spring, 1 + spring + 0.1); };
  EXPECT_THAT(first, ElementsAre(two(7), two(20), ElementsAre(0, 0), two(7)));
  EXPECT_THAT(second, ElementsAre(ElementsAre(8), ElementsAre(21), ElementsAre(0), ElementsAre(8)));
  const std::vector<double>& own = life.living.memory.at(1).springs.values;
  EXPECT_THAT(std::vector(own.end() - 4, own.end()), ElementsAre(0, 0, 0, 99)) << "what is given holds";
}

TEST(DevoMemory, FaultsAreNamed) {
  const auto fault = [](const std::function<void(const DevoContext&, Edits&)>& act) {
    Told told({}, act);
    told.of_masses = {"one", "two"};
    told.of_springs = {"three"};
    told.of_body = {"four"};
    return error_of(with({told}));
  };
  const auto told_by = [&](const std::function<void(Edits&)>& act, bool adds = false) {
    return fault([=](const DevoContext& context, Edits& edits) {
      if (adds) add_mass(context, edits);
      act(edits);
    });
  };
  EXPECT_THAT(told_by([](Edits& edits) {
                edits.remember_mass(3, {1, 2, 3});
              }),
              naming("devo operator", "cycle 1", "3 numbers", "mass 3", "expected 2", "mass_memory()"));
  EXPECT_THAT(told_by([](Edits& edits) { edits.remember_mass(12, {1}); }, true),
              naming("1 numbers", "mass 12", "expected 2", "mass_memory()"));
  EXPECT_THAT(told_by([](Edits& edits) { edits.remember_spring(4, {}); }),
              naming("devo operator", "0 numbers", "spring 4", "expected 1", "spring_memory()"));
  EXPECT_THAT(told_by([](Edits& edits) {
                edits.remember_body({1, 2});
              }),
              naming("devo operator", "2 numbers", "the body", "expected 1", "body_memory()"));
  EXPECT_THAT(told_by([](Edits& edits) {
                edits.remember_mass(12, {1, 2});
              }),
              naming("mass 12", "only 12", "numbered from 0"));
  EXPECT_THAT(told_by([](Edits& edits) { edits.remember_mass(13, {1, 2}); }, true), naming("mass 13", "only 13"));
  EXPECT_THAT(told_by([](Edits& edits) { edits.remember_spring(52, {1}); }, true), naming("spring 52", "only 52"));
  EXPECT_THAT(told_by([](Edits& edits) {
                edits.remember_mass(0, {1, 1}), edits.remember_mass(3, {1, nan});
              }),
              naming("\"two\"", "mass 3", "not a number", "finite"));
  EXPECT_THAT(told_by([](Edits& edits) { edits.remember_spring(9, {infinity}); }),
              naming("\"three\"", "spring 9", "infinity", "finite"));
  EXPECT_THAT(told_by([](Edits& edits) { edits.remember_body({-infinity}); }),
              naming("\"four\"", "the body", "-infinity", "finite"));
  EXPECT_THAT(fault([](const DevoContext& context, Edits&) { static_cast<void>(context.mass_memory[12]); }),
              naming("mass 12", "12"));
  EXPECT_THAT(fault([](const DevoContext& context, Edits&) { static_cast<void>(context.mass_memory[0][2]); }),
              naming("value 2 of 2", "Devo::mass_memory()"));
  EXPECT_THAT(fault([](const DevoContext& context, Edits&) { static_cast<void>(context.body_memory[1]); }),
              naming("value 1 of 1", "the body", "Devo::body_memory()"));
  const auto undeclared = [](const std::function<void(const DevoContext&, Edits&)>& act) {
    return error_of(with({Told({}, act)}));
  };
  EXPECT_THAT(undeclared([](const DevoContext&, Edits& edits) { edits.remember_mass(0, {1}); }),
              naming("1 numbers", "mass 0", "expected 0", "mass_memory()"));
  EXPECT_THAT(undeclared([](const DevoContext&, Edits& edits) { edits.remember_body({1}); }),
              naming("1 numbers", "the body", "expected 0", "body_memory()"));
  EXPECT_THAT(undeclared([](const DevoContext& context, Edits&) { static_cast<void>(context.spring_memory[0]); }),
              naming("each spring", "Devo::spring_memory()", "nothing"));
  EXPECT_THAT(undeclared([](const DevoContext& context, Edits&) { static_cast<void>(context.body_memory[0]); }),
              naming("value 0 of 0", "the body", "Devo::body_memory()"));
}

TEST(DevoMemory, NamesMustDiffer) {
  Told told({}, [](const DevoContext&, Edits&) {});
  told.of_springs = {"one", "two", "one"};
  EXPECT_THAT(error_of(with({told})), naming("devo operator", "spring_memory()", "\"one\" twice"));
  told.of_springs = {};
  told.of_masses = {""};
  EXPECT_THAT(error_of(with({told})), naming("devo operator", "mass_memory()", "\"\"", "not empty"));
  told.of_masses = {};
  told.of_body = {"one", "one"};
  EXPECT_THAT(error_of(with({told})), naming("devo operator", "body_memory()", "\"one\" twice"));
  told.of_body = {};
  told.claims = {.needs_at_birth = {"three"}};
  told.of_springs = {"one", "two"};
  EXPECT_THAT(error_of(with({told})), naming("needs_at_birth", "\"three\"", "spring_memory()"));
  testing::GivenBlueprint twice{Blueprint{}};
  twice.blueprint.spring_memory = {{"", {}}};
  EXPECT_THAT(testing::refusal<std::invalid_argument>([&] { spring_memory_names(twice); }),
              naming("spring_memory()", "\"\"", "not empty"));
}

/// An encoding of a row of masses, the first of which is loose, and of what they and their springs remember.
std::unique_ptr<Encoding> row(MemoryByName memory, MemoryByName of_springs = {}) {
  Blueprint blueprint{.body = {.springs = {{1, 2, 0.5, 1}, {2, 3, 0.5, 1}}},
                      .mass_memory = std::move(memory),
                      .spring_memory = std::move(of_springs)};
  for (int i = 0; i < 4; ++i) blueprint.body.masses.push_back({{0.5 * i, 0, 0}, 0.2, 1, 0});
  return std::make_unique<testing::GivenBlueprint>(std::move(blueprint));
}

TEST(DevoMemory, BeginsWithWhatTheEncodingGivesByName) {
  std::vector<std::vector<double>> seen, of_springs;
  Told told({}, [&](const DevoContext& context, Edits&) {
    for (std::size_t i = 0; i < context.mass_memory.size(); ++i) seen.push_back(numbers_of(context.mass_memory[i]));
    for (std::size_t i = 0; i < context.spring_memory.size(); ++i)
      of_springs.push_back(numbers_of(context.spring_memory[i]));
    EXPECT_EQ(context.body_memory[0], 0) << "about the body, an encoding gives nothing";
  });
  told.of_masses = {"other", "stem"};
  told.of_springs = {"growth", "stem"};
  told.of_body = {"stem"};
  Experiment experiment = with({told}, {{"development.cycles", "1", ""}});
  experiment.encoding =
      row({{"stem", {9, 1, 2, 3}}, {"unasked", {8, 8, 8, 8}}}, {{"growth", {0.25, -0.5}}, {"unasked", {7, 7}}});
  matured(experiment);
  EXPECT_THAT(of_springs, ElementsAre(ElementsAre(0.25, 0), ElementsAre(-0.5, 0)));
  EXPECT_THAT(seen, ElementsAre(ElementsAre(0, 1), ElementsAre(0, 2), ElementsAre(0, 3)));

  const auto fault = [&](std::vector<double> numbers) {
    experiment.encoding = row({{"stem", std::move(numbers)}});
    return error_of(experiment);
  };
  EXPECT_THAT(fault({1, 2, 3}), naming("encoding", "mass_memory[\"stem\"]", "3 numbers", "4 masses"));
  EXPECT_THAT(fault({1, 2, -infinity, 4}),
              naming("encoding", "mass_memory[\"stem\"]", "mass 2", "-infinity", "finite"));
  experiment.encoding = row({}, {{"growth", {0.25, -0.5, 1}}});
  EXPECT_THAT(error_of(experiment), naming("encoding", "spring_memory[\"growth\"]", "3 numbers", "2 springs"));
}

// bodies that are given up -------------------------------------------------------------------------------------------

TEST(GivingUp, EndsTheLifeForTheReasonOfTheOperatorAndNobodyElses) {
  std::atomic<int> before = 0, after = 0;  // calls of the operators on either side, for bodies that are given up
  const auto is_doomed = [](const DevoContext& context) { return context.genome[0] < context.genome[1]; };
  const auto experiment_in_which = [&](bool some_give_up) {
    Experiment experiment = with({Told({}, [&](const DevoContext& context, Edits&) { before += is_doomed(context); }),
                                  Told({},
                                       [=](const DevoContext& context, Edits& edits) {
                                         edits.remove_spring(3);
                                         if (some_give_up && context.cycle == 2 && is_doomed(context))
                                           edits.give_up("no leg left\x1b[31m"), edits.remove_spring(9'999);
                                       }),
                                  Told({.stress = true},
                                       [&](const DevoContext& context, Edits& edits) {
                                         after += is_doomed(context);
                                         edits.remove_spring(5);
                                       })},
                                 {{"development.cycles", "3", ""}, {"encoding.materials", "['bone', 'muscle']", ""}});
    experiment.devo[1].label = "surgeon";
    return experiment;
  };
  std::vector<Individual> individuals;
  for (const auto& [a, b] : {std::pair{0.0f, 1.0f}, {1.0f, 1.0f}, {1.0f, 0.0f}, {0.0f, 1.0f}, {0.0f, 0.0f}})
    individuals.push_back({.id = static_cast<std::uint32_t>(individuals.size()), .genome = {a, b}});
  const std::vector<Result> all = testing::expect_independent_lives(experiment_in_which(false), individuals);
  before = after = 0;
  const std::vector<Result> some = testing::expect_independent_lives(experiment_in_which(true), individuals);
  for (std::size_t i = 0; i < individuals.size(); ++i) {
    SCOPED_TRACE(i);
    ASSERT_EQ(all[i].status, Status::ok) << all[i].reason;
    const bool is_given_up = individuals[i].genome[0] < individuals[i].genome[1];
    EXPECT_EQ(some[i].status, is_given_up ? Status::invalid : Status::ok);
    if (is_given_up) {
      EXPECT_THAT(some[i].reason, naming("\"surgeon\"", "cycle 2", "no leg left\\x1b[31m"));
      EXPECT_TRUE(some[i].objectives.empty());
      EXPECT_LT(some[i].spring_evaluations, all[i].spring_evaluations);
      continue;
    }
    EXPECT_EQ(some[i].objectives, all[i].objectives);
    EXPECT_TRUE(some[i].records == all[i].records);
  }
  // two individuals, each together with the others and alone, in two cycles; the last operator in one of them
  EXPECT_EQ(before, 2 * 2 * 2);
  EXPECT_EQ(after, 2 * 2 * 1);
}

TEST(GivingUp, EndsAYokedLifeToo) {
  const Experiment experiment = with({Told({}, [](const DevoContext&, Edits& edits) { edits.give_up(""); })},
                                     {{"development.control", "'random-places'", ""}});
  static const Genome genome = {1, 2};
  const Newborn newborn{0, 0, &genome};
  const Result result = testing::Developed(experiment, {&newborn, 1}, 1).lives.front().result;
  EXPECT_EQ(result.status, Status::invalid);
  EXPECT_THAT(result.reason, naming("\"told\"", "cycle 1"));
}

// lives that depend on all of it -------------------------------------------------------------------------------------

/// An operator that adds up what it sees of each mass, and in each cycle replaces the spring with the smallest sum,
/// then remembers in which cycle each spring came.
Told accountant() {
  Told told(testing::all_of_masses, [](const DevoContext& context, Edits& edits) {
    const Body& body = context.body;
    std::vector<double> sums;
    for (std::uint32_t i = 0; i < body.masses.size(); ++i) {
      sums.push_back(context.mass_memory[i][0] + 50 * context.contact[i] + context.age[i] + context.degree[i] +
                     context.load[i] + context.body_memory[0]);
      edits.remember_mass(i, {sums[i]});
    }
    const auto sum = [&](std::uint32_t s) {
      return sums[body.springs[s].a] + sums[body.springs[s].b] + context.spring_memory[s][0];
    };
    const auto springs = static_cast<std::uint32_t>(body.springs.size());
    edits.remove_spring(*std::ranges::min_element(std::views::iota(0u, springs), {}, sum));
    add_mass(context, edits);
    edits.remember_mass(static_cast<std::uint32_t>(sums.size()), {1});
    for (const std::uint32_t newest : {springs, springs + 1})
      edits.remember_spring(newest, {static_cast<double>(context.cycle)});
    edits.remember_body({sums[0]});
  });
  told.of_masses = {"sum"};
  told.of_springs = {"came"};
  told.of_body = {"first sum"};
  return told;
}

TEST(DevoMemory, LivesDoNotDependOnThreadsOrCompany) {
  const Experiment experiment =
      with({accountant()}, {{"development.cycles", "4", ""}, {"encoding.size", "[2, 2, 2]", ""}});
  const std::vector<Result> results = testing::expect_independent_lives(experiment, breed(experiment, {}, 0, 0, 8));
  EXPECT_GT(std::ranges::count_if(results, [](const Result& result) { return !result.records.at(0).empty(); }), 3);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
