// What development does to a body: the effects of edits, those that are refused, and what devo operators remember about
// masses and springs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <ranges>

#include "base/philox.hpp"
#include "life/edits.hpp"
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
const Material muscle{5000, 0.14, 1, 0};

/// A chain of four masses on a line, 1 m apart; mass i moves at i m/s.
struct Line {
  LivingBody living;
  Genome genome;
  Layout layout;

  Line() {
    for (int i = 0; i < 4; ++i) {
      living.body.masses.push_back({{static_cast<double>(i), 0, 0}, 0.2, 0, 0});
      living.state.position.push_back({static_cast<double>(i), 0, 5});
      living.state.velocity.push_back({0, 0, static_cast<double>(i)});
    }
    living.body.materials = {bone};
    for (std::uint32_t i = 0; i < 3; ++i) {
      living.body.springs.push_back({i, i + 1, 1, 0});
      living.stress.push_back(10.0 * (i + 1));
    }
  }

  DevoContext context(bool resets = false) const {
    return {living.body, living.state, 1, 2, 1, 2, 0.25, {}, 0.2, resets, genome, layout};
  }

  void apply(const Edits& edits, bool resets = false) { evodevo::apply(resolved(edits, context(resets)), living); }

  std::string refusal(const Edits& edits) {
    return testing::refusal<std::invalid_argument>([&] { apply(edits); });
  }
};

TEST(Records, AreThereOnlyIfRequested) {
  Line line;
  DevoContext context = line.context();
  show_records(line.living, {.stress = true}, context);
  EXPECT_EQ(context.stress.size(), 3u);
  EXPECT_EQ(context.stress[1], 20);
  EXPECT_THAT([&] { static_cast<void>(context.stress[3]); },
              ::testing::ThrowsMessage<std::out_of_range>(naming("\"stress\"", "3")));
  const auto told = [](const RequestedRecord& record) {
    return testing::refusal<std::logic_error>([&] { static_cast<void>(record.size()); });
  };
  EXPECT_EQ(told(context.stress), "no refusal");
  EXPECT_THAT(told(context.peak_force), naming("\"peak_force\"", "RecordRequest::peak_force"));
  EXPECT_THAT(told(context.muscle_work), naming("\"muscle_work\"", "RecordRequest::muscle_work"));
  EXPECT_THAT(told(context.tension), naming("\"tension\"", "RecordRequest::tension"));
  EXPECT_THROW(static_cast<void>(context.tension[0]), std::logic_error);
  EXPECT_THROW(static_cast<void>(context.tension.begin()), std::logic_error);
}

TEST(Development, ALoadComesOnOthersWhenItsCarrierGoes) {
  Line line;
  for (const std::size_t carrier : {2u, 3u})
    line.living.body.masses[carrier].payload = 1, line.living.body.masses[carrier].mass += 1;
  line.apply({.removed_masses = {3}, .new_masses = {{{0, 0, 7}, 0.5, 0}}});
  const std::vector<Mass>& masses = line.living.body.masses;
  ASSERT_EQ(masses.size(), 4u);
  EXPECT_EQ(masses[2].payload, 2);
  EXPECT_DOUBLE_EQ(masses[2].mass, 2.2);
  EXPECT_EQ(masses[0].mass, 0.2);
  EXPECT_EQ(masses[3].mass, 0.5);
  line.apply({.removed_masses = {2}});
  ASSERT_EQ(masses.size(), 3u);
  for (const Mass& mass : masses) EXPECT_DOUBLE_EQ(mass.payload, 2.0 / 3) << "nobody is left who carries one";
  EXPECT_DOUBLE_EQ(masses[2].mass, 0.5 + 2.0 / 3);
}

/// Which masses the springs of a body join.
std::vector<std::pair<std::uint32_t, std::uint32_t>> joined(const LivingBody& living) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const Spring& spring : living.body.springs) pairs.emplace_back(spring.a, spring.b);
  return pairs;
}

TEST(Development, ASpringGoesAndOneComes) {
  Line line;
  line.apply({.removed_springs = {1}, .new_springs = {{0, 3, muscle, std::nullopt}}});
  const Body& body = line.living.body;
  ASSERT_THAT(joined(line.living), ElementsAre(std::pair(0, 1), std::pair(2, 3), std::pair(0, 3)));
  EXPECT_EQ(body.materials.at(body.springs[2].material), muscle);
  // the new spring starts without force: L(t) = 3 m at t = 0.25 s, when a muscle of 1 Hz is longest
  EXPECT_NEAR(body.springs[2].rest_length, 3 / 1.14, 1e-12);
  EXPECT_THAT(line.living.stress, ElementsAre(10, 30, 20)) << "a new spring has the mean of the others";
}

TEST(Development, ANewSpringHasTheLengthThatIsGivenOrWithResetThatBetweenRestPlaces) {
  Line line;
  line.living.state.position[3] = {100, 0, 0};
  line.apply({.new_springs = {{0, 3, muscle, std::nullopt}, {0, 2, bone, 0.5}}}, true);
  EXPECT_EQ(line.living.body.springs[3].rest_length, 3);
  EXPECT_EQ(line.living.body.springs[4].rest_length, 0.5);
}

TEST(Development, AMassGoesWithItsSpringsAndOneComes) {
  Line line;
  line.apply({.removed_masses = {1},
              .new_masses = {{{9, 0, 1}, 0.3, 0}},
              .new_springs = {{4, 3, bone, std::nullopt}, {0, 2, bone, std::nullopt}}});
  const LivingBody& living = line.living;
  ASSERT_EQ(living.body.masses.size(), 4u);
  EXPECT_EQ(living.body.masses[3].mass, 0.3);
  EXPECT_EQ(living.body.masses[3].rest, (Vec3{9, 0, 1}));
  EXPECT_EQ(living.state.position[3], (Vec3{9, 0, 1}));
  EXPECT_EQ(living.state.velocity[3], (Vec3{0, 0, 0})) << "it starts at rest";
  EXPECT_EQ(living.state.velocity[1], (Vec3{0, 0, 2})) << "the others keep their motion";
  ASSERT_THAT(joined(living), ElementsAre(std::pair(1, 2), std::pair(3, 2), std::pair(0, 1)))
      << "old mass 2 is mass 1 now";
  EXPECT_NEAR(living.body.springs[1].rest_length, norm(Vec3{6, 0, -4}), 1e-12);
}

TEST(Development, ASpringChangesWhereItIs) {
  Line line;
  line.living.body.springs[1].growth = 1.5f;
  line.living.body.springs[1].first_length = 0.9;
  line.apply({.removed_springs = {0},
              .changed_springs = {{.spring = 1, .rest_length = 0.5}, {.spring = 2, .material = muscle}},
              .new_springs = {{0, 3, bone, 3.0}}});
  const LivingBody& living = line.living;
  ASSERT_EQ(living.body.springs.size(), 3u);
  EXPECT_EQ(living.body.springs[0].rest_length, 0.5);
  EXPECT_EQ(living.body.springs[0].growth, 1.5f) << "what encodings set stays";
  EXPECT_EQ(living.body.springs[0].first_length, 0.9) << "so does where it began";
  EXPECT_EQ(living.body.springs[2].first_length, 3) << "where the new one begins";
  EXPECT_EQ(living.body.materials.at(living.body.springs[0].material), bone);
  EXPECT_EQ(living.body.springs[1].rest_length, 1);
  EXPECT_EQ(living.body.materials.at(living.body.springs[1].material), muscle);
  EXPECT_THAT(living.stress, ElementsAre(20, 30, 25));
}

TEST(Development, ASpringKeepsItsStiffnessFactorUntilItGetsAnotherOne) {
  Line line;
  const auto factor = [&](std::size_t spring) { return line.living.body.springs[spring].stiffness_factor; };
  line.apply({.changed_springs = {{.spring = 0, .stiffness_factor = 1.5}, {.spring = 1, .stiffness_factor = 0.5}}});
  EXPECT_EQ(line.living.body.stiffness(line.living.body.springs[0]), 1.5 * bone.stiffness);
  EXPECT_THAT(line.living.body.materials, ::testing::SizeIs(1));
  line.apply({.changed_springs = {{.spring = 0, .rest_length = 0.5}, {.spring = 1, .material = muscle}}});
  EXPECT_EQ(factor(0), 1.5);
  EXPECT_EQ(factor(1), 0.5);
  EXPECT_EQ(line.living.body.stiffness(line.living.body.springs[1]), 0.5 * muscle.stiffness);
  line.apply({.removed_springs = {0},
              .changed_springs = {{.spring = 1, .material = bone, .stiffness_factor = 0.25}},
              .new_springs = {{0, 3, bone, 3.0}, {1, 3, bone, 3.0, 0.75}}});
  EXPECT_EQ(factor(0), 0.25);
  EXPECT_EQ(factor(2), 1) << "a new spring has the stiffness of its material";
  EXPECT_EQ(factor(3), 0.75);
}

TEST(Development, AllSpringsGrowByAPartOfTheirWay) {
  Line line;
  line.living.body.springs[0].growth = 1.5f;
  line.living.body.springs[1].growth = 0.25f;
  line.living.body.springs[1].rest_length = 0.8;
  line.living.body.springs[2].growth = 3;
  const Growth growth{1, 3, 4};
  line.apply(
      {.growth = growth, .changed_springs = {{.spring = 2, .rest_length = 0.5}}, .new_springs = {{0, 3, bone, 3.0}}});
  const std::vector<Spring>& springs = line.living.body.springs;
  ASSERT_EQ(springs.size(), 4u);
  EXPECT_DOUBLE_EQ(springs[0].rest_length, 1.375 / 1.125);
  EXPECT_DOUBLE_EQ(springs[1].rest_length, 0.8 * 0.4375 / 0.8125) << "by a factor, whatever its length was";
  EXPECT_EQ(springs[2].rest_length, 0.5) << "a length that is given holds";
  EXPECT_EQ(springs[3].rest_length, 3) << "a new spring does not grow";
  EXPECT_EQ(springs[0].growth, 1.5f);
  line.apply({.growth = Growth{3, 1, 4}});
  EXPECT_DOUBLE_EQ(springs[0].rest_length, 1) << "back again";
  EXPECT_THAT(line.living.stress, ElementsAre(10, 20, 30, 20));
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();

/// Checks what the refusal of edits of the line names.
template <class... Parts>
void expect_refused(const Edits& edits, const Parts&... parts) {
  EXPECT_THAT(Line().refusal(edits), naming(parts...));
}

TEST(Development, FaultyRemovalsAndNewMassesAreRefused) {
  expect_refused({.removed_springs = {3}}, "removes spring 3", "only 3");
  expect_refused({.removed_masses = {4}}, "removes mass 4", "only 4");
  expect_refused({.removed_springs = {0, 1}, .causes = {.removed_springs = {5}}}, "1 ", "2 removed springs");
  for (const auto& [list, what] :
       {std::pair{&Causes::removed_masses, "0 removed masses"},
        std::pair{&Causes::changed_springs, "0 changed springs"}, std::pair{&Causes::new_masses, "0 new masses"},
        std::pair{&Causes::new_springs, "0 new springs"}}) {
    Edits edits{.removed_springs = {0}};
    edits.causes.*list = {5};
    expect_refused(edits, "1 ", what);
  }
  expect_refused({.new_masses = {{{nan, 0, 0}, 0.2, 0}}}, "adds a mass", "position", "not finite");
  expect_refused({.new_masses = {{{}, -nan, 0}}}, "adds a mass", "not a number", "above 0 kg");
  expect_refused({.new_masses = {{{}, 0.2, 1}}}, "adds a mass", "material 1", "1 materials");
}

TEST(Development, FaultyNewSpringsAreRefused) {
  static_assert(!std::is_convertible_v<std::uint32_t, decltype(NewSpring::material)>, "an index is no stiffness");
  const auto join = [](std::uint32_t a, std::uint32_t b) { return NewSpring{a, b, bone, std::nullopt}; };
  expect_refused({.new_springs = {join(0, 4)}}, "masses 0 and 4", "no mass 4");
  expect_refused({.removed_masses = {2}, .new_springs = {join(0, 2)}}, "masses 0 and 2", "mass 2");
  expect_refused({.new_springs = {join(2, 2)}}, "masses 2 and 2");
  expect_refused({.new_springs = {join(1, 0)}}, "masses 1 and 0", "joined already");
  expect_refused({.new_springs = {join(0, 2), join(2, 0)}}, "masses 2 and 0", "joined already");
  EXPECT_EQ(Line().refusal({.removed_springs = {0}, .new_springs = {join(0, 1)}}), "no refusal");
  expect_refused({.new_springs = {{0, 2, bone, nan}}}, "masses 0 and 2", "rest length is not a number", "at least 0");
  const auto of = [](const Material& material) { return Edits{.new_springs = {{0, 2, material, std::nullopt}}}; };
  expect_refused(of({}), "masses 0 and 2", "stiffness is 0;", "above 0");
  expect_refused(of({-1e-9, 0, 0, 0}), "masses 0 and 2", "stiffness is -1e-09", "above 0");
  expect_refused(of({1, 1, 0, 0}), "masses 0 and 2", "amplitude is 1;", "0 to 0.9");
  expect_refused(of({1, 0, 0, nan}), "masses 0 and 2", "frequency or phase", "not finite");
  expect_refused(of({1, 0, nan, 0}), "masses 0 and 2", "frequency or phase", "not finite");
  for (const double damping : {-0.1, nan, infinity})
    expect_refused(of({1, 0, 0, 0, damping}), "masses 0 and 2", "damping", "at least 0");
  EXPECT_EQ(Line().refusal(of({1, 0, 0, 0, 0.5})), "no refusal");
}

TEST(Development, FaultyGrowthIsRefused) {
  const auto grow = [](double from, double to, double whole) { return Edits{.growth = Growth{from, to, whole}}; };
  EXPECT_EQ(Line().refusal(grow(0, 1, 1)), "no refusal");
  expect_refused(grow(0, 2, 1), "0 to 2 of", "1;");
  expect_refused(grow(-1, 0, 3), "-1 to 0 of", "3;");
  expect_refused(grow(nan, 1, 1), "not a number to 1 of", "1;");
  expect_refused(grow(0, 0, 0), "0 to 0 of", "0;");
  Line shrunk;  // to zero length, since 1 + (growth - 1) rounds to 0
  shrunk.living.body.springs[1].growth = 1e-30f;
  EXPECT_EQ(shrunk.refusal(grow(0, 1, 1)), "no refusal");
  EXPECT_THAT(shrunk.refusal(grow(1, 1, 1)), naming("rest length", "not a number"));
}

TEST(Development, FaultyChangesOfSpringsAreRefused) {
  const auto change = [](std::uint32_t spring) { return ChangedSpring{.spring = spring, .rest_length = 2.0}; };
  expect_refused({.changed_springs = {change(3)}}, "spring 3", "only 3");
  expect_refused({.changed_springs = {change(1), change(1)}}, "spring 1", "twice");
  expect_refused({.removed_springs = {1}, .changed_springs = {change(1)}}, "spring 1", "remove");
  expect_refused({.removed_masses = {1}, .changed_springs = {change(1)}}, "spring 1", "remove");
  const auto changed = [](const ChangedSpring& one) { return Edits{.changed_springs = {one}}; };
  expect_refused(changed({.spring = 1, .rest_length = -1.0}), "spring 1", "rest length is -1;", "at least 0");
  expect_refused(changed({.spring = 1, .material = Material{}}), "spring 1", "stiffness is 0;", "above 0");
  for (const double factor : {0.0, -1.0, nan, infinity, 1e308}) {
    expect_refused(changed({.spring = 1, .stiffness_factor = factor}), "spring 1", "times the stiffness", "above 0");
    expect_refused({.new_springs = {{0, 3, bone, 3.0, factor}}}, "masses 0 and 3", "times the stiffness", "above 0");
  }
}

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
    edits.mass_memory.assign(2 * context.body.masses.size(), context.cycle);
  });
  told.of_masses = {"one", "two"};
  const Experiment experiment = with({told});
  const Life life = matured(experiment);
  EXPECT_THAT(seen, ElementsAre(ElementsAre(0, 0), ElementsAre(1, 1)));
  EXPECT_TRUE(life.record.empty());
  matured(experiment, {life.record});
  EXPECT_THAT(seen, ::testing::SizeIs(2));
}

TEST(DevoMemory, FaultsAreNamed) {
  const auto fault = [](const std::function<void(const DevoContext&, Edits&)>& act) {
    Told told({}, act);
    told.of_masses = {"one", "two"};
    told.of_springs = {"three"};
    return error_of(with({told}));
  };
  const auto remembering = [&](auto Edits::*memory, std::size_t size, std::size_t at, double value, bool adds = false) {
    return fault([=](const DevoContext& context, Edits& edits) {
      if (adds) add_mass(context, edits);
      (edits.*memory).assign(size, 0.0);
      (edits.*memory)[at] = value;
    });
  };
  EXPECT_THAT(remembering(&Edits::mass_memory, 24, 0, 0, true),
              naming("devo operator", "cycle 1", "24", "Edits::mass_memory", "12 masses", "26"));
  EXPECT_THAT(remembering(&Edits::spring_memory, 50, 0, 0, true),
              naming("devo operator", "50", "Edits::spring_memory", "50 springs", "52"));
  EXPECT_THAT(remembering(&Edits::mass_memory, 24, 7, nan),
              naming("\"two\"", "mass 3", "Edits::mass_memory", "not a number", "finite"));
  EXPECT_THAT(remembering(&Edits::spring_memory, 50, 9, infinity),
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
std::unique_ptr<Encoding> row(MemoryByName memory) {
  Blueprint blueprint{.body = {.springs = {{1, 2, 0.5, 1}, {2, 3, 0.5, 1}}}, .mass_memory = std::move(memory)};
  for (int i = 0; i < 4; ++i) blueprint.body.masses.push_back({{0.5 * i, 0, 0}, 0.2, 1, 0});
  return std::make_unique<testing::GivenBlueprint>(std::move(blueprint));
}

TEST(DevoMemory, BeginsWithWhatTheEncodingGivesByName) {
  std::vector<std::vector<double>> seen;
  Told told({}, [&](const DevoContext& context, Edits&) {
    for (std::size_t i = 0; i < context.mass_memory.size(); ++i) seen.push_back(numbers_of(context.mass_memory[i]));
  });
  told.of_masses = {"other", "stem"};
  Experiment experiment = with({told}, {{"development.cycles", "1", ""}});
  experiment.encoding = row({{"stem", {9, 1, 2, 3}}, {"unasked", {8, 8, 8, 8}}});
  matured(experiment);
  EXPECT_THAT(seen, ElementsAre(ElementsAre(0, 1), ElementsAre(0, 2), ElementsAre(0, 3)));

  const auto fault = [&](std::vector<double> numbers) {
    experiment.encoding = row({{"stem", std::move(numbers)}});
    return error_of(experiment);
  };
  EXPECT_THAT(fault({1, 2, 3}), naming("encoding", "mass_memory[\"stem\"]", "3 numbers", "4 masses"));
  EXPECT_THAT(fault({1, 2, -infinity, 4}),
              naming("encoding", "mass_memory[\"stem\"]", "mass 2", "-infinity", "finite"));
}

// lives that depend on all of it -------------------------------------------------------------------------------------

/// An operator that adds up what it sees of each mass, and in each cycle replaces the spring with the smallest sum,
/// then remembers in which cycle each spring came.
Told accountant() {
  Told told(testing::all_of_masses, [](const DevoContext& context, Edits& edits) {
    const Body& body = context.body;
    for (std::size_t i = 0; i < body.masses.size(); ++i)
      edits.mass_memory.push_back(context.mass_memory[i][0] + 50 * context.contact[i] + context.age[i] +
                                  context.degree[i] + context.load[i]);
    const auto sum = [&](std::uint32_t s) {
      return edits.mass_memory[body.springs[s].a] + edits.mass_memory[body.springs[s].b] + context.spring_memory[s][0];
    };
    const auto springs = std::views::iota(0u, static_cast<std::uint32_t>(body.springs.size()));
    edits.removed_springs = {*std::ranges::min_element(springs, {}, sum)};
    add_mass(context, edits);
    edits.mass_memory.push_back(1);
    for (const std::uint32_t s : springs) edits.spring_memory.push_back(context.spring_memory[s][0]);
    edits.spring_memory.insert(edits.spring_memory.end(), 2, context.cycle);
  });
  told.of_masses = {"sum"};
  told.of_springs = {"came"};
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
