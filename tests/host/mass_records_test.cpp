// What devo operators see of masses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "support/messages.hpp"
#include "support/told.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using testing::add_mass;
using testing::all_of_masses;
using ::testing::Each;
using ::testing::ElementsAre;
using testing::error_of;
using testing::matured;
using testing::naming;
using testing::numbers_of;
using testing::simulator_for;
using testing::Told;
using testing::unwatched;
using testing::with;

const Material bone{10000, 0, 0, 0};

/// Returns the share of contact in each cycle of a flat square body that begins at this height, m.
std::vector<std::vector<double>> contact_from(double height, const std::function<void(Experiment&)>& set) {
  std::vector<std::vector<double>> contact;
  Experiment experiment = with({Told(
      {.contact = true}, [&](const DevoContext& context, Edits&) { contact.push_back(numbers_of(context.contact)); })});
  set(experiment);
  Body body;
  body.materials = {bone};
  State state;
  for (const auto& [x, y] : {std::pair(0.0, 0.0), {0.5, 0.0}, {0.0, 0.5}, {0.5, 0.5}}) {
    body.masses.push_back({{x, y, 0}, 0.2, 0, 0});
    state.position.push_back({x, y, height});
    state.velocity.push_back({});
  }
  for (const auto& [a, b] : {std::pair(0u, 1u), {0u, 2u}, {1u, 3u}, {2u, 3u}, {0u, 3u}})
    body.springs.push_back({a, b, norm(body.masses[a].rest - body.masses[b].rest), 0});
  const auto simulator = simulator_for(experiment);
  const Evaluation evaluation(experiment, *simulator);
  std::vector<Life> lives;
  lives.push_back(evaluation.birth.amid_life(body, state));
  const Genome genome = {1, 2};
  lives.front().newborn.genome = &genome;
  evaluation.development.run(lives, unwatched);
  EXPECT_EQ(lives.front().result.status, Status::ok) << lives.front().result.reason;
  return contact;
}

TEST(MassRecords, ABodyThatRestsTouchesTheGroundAllTheTime) {
  const auto contact = contact_from(0, [](Experiment&) {});
  ASSERT_EQ(contact.size(), 2u);
  EXPECT_THAT(contact[1], ElementsAre(1, 1, 1, 1)) << "the first cycle may begin with a bounce";
}

TEST(MassRecords, ABodyThatFallsTouchesNothing) {
  EXPECT_THAT(contact_from(5, [](Experiment&) {}), Each(ElementsAre(0, 0, 0, 0)));
}

TEST(MassRecords, ABodyThatLandsHalfwayTouchesTheGroundForHalfOfTheCycle) {
  // it falls 0.05 m in 0.1 s; on this soft floor a contact would last pi sqrt(m/k) = 0.14 s or more
  const auto contact = contact_from(0.05, [](Experiment& experiment) {
    experiment.scene.gravity->acceleration = 10;
    experiment.scene.floor->stiffness = 100;
    experiment.scene.damping.reset();
    experiment.development.cycle_time = 0.2;
    experiment.development.cycles = 1;
  });
  ASSERT_EQ(contact.size(), 1u);
  ASSERT_EQ(contact[0].size(), 4u);
  for (const double share : contact[0]) EXPECT_NEAR(share, 0.5, 0.01);
}

TEST(NewMasses, MayNotLieBelowTheFloor) {
  std::vector<double> lowest, allowed;
  const auto seen_with = [&](const std::function<void(Scene&)>& set) {
    lowest.clear(), allowed.clear();
    Experiment experiment = with({Told({}, [&](const DevoContext& context, Edits&) {
      lowest.push_back(bounding_box(context.state.position).low.z);
      allowed.push_back(context.bounds.low.z);
    })});
    set(experiment.scene);
    matured(experiment);
    EXPECT_EQ(lowest.size(), 2u);
  };
  seen_with([](Scene& scene) { scene.floor->stiffness = 100; });  // the body sinks into it
  EXPECT_LT(lowest.at(1), -1e-3);
  EXPECT_THAT(allowed, ElementsAre(0, 0));
  seen_with([](Scene& scene) { scene.floor->stiffness = 1e4, scene.floor->roughness = 0.1; });
  EXPECT_LT(lowest.at(1), 0.1);
  EXPECT_THAT(allowed, ElementsAre(0.1, 0.1)) << "the height of the highest hill";
  seen_with([](Scene& scene) { scene.floor.reset(), scene.friction.reset(); });
  EXPECT_LT(lowest.at(1), -1e-3) << "it falls";
  EXPECT_EQ(allowed, lowest);
}

TEST(MassRecords, SkipShiftCountsContactToo) {
  const auto contact = [](const char* probe) {
    std::vector<std::vector<double>> seen;
    matured(with({Told({.stress = true, .contact = true},
                       [&](const DevoContext& context, Edits&) { seen.push_back(numbers_of(context.contact)); })},
                 {{"development.probe", probe, ""}}));
    return seen;
  };
  EXPECT_EQ(contact("skip-shift"), contact("exact"));
}

TEST(MassRecords, DegreeAndLoadAreSumsOverTheSprings) {
  int calls = 0;
  matured(with({Told({.stress = true, .degree = true, .load = true}, [&](const DevoContext& context, Edits& edits) {
    ++calls;
    std::vector<double> degree(context.body.masses.size(), 0), load = degree;
    for (std::size_t s = 0; s < context.body.springs.size(); ++s)
      for (const std::uint32_t end : {context.body.springs[s].a, context.body.springs[s].b}) {
        degree[end] += 1;
        load[end] += context.stress[s];
      }
    EXPECT_EQ(numbers_of(context.degree), degree);
    EXPECT_EQ(numbers_of(context.load), load);
    EXPECT_GT(*std::max_element(load.begin(), load.end()), 0);
    edits.removed_springs = {3};
  })}));
  EXPECT_EQ(calls, 2);
}

TEST(MassRecords, LoadAloneLetsStressBeMeasuredButNotSeen) {
  const Experiment experiment = with({Told({.load = true}, [](const DevoContext& context, Edits&) {
    EXPECT_GT(context.load[0], 0);
    static_cast<void>(context.stress.size());
  })});
  EXPECT_THAT(error_of(experiment), naming("devo operator", "\"stress\"", "RecordRequest::stress"));
}

TEST(MassRecords, AgesFollowWhatComesAndGoes) {
  std::vector<std::vector<double>> ages;
  const auto act = [&](const DevoContext& context, Edits& edits) {
    ages.push_back(numbers_of(context.age));
    if (context.cycle == 1) add_mass(context, edits);
    if (context.cycle == 2) edits.removed_masses = {0};
  };
  matured(with({Told({.age = true}, act)}, {{"development.cycles", "3", ""}}));
  ASSERT_EQ(ages.size(), 3u);
  std::vector<double> expected(12, 1.0);
  EXPECT_EQ(ages[0], expected);
  expected.assign(12, 2.0);
  expected.push_back(1);
  EXPECT_EQ(ages[1], expected);
  expected.assign(11, 3.0);
  expected.push_back(2);
  EXPECT_EQ(ages[2], expected);
}

TEST(MassRecords, AgesCountFromBirthForAnOperatorThatComesLate) {
  std::vector<double> ages;
  Experiment experiment =
      with({Told({}, [](const DevoContext&, Edits&) {}),
            Told({.age = true}, [&](const DevoContext& context, Edits&) { ages = numbers_of(context.age); })},
           {{"development.cycles", "3", ""}});
  experiment.devo[1].schedule.from = 3;
  matured(experiment);
  EXPECT_THAT(ages, Each(3));
}

std::vector<std::tuple<double, double, double, double>> tuples(const DevoContext& context) {
  std::vector<std::tuple<double, double, double, double>> all;
  for (std::size_t i = 0; i < context.contact.size(); ++i)
    all.emplace_back(context.contact[i], context.age[i], context.degree[i], context.load[i]);
  return all;
}

TEST(MassRecords, TheNextOperatorSeesThemFollowTheEditsOfTheFirst) {
  std::vector<std::tuple<double, double, double, double>> before, after;
  matured(with({Told(all_of_masses,
                     [&](const DevoContext& context, Edits& edits) {
                       before = tuples(context);
                       edits.removed_masses = {4};
                       add_mass(context, edits);
                     }),
                Told(all_of_masses, [&](const DevoContext& context, Edits&) { after = tuples(context); })},
               {{"development.cycles", "1", ""}}));
  ASSERT_EQ(before.size(), 12u);
  before.erase(before.begin() + 4);
  before.emplace_back(0, 0, 0, 0);
  EXPECT_EQ(after, before);
}

TEST(MassRecords, NobodyIsShownWhatItDidNotAskFor) {
  const std::map<std::string, std::function<void(const DevoContext&)>> reading = {
      {"contact", [](const DevoContext& c) { static_cast<void>(c.contact[0]); }},
      {"age", [](const DevoContext& c) { static_cast<void>(c.age[0]); }},
      {"degree", [](const DevoContext& c) { static_cast<void>(c.degree[0]); }},
      {"load", [](const DevoContext& c) { static_cast<void>(c.load[0]); }}};
  for (const auto& [name, read] : reading) {
    // the other operator asks for all of them
    const Experiment experiment = with({Told(all_of_masses, [](const DevoContext&, Edits&) {}),
                                        Told({}, [&](const DevoContext& context, Edits&) { read(context); })});
    EXPECT_THAT(error_of(experiment), naming("devo operator", "\"" + name + "\"", "RecordRequest::" + name));
  }
}

TEST(MassRecords, NothingIsMadeThatNobodyAsksFor) {
  const Life life = matured(with({Told({}, [](const DevoContext&, Edits&) {})}));
  for (const auto list : MassRecords::lists) EXPECT_TRUE((life.living.*list).empty());
  EXPECT_TRUE(life.living.cycles_lived.empty());
  EXPECT_TRUE(life.living.contact_times.empty());
  EXPECT_TRUE(life.living.stress.empty());
}

TEST(MassRecords, AskingForThemChangesNoMotion) {
  const auto evaluated = [](const RecordRequest& request) {
    const Experiment experiment = with({Told(request, [](const DevoContext&, Edits&) {})});
    const Genome genome = {1, 2};
    const Newborn newborn{0, 0, &genome};
    return Evaluation(experiment, *simulator_for(experiment)).evaluate({&newborn, 1}, unwatched).front().objectives;
  };
  EXPECT_EQ(evaluated(all_of_masses), evaluated({}));
}

TEST(MassRecords, TheShuffledControlKeepsWhatIsKnownOfAMassTogether) {
  const auto seen = [](const char* control) {
    std::vector<std::vector<std::tuple<double, double, double, double>>> all;
    matured(with({Told(all_of_masses,
                       [&](const DevoContext& context, Edits& edits) {
                         all.push_back(tuples(context));
                         if (context.cycle == 1) add_mass(context, edits);
                       })},
                 {{"development.control", control, "--set"}}));
    return all;
  };
  const auto off = seen("off"), shuffled = seen("shuffled-stress");
  ASSERT_EQ(off.size(), 2u);
  ASSERT_EQ(shuffled.size(), 2u);
  for (std::size_t cycle = 0; cycle < 2; ++cycle) {
    EXPECT_NE(shuffled[cycle], off[cycle]);
    EXPECT_THAT(shuffled[cycle], ::testing::UnorderedElementsAreArray(off[cycle]));
  }
  EXPECT_EQ(seen("shuffled-stress"), shuffled) << "the same when lived again";
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
