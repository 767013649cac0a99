// The effects of apply_edits on a body, and the edits that it refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "base/philox.hpp"
#include "life/edits.hpp"
#include "support/messages.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using testing::naming;

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
    try {
      apply(edits);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
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
    try {
      static_cast<void>(record.size());
    } catch (const std::logic_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(told(context.stress), "");
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

TEST(Development, ASpringGoesAndOneComes) {
  Line line;
  line.apply({.removed_springs = {1}, .new_springs = {{0, 3, muscle, std::nullopt}}});
  const Body& body = line.living.body;
  ASSERT_EQ(body.springs.size(), 3u);
  EXPECT_EQ(body.springs[1].a, 2u);
  EXPECT_EQ(body.springs[1].b, 3u);
  EXPECT_EQ(body.springs[2].a, 0u);
  EXPECT_EQ(body.springs[2].b, 3u);
  EXPECT_EQ(body.materials.at(body.springs[2].material), muscle);
  // the new spring starts without force: L(t) = 3 m at t = 0.25 s, when a muscle of 1 Hz is longest
  EXPECT_NEAR(body.springs[2].rest_length, 3 / 1.14, 1e-12);
  EXPECT_EQ(line.living.stress, (std::vector<double>{10, 30, 20})) << "a new spring has the mean of the others";
}

TEST(Development, WithResetANewSpringIsAsLongAsTheRestPlacesAreApart) {
  Line line;
  line.living.state.position[3] = {100, 0, 0};
  line.apply({.new_springs = {{0, 3, muscle, std::nullopt}}}, true);
  EXPECT_EQ(line.living.body.springs.back().rest_length, 3);
}

TEST(Development, AGivenRestLengthIsKept) {
  Line line;
  line.apply({.new_springs = {{0, 3, bone, 0.5}}});
  EXPECT_EQ(line.living.body.springs.back().rest_length, 0.5);
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
  ASSERT_EQ(living.body.springs.size(), 3u);
  EXPECT_EQ(living.body.springs[0].a, 1u) << "old mass 2 is mass 1 now";
  EXPECT_EQ(living.body.springs[0].b, 2u);
  EXPECT_EQ(living.body.springs[1].a, 3u);
  EXPECT_EQ(living.body.springs[1].b, 2u);
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
  EXPECT_EQ(living.stress, (std::vector<double>{20, 30, 25}));
}

TEST(Development, ASpringKeepsItsStiffnessFactorUntilItGetsAnotherOne) {
  Line line;
  const auto factor = [&](std::size_t spring) { return line.living.body.springs[spring].stiffness_factor; };
  line.apply({.changed_springs = {{.spring = 0, .stiffness_factor = 1.5}, {.spring = 1, .stiffness_factor = 0.5}}});
  EXPECT_EQ(line.living.body.stiffness(line.living.body.springs[0]), 1.5 * bone.stiffness);
  EXPECT_THAT(line.living.body.materials, ::testing::SizeIs(Line().living.body.materials.size()));
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
  EXPECT_EQ(line.living.stress, (std::vector<double>{10, 20, 30, 20}));
}

TEST(Development, NothingChangesNothing) {
  Line line, same;
  line.apply({});
  EXPECT_EQ(line.living.state.position, same.living.state.position);
  EXPECT_EQ(line.living.stress, same.living.stress);
  EXPECT_EQ(line.living.body.springs.size(), 3u);
}

TEST(Development, FaultyEditsAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto join = [](std::uint32_t a, std::uint32_t b) { return NewSpring{a, b, bone, std::nullopt}; };
  EXPECT_THAT(Line().refusal({.removed_springs = {3}}), naming("removes spring 3", "only 3"));
  EXPECT_THAT(Line().refusal({.removed_masses = {4}}), naming("removes mass 4", "only 4"));
  EXPECT_THAT(Line().refusal({.removed_springs = {0, 1}, .causes = {.removed_springs = {5}}}),
              naming("1 ", "2 removed springs"));
  for (const auto& [list, what] :
       {std::pair{&Causes::removed_masses, "0 removed masses"},
        std::pair{&Causes::changed_springs, "0 changed springs"}, std::pair{&Causes::new_masses, "0 new masses"},
        std::pair{&Causes::new_springs, "0 new springs"}}) {
    Edits edits{.removed_springs = {0}};
    edits.causes.*list = {5};
    EXPECT_THAT(Line().refusal(edits), naming("1 ", what));
  }
  EXPECT_THAT(Line().refusal({.new_springs = {join(0, 4)}}), naming("masses 0 and 4", "no mass 4"));
  EXPECT_THAT(Line().refusal({.removed_masses = {2}, .new_springs = {join(0, 2)}}), naming("masses 0 and 2", "mass 2"));
  EXPECT_THAT(Line().refusal({.new_springs = {join(2, 2)}}), naming("masses 2 and 2"));
  EXPECT_THAT(Line().refusal({.new_springs = {join(1, 0)}}), naming("masses 1 and 0", "joined already"));
  EXPECT_THAT(Line().refusal({.new_springs = {join(0, 2), join(2, 0)}}), naming("masses 2 and 0", "joined already"));
  EXPECT_EQ(Line().refusal({.removed_springs = {0}, .new_springs = {join(0, 1)}}), "accepted");
  EXPECT_THAT(Line().refusal({.new_springs = {{0, 2, Material{}, std::nullopt}}}),
              naming("masses 0 and 2", "stiffness is 0;", "above 0"));
  EXPECT_THAT(Line().refusal({.new_springs = {{0, 2, bone, nan}}}),
              naming("masses 0 and 2", "rest length is not a number", "at least 0"));
  EXPECT_THAT(Line().refusal({.new_springs = {{0, 2, {-1e-9, 0, 0, 0}, std::nullopt}}}),
              naming("masses 0 and 2", "stiffness is -1e-09", "above 0"));
  EXPECT_THAT(Line().refusal({.new_masses = {{{nan, 0, 0}, 0.2, 0}}}), naming("adds a mass", "position", "not finite"));
  EXPECT_THAT(Line().refusal({.new_masses = {{{}, -nan, 0}}}), naming("adds a mass", "not a number", "above 0 kg"));
  EXPECT_THAT(Line().refusal({.new_masses = {{{}, 0.2, 1}}}), naming("adds a mass", "material 1", "1 materials"));
  EXPECT_THAT(Line().refusal({.new_springs = {{0, 2, {1, 1, 0, 0}, std::nullopt}}}),
              naming("masses 0 and 2", "amplitude is 1;", "below 1"));
  EXPECT_THAT(Line().refusal({.new_springs = {{0, 2, {1, 0, 0, nan}, std::nullopt}}}),
              naming("masses 0 and 2", "frequency or phase", "not finite"));
  EXPECT_THAT(Line().refusal({.new_springs = {{0, 2, {1, 0, nan, 0}, std::nullopt}}}),
              naming("masses 0 and 2", "frequency or phase", "not finite"));
  for (const double damping : {-0.1, nan, std::numeric_limits<double>::infinity()})
    EXPECT_THAT(Line().refusal({.new_springs = {{0, 2, {1, 0, 0, 0, damping}, std::nullopt}}}),
                naming("masses 0 and 2", "damping", "at least 0"));
  EXPECT_EQ(Line().refusal({.new_springs = {{0, 2, {1, 0, 0, 0, 0.5}, std::nullopt}}}), "accepted");

  const auto grow = [](double from, double to, double whole) { return Edits{.growth = Growth{from, to, whole}}; };
  EXPECT_EQ(Line().refusal(grow(0, 1, 1)), "accepted");
  EXPECT_THAT(Line().refusal(grow(0, 2, 1)), naming("0 to 2 of", "1;"));
  EXPECT_THAT(Line().refusal(grow(-1, 0, 3)), naming("-1 to 0 of", "3;"));
  EXPECT_THAT(Line().refusal(grow(nan, 1, 1)), naming("not a number to 1 of", "1;"));
  EXPECT_THAT(Line().refusal(grow(0, 0, 0)), naming("0 to 0 of", "0;"));
  Line shrunk;  // to zero length, since 1 + (growth - 1) rounds to 0
  shrunk.living.body.springs[1].growth = 1e-30f;
  EXPECT_EQ(shrunk.refusal(grow(0, 1, 1)), "accepted");
  EXPECT_THAT(shrunk.refusal(grow(1, 1, 1)), naming("rest length", "not a number"));

  const auto change = [](std::uint32_t spring) { return ChangedSpring{.spring = spring, .rest_length = 2.0}; };
  EXPECT_THAT(Line().refusal({.changed_springs = {change(3)}}), naming("spring 3", "only 3"));
  EXPECT_THAT(Line().refusal({.changed_springs = {change(1), change(1)}}), naming("spring 1", "twice"));
  EXPECT_THAT(Line().refusal({.removed_springs = {1}, .changed_springs = {change(1)}}), naming("spring 1", "remove"));
  EXPECT_THAT(Line().refusal({.removed_masses = {1}, .changed_springs = {change(1)}}), naming("spring 1", "remove"));
  EXPECT_THAT(Line().refusal({.changed_springs = {{.spring = 1, .rest_length = -1.0}}}),
              naming("spring 1", "rest length is -1;", "at least 0"));
  EXPECT_THAT(Line().refusal({.changed_springs = {{.spring = 1, .material = Material{}}}}),
              naming("spring 1", "stiffness is 0;", "above 0"));
  for (const double factor : {0.0, -1.0, nan, std::numeric_limits<double>::infinity(), 1e308}) {
    EXPECT_THAT(Line().refusal({.changed_springs = {{.spring = 1, .stiffness_factor = factor}}}),
                naming("spring 1", "times the stiffness", "above 0"));
    EXPECT_THAT(Line().refusal({.new_springs = {{0, 3, bone, 3.0, factor}}}),
                naming("masses 0 and 3", "times the stiffness", "above 0"));
  }
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
