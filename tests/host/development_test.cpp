// What development does to a body: the effects of edits, and those that are refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
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

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
