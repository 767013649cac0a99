// What development does to a body: the effects of edits, those that are refused, and what devo operators remember about
// masses and springs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <limits>
#include <ranges>

#include "base/philox.hpp"
#include "life/edits.hpp"
#include "support/edits.hpp"
#include "support/lives.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"
#include "support/told.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using testing::add_mass;
using testing::causes;
using ::testing::ElementsAre;
using testing::error_of;
using testing::indices;
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

  /// Lets an operator remember the number x about each spring.
  void remember(std::vector<double> x) { living.memory = {{.springs = {1, std::move(x)}}}; }

  DevoContext context(bool resets = false) const {
    return {living.body, living.state, 1, 2, 1, 2, 0.25, {}, 0.2, resets, genome, layout};
  }

  /// Applies the edits of the operator with index 0.
  void apply(const std::function<void(Edits&)>& edit, bool resets = false) {
    Edits edits(living.body);
    edit(edits);
    evodevo::apply(resolved(edits, context(resets)), living, 0);
  }

  std::string refusal(const std::function<void(Edits&)>& edit) {
    return testing::refusal<std::invalid_argument>([&] { apply(edit); });
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
  line.apply([](Edits& edits) {
    edits.remove_mass(3);
    edits.add_mass({0, 0, 7}, {.mass = 0.5, .material = 0});
  });
  const std::vector<Mass>& masses = line.living.body.masses;
  ASSERT_EQ(masses.size(), 4u);
  EXPECT_EQ(masses[2].payload, 2);
  EXPECT_DOUBLE_EQ(masses[2].mass, 2.2);
  EXPECT_EQ(masses[0].mass, 0.2);
  EXPECT_EQ(masses[3].mass, 0.5);
  line.apply([](Edits& edits) { edits.remove_mass(2); });
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
  line.apply([](Edits& edits) {
    edits.remove_spring(1);
    edits.join(0, 3, muscle);
  });
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
  line.apply(
      [](Edits& edits) {
        edits.join(0, 3, muscle);
        edits.join(0, 2, bone, {.rest_length = 0.5});
      },
      true);
  EXPECT_EQ(line.living.body.springs[3].rest_length, 3);
  EXPECT_EQ(line.living.body.springs[4].rest_length, 0.5);
}

TEST(Development, AMassGoesWithItsSpringsAndOneComes) {
  Line line;
  line.apply([](Edits& edits) {
    edits.remove_mass(1);
    const std::uint32_t newest = edits.add_mass({9, 0, 1}, {.mass = 0.3, .material = 0});
    edits.join(newest, 3, bone);
    edits.join(0, 2, bone);
  });
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

template <class Made>
concept IsMaterial = requires(Edits edits, Made made) {
  edits.join(0, 1, made);
};
static_assert(IsMaterial<Material>);
static_assert(!IsMaterial<std::uint32_t> && !IsMaterial<double>, "an index is no material, and no stiffness");

TEST(Development, NewMassesAndSpringsHaveTheNextIndicesWhichLaterEditsMayUse) {
  for (const bool by_numbers : {false, true}) {
    Line line;
    line.living.memory = {{.masses = {1, {1, 2, 3, 4}}, .springs = {2, {1, 10, 2, 20, 3, 30}}}};
    Edits edits = by_numbers ? Edits(4, 3) : Edits(line.living.body);
    EXPECT_EQ(edits.add_mass({9, 0, 1}), 4u);
    EXPECT_EQ(edits.join(3, 4, bone), 3u);
    EXPECT_EQ(edits.divide(2, {8, 0, 1}, {.mass = 0.7}), 5u);
    EXPECT_EQ(edits.join(4, 5, muscle, {.rest_length = 0.25, .stiffness_factor = 2}), 4u);
    EXPECT_EQ(edits.join(5, 2, bone), 5u);
    edits.remove_mass(0);  // indices are those of before
    edits.remember_mass(5, {6});
    edits.remember_spring(4, {5, 50});
    edits.remember_spring(1, std::vector<double>{-2, -20});
    remember(edits, {{"m"}, {"s", "t"}, {}}, line.living.body, line.living.memory[0]);
    evodevo::apply(resolved(edits, line.context()), line.living, 0);
    EXPECT_THAT(joined(line.living),
                ElementsAre(std::pair(0, 1), std::pair(1, 2), std::pair(2, 3), std::pair(3, 4), std::pair(4, 1)));
    const std::vector<Mass>& masses = line.living.body.masses;
    ASSERT_EQ(masses.size(), 5u);
    EXPECT_EQ(masses[3].mass, 0.2) << "that of the context";
    EXPECT_EQ(masses[3].material, no_material);
    EXPECT_EQ(masses[4].mass, 0.7);
    EXPECT_EQ(masses[4].rest, (Vec3{8, 0, 1}));
    const Spring& own = line.living.body.springs[3];
    EXPECT_EQ(own.rest_length, 0.25);
    EXPECT_EQ(line.living.body.stiffness(own), 2 * muscle.stiffness);
    EXPECT_THAT(line.living.memory[0].masses.values, ElementsAre(2, 3, 4, 0, 6)) << "of the others, the same as before";
    EXPECT_THAT(line.living.memory[0].springs.values, ElementsAre(-2, -20, 3, 30, 0, 0, 5, 50, 0, 0));
  }
}

TEST(Development, WhatIsRemovedTwiceGoesOnceForTheFirstOfItsCauses) {
  Line line;
  Edits edits(line.living.body);
  edits.remove_spring(2, {.cause = 7});
  edits.remove_spring(0);
  edits.remove_spring(2, {.cause = 8});
  edits.remove_mass(3, {.cause = 1});
  edits.remove_mass(3);
  const Edits once = resolved(edits, line.context());
  EXPECT_THAT(indices(once.removed_springs), ElementsAre(0, 2));
  EXPECT_THAT(causes(once.removed_springs), ElementsAre(7));
  EXPECT_THAT(indices(once.removed_masses), ElementsAre(3));
  EXPECT_THAT(causes(once.removed_masses), ElementsAre(1));
  evodevo::apply(once, line.living);
  EXPECT_THAT(joined(line.living), ElementsAre(std::pair(1, 2)));
}

TEST(Development, ASpringChangesWhereItIs) {
  Line line;
  line.remember({7, 1.5, 8});
  line.living.body.springs[1].first_length = 0.9;
  line.apply([](Edits& edits) {
    edits.remove_spring(0);
    edits.change_spring(1, {.rest_length = 0.5});
    edits.change_spring(2, {.material = muscle});
    edits.join(0, 3, bone, {.rest_length = 3.0});
  });
  const LivingBody& living = line.living;
  ASSERT_EQ(living.body.springs.size(), 3u);
  EXPECT_EQ(living.body.springs[0].rest_length, 0.5);
  EXPECT_THAT(living.memory[0].springs.values, ElementsAre(1.5, 8, 0)) << "what is remembered about it stays";
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
  line.apply([](Edits& edits) {
    edits.change_spring(0, {.stiffness_factor = 1.5});
    edits.change_spring(1, {.stiffness_factor = 0.5});
  });
  EXPECT_EQ(line.living.body.stiffness(line.living.body.springs[0]), 1.5 * bone.stiffness);
  EXPECT_THAT(line.living.body.materials, ::testing::SizeIs(1));
  line.apply([](Edits& edits) {
    edits.change_spring(0, {.rest_length = 0.5});
    edits.change_spring(1, {.material = muscle});
  });
  EXPECT_EQ(factor(0), 1.5);
  EXPECT_EQ(factor(1), 0.5);
  EXPECT_EQ(line.living.body.stiffness(line.living.body.springs[1]), 0.5 * muscle.stiffness);
  line.apply([](Edits& edits) {
    edits.remove_spring(0);
    edits.change_spring(1, {.material = bone, .stiffness_factor = 0.25});
    edits.join(0, 3, bone, {.rest_length = 3.0});
    edits.join(1, 3, bone, {.rest_length = 3.0, .stiffness_factor = 0.75});
  });
  EXPECT_EQ(factor(0), 0.25);
  EXPECT_EQ(factor(2), 1) << "a new spring has the stiffness of its material";
  EXPECT_EQ(factor(3), 0.75);
}

TEST(Development, AllRestLengthsGoAPartOfTheirWay) {
  Line line;
  line.living.memory = {{}, {.springs = {2, {9, 0.5, 9, -0.75, 9, 2}}}};  // of the second operator, the second number
  line.living.body.springs[1].rest_length = 0.8;
  const auto scale = [&](double from, double to, const std::function<void(Edits&)>& also = nullptr) {
    Edits edits(line.living.body);
    edits.scale_lengths({.number = 1, .from = from, .to = to, .whole = 4});
    if (also) also(edits);
    evodevo::apply(resolved(edits, line.context()), line.living, 1);
  };
  scale(1, 3, [](Edits& edits) {
    edits.change_spring(2, {.rest_length = 0.5});
    edits.join(0, 3, bone, {.rest_length = 3.0});
  });
  const std::vector<Spring>& springs = line.living.body.springs;
  ASSERT_EQ(springs.size(), 4u);
  EXPECT_DOUBLE_EQ(springs[0].rest_length, 1.375 / 1.125);
  EXPECT_DOUBLE_EQ(springs[1].rest_length, 0.8 * 0.4375 / 0.8125) << "by a factor, whatever its length was";
  EXPECT_EQ(springs[2].rest_length, 0.5) << "a length that is given holds";
  EXPECT_EQ(springs[3].rest_length, 3) << "a new spring is not scaled";
  EXPECT_THAT(line.living.memory[1].springs.values, ElementsAre(9, 0.5, 9, -0.75, 9, 2, 0, 0));
  scale(3, 1);
  EXPECT_DOUBLE_EQ(springs[0].rest_length, 1) << "back again";
  EXPECT_DOUBLE_EQ(springs[2].rest_length, 0.5 * 1.5 / 2.5);
  EXPECT_EQ(springs[3].rest_length, 3) << "it remembers 0";
  EXPECT_THAT(line.living.stress, ElementsAre(10, 20, 30, 20));
}

TEST(Development, AScalingThatIsWrittenOutGivesTheSameBodyToTheBit) {
  Line together, single;
  const std::vector<double> x = {0.1, 0, -1 / 3.0};
  Edits edits(together.living.body);
  edits.scale_lengths({.from = 2, .to = 5, .whole = 7});
  edits.change_spring(0, {.material = muscle});
  edits.join(1, 3, bone, {.rest_length = 2.0});
  for (Line* line : {&together, &single}) line->remember(x);
  Edits written = edits;
  write_out_scaling(written, single.living.body, single.living.memory[0].springs);
  EXPECT_FALSE(written.scaling);
  EXPECT_EQ(written.changed_springs.size(), 2u) << "one of them has another change, one does not change";
  evodevo::apply(resolved(edits, together.context()), together.living, 0);
  single.living.memory.clear();  // which is not needed any more
  evodevo::apply(resolved(written, single.context()), single.living);
  for (std::size_t s = 0; s < 4; ++s)
    EXPECT_EQ(single.living.body.springs[s].rest_length, together.living.body.springs[s].rest_length) << s;
  EXPECT_DOUBLE_EQ(together.living.body.springs[2].rest_length, (1 - 5 / 21.0) / (1 - 2 / 21.0));

  // of springs that go nothing is written, and lengths that are given hold
  Edits others(single.living.body);
  others.scale_lengths({.from = 0, .to = 1});
  others.change_spring(1, {.rest_length = 0.5});
  others.remove_spring(0);
  others.remove_mass(3);
  write_out_scaling(others, single.living.body, {1, {1, 1, 1, 1}});
  ASSERT_EQ(others.changed_springs.size(), 1u);
  EXPECT_EQ(others.changed_springs[0].rest_length, 0.5);
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();

/// Checks what the refusal of edits of the line names.
template <class... Parts>
void expect_refused(const std::function<void(Edits&)>& edit, const Parts&... parts) {
  EXPECT_THAT(Line().refusal(edit), naming(parts...));
}

TEST(Development, FaultyRemovalsAndNewMassesAreRefused) {
  expect_refused([](Edits& edits) { edits.remove_spring(3); }, "removes spring 3", "only 3");
  expect_refused([](Edits& edits) { edits.remove_mass(4); }, "removes mass 4", "only 4");
  /// Adds a sound mass, which is mass 4, and then this one.
  const auto adding = [](Vec3 position, const NewMass& mass) {
    return [=](Edits& edits) {
      edits.add_mass({0, 0, 9});
      edits.add_mass(position, mass);
    };
  };
  EXPECT_EQ(Line().refusal(adding({}, {.material = 0, .mother = 3})), "no refusal");
  expect_refused(adding({nan, 0, 0}, {}), "adds mass 5", "position", "not finite");
  expect_refused(adding({}, {.mass = -nan}), "adds mass 5", "not a number", "above 0 kg");
  for (const double mass : {0.0, -1.0, infinity}) expect_refused(adding({}, {.mass = mass}), "mass 5", "above 0 kg");
  expect_refused(adding({}, {.material = 1}), "adds mass 5", "material 1", "1 materials");
  expect_refused(adding({}, {.material = no_material - 1}), "adds mass 5", "material -2");
  expect_refused([](Edits& edits) { edits.divide(4, {}); }, "adds mass 4", "daughter of mass 4", "does not exist");
}

TEST(Development, FaultyNewSpringsAreRefused) {
  const auto joining = [](const std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs) {
    return [=](Edits& edits) {
      for (const auto& [a, b] : pairs) edits.join(a, b, bone);
    };
  };
  expect_refused(joining({{0, 4}}), "masses 0 and 4", "no mass 4");
  expect_refused(
      [](Edits& edits) {
        edits.remove_mass(2);
        edits.join(0, 2, bone);
      },
      "masses 0 and 2", "mass 2", "removed");
  expect_refused(joining({{2, 2}}), "masses 2 and 2");
  expect_refused(joining({{1, 0}}), "masses 1 and 0", "joined already");
  expect_refused(joining({{0, 2}, {2, 0}}), "masses 2 and 0", "joined already");
  EXPECT_EQ(Line().refusal([](Edits& edits) {
    edits.remove_spring(0);
    edits.join(0, 1, bone);
  }),
            "no refusal");
  const auto of = [](const Material& material, const NewSpring& spring = {}) {
    return [=](Edits& edits) { edits.join(0, 2, material, spring); };
  };
  expect_refused(of(bone, {.rest_length = nan}), "masses 0 and 2", "rest length is not a number", "at least 0");
  expect_refused(of(bone, {.like = 3}), "masses 0 and 2", "like spring 3", "only 3");
  EXPECT_EQ(Line().refusal(of(bone, {.like = 2})), "no refusal");
  expect_refused(of({}), "masses 0 and 2", "stiffness is 0;", "above 0");
  expect_refused(of({-1e-9, 0, 0, 0}), "masses 0 and 2", "stiffness is -1e-09", "above 0");
  expect_refused(of({1, 1, 0, 0}), "masses 0 and 2", "amplitude is 1;", "0 to 0.9");
  expect_refused(of({1, 0, 0, nan}), "masses 0 and 2", "frequency or phase", "not finite");
  expect_refused(of({1, 0, nan, 0}), "masses 0 and 2", "frequency or phase", "not finite");
  for (const double damping : {-0.1, nan, infinity})
    expect_refused(of({1, 0, 0, 0, damping}), "masses 0 and 2", "damping", "at least 0");
  EXPECT_EQ(Line().refusal(of({1, 0, 0, 0, 0.5})), "no refusal");
}

TEST(Development, FaultyScalingsAreRefused) {
  const auto scaling = [](double from, double to, double whole) {
    return [=](Edits& edits) { edits.scale_lengths({.from = from, .to = to, .whole = whole}); };
  };
  const auto refusal = [&](std::vector<double> x, const std::function<void(Edits&)>& edit) {
    Line line;
    line.remember(std::move(x));
    const std::string at_once = line.refusal(edit);
    Edits written(line.living.body);
    edit(written);
    EXPECT_EQ(testing::refusal<std::invalid_argument>(
                  [&] { write_out_scaling(written, Line().living.body, line.living.memory[0].springs); }),
              at_once);
    return at_once;
  };
  const std::vector<double> some = {1, 2, 3};
  EXPECT_EQ(refusal(some, scaling(0, 1, 1)), "no refusal");
  EXPECT_THAT(refusal(some, scaling(0, 2, 1)), naming("0 to 2 of", "1;"));
  EXPECT_THAT(refusal(some, scaling(-1, 0, 3)), naming("-1 to 0 of", "3;"));
  EXPECT_THAT(refusal(some, scaling(nan, 1, 1)), naming("not a number to 1 of", "1;"));
  EXPECT_THAT(refusal(some, scaling(0, 0, 0)), naming("0 to 0 of", "0;"));
  EXPECT_THAT(refusal(some, scaling(0, 1, infinity)), naming("0 to 1 of", "infinity;"));
  EXPECT_THAT(refusal(some, [](Edits& edits) { edits.scale_lengths({.number = 1, .to = 1}); }),
              naming("number 1", "spring_memory()", "only 1"));
  expect_refused(scaling(0, 1, 1), "number 0", "spring_memory()", "only 0");
  EXPECT_EQ(refusal({0, -1, 0}, scaling(0, 1, 1)), "no refusal") << "to zero length";
  EXPECT_THAT(refusal({0, -1, 0}, scaling(1, 1, 1)), naming("spring 1", "rest length", "not a number"));
  EXPECT_THAT(refusal({0, 0, -3}, scaling(0, 1, 1)), naming("spring 2", "rest length of -2;", "at least 0"));
  const auto with_removal = [](Edits& edits) {
    edits.scale_lengths({.to = 1});
    edits.remove_spring(2);
  };
  EXPECT_EQ(refusal({0, 0, -3}, with_removal), "no refusal") << "of a spring that goes";
}

TEST(Development, FaultyChangesOfSpringsAreRefused) {
  const auto change = [](std::uint32_t spring) {
    return [=](Edits& edits) { edits.change_spring(spring, {.rest_length = 2.0}); };
  };
  expect_refused(change(3), "spring 3", "only 3");
  expect_refused([&](Edits& edits) { change(1)(edits), change(1)(edits); }, "spring 1", "twice");
  expect_refused([&](Edits& edits) { edits.remove_spring(1), change(1)(edits); }, "spring 1", "remove");
  expect_refused([&](Edits& edits) { edits.remove_mass(1), change(1)(edits); }, "spring 1", "remove");
  const auto changed = [](const ChangedSpring& one) { return [=](Edits& edits) { edits.change_spring(1, one); }; };
  expect_refused(changed({.rest_length = -1.0}), "spring 1", "rest length is -1;", "at least 0");
  expect_refused(changed({.material = Material{}}), "spring 1", "stiffness is 0;", "above 0");
  for (const double factor : {0.0, -1.0, nan, infinity, 1e308}) {
    expect_refused(changed({.stiffness_factor = factor}), "spring 1", "times the stiffness", "above 0");
    expect_refused([=](Edits& edits) { edits.join(0, 3, bone, {.rest_length = 3.0, .stiffness_factor = factor}); },
                   "masses 0 and 3", "times the stiffness", "above 0");
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
