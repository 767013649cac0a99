// What devo operators see of masses, and the materials of a body: those of the experiment, and additional ones as long
// as a spring or mass uses them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "base/materials.hpp"
#include "life/edits.hpp"
#include "life/evaluation.hpp"
#include "support/experiments.hpp"
#include "support/lives.hpp"
#include "support/messages.hpp"
#include "support/told.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using namespace testing;
using ::testing::Each;
using ::testing::ElementsAre;

const Material bone{10000, 0, 0, 0};

/// Returns the share of contact in each cycle of a flat square body that begins at this height, m.
std::vector<std::vector<double>> contact_from(double height, const std::function<void(Experiment&)>& set = nullptr) {
  std::vector<std::vector<double>> contact;
  Experiment experiment = with({Told(
      {.contact = true}, [&](const DevoContext& context, Edits&) { contact.push_back(numbers_of(context.contact)); })});
  if (set) set(experiment);
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

TEST(MassRecords, ContactIsTheShareOfTheCycleInWhichAMassTouchesTheGround) {
  const auto resting = contact_from(0);
  ASSERT_EQ(resting.size(), 2u);
  EXPECT_THAT(resting[1], ElementsAre(1, 1, 1, 1)) << "the first cycle may begin with a bounce";
  EXPECT_THAT(contact_from(5), Each(ElementsAre(0, 0, 0, 0))) << "it falls";
  // it falls 0.05 m in 0.1 s; on this soft floor a contact would last pi sqrt(m/k) = 0.14 s or more
  const auto landing = contact_from(0.05, [](Experiment& experiment) {
    experiment.scene.gravity->acceleration = 10;
    experiment.scene.floor->stiffness = 100;
    experiment.scene.damping.reset();
    experiment.development.cycle_time = 0.2;
    experiment.development.cycles = 1;
  });
  const auto half = ::testing::DoubleNear(0.5, 0.01);
  EXPECT_THAT(landing, ElementsAre(ElementsAre(half, half, half, half)));
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
    edits.remove_spring(3);
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

TEST(MassRecords, AgesCountFromBirthAndFollowWhatComesAndGoes) {
  std::vector<std::vector<double>> ages;
  const auto act = [&](const DevoContext& context, Edits& edits) {
    ages.push_back(numbers_of(context.age));
    if (context.cycle == 1) add_mass(context, edits);
    if (context.cycle == 2) edits.remove_mass(0);
  };
  matured(with({Told({.age = true}, act)}, {{"development.cycles", "3", ""}}));
  ASSERT_EQ(ages.size(), 3u);
  EXPECT_EQ(ages[0], std::vector(12, 1.0));
  EXPECT_THAT(ages[1], ElementsAre(2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 1));
  EXPECT_THAT(ages[2], ElementsAre(3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 2));

  std::vector<double> of_late;  // an operator that comes late
  Experiment experiment =
      with({Told({}, [](const DevoContext&, Edits&) {}),
            Told({.age = true}, [&](const DevoContext& context, Edits&) { of_late = numbers_of(context.age); })},
           {{"development.cycles", "3", ""}});
  experiment.devo[1].schedule.from = 3;
  matured(experiment);
  EXPECT_THAT(of_late, Each(3));
}

/// Contact, age, degree and load of each mass.
using Known = std::vector<std::array<double, 4>>;

Known known(const DevoContext& context) {
  Known all;
  for (std::size_t i = 0; i < context.contact.size(); ++i)
    all.push_back({context.contact[i], context.age[i], context.degree[i], context.load[i]});
  return all;
}

TEST(MassRecords, TheNextOperatorSeesThemFollowTheEditsOfTheFirst) {
  Known before, after;
  matured(with({Told(all_of_masses,
                     [&](const DevoContext& context, Edits& edits) {
                       before = known(context);
                       edits.remove_mass(4);
                       add_mass(context, edits);
                     }),
                Told(all_of_masses, [&](const DevoContext& context, Edits&) { after = known(context); })},
               {{"development.cycles", "1", ""}}));
  ASSERT_EQ(before.size(), 12u);
  before.erase(before.begin() + 4);
  before.push_back({});
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

TEST(MassRecords, NothingIsMadeThatNobodyAsksForAndAskingChangesNoMotion) {
  const auto living = [](const RecordRequest& request) {
    return matured(with({Told(request, [](const DevoContext&, Edits&) {})})).living;
  };
  const LivingBody unasked = living({});
  for (const auto list : MassRecords::lists) EXPECT_TRUE((unasked.*list).empty());
  EXPECT_TRUE(unasked.cycles_lived.empty());
  EXPECT_TRUE(unasked.contact_times.empty());
  EXPECT_TRUE(unasked.stress.empty());
  EXPECT_EQ(living(all_of_masses).state.position, unasked.state.position);
}

TEST(MassRecords, TheShuffledControlKeepsWhatIsKnownOfAMassTogether) {
  const auto seen = [](const char* control) {
    std::vector<Known> all;
    matured(with({Told(all_of_masses,
                       [&](const DevoContext& context, Edits& edits) {
                         all.push_back(known(context));
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

const Material muscle{5000, 0.14, 1, 0}, soft{700, 0, 0, 0}, odd{0.7, 0.1, 0.0007, -3};

/// A body whose springs and masses have materials with the given indices.
Body body_of(std::vector<Material> materials, std::vector<std::uint32_t> springs, std::vector<std::int32_t> masses,
             std::uint32_t base = 0) {
  Body body;
  body.materials = std::move(materials);
  body.base_materials = base;
  for (const std::int32_t material : masses) body.masses.push_back({{}, 0.2, material});
  for (const std::uint32_t material : springs) body.springs.push_back({0, 1, 1, material});
  return body;
}

/// The materials of all springs, with the springs' own stiffness, then of all masses.
std::vector<Material> made_of(const Body& body) {
  std::vector<Material> made;
  for (const Spring& spring : body.springs) {
    made.push_back(body.materials.at(spring.material));
    made.back().stiffness = body.stiffness(spring);
  }
  for (const Mass& mass : body.masses)
    made.push_back(mass.material == no_material ? Material{} : body.materials.at(std::size_t(mass.material)));
  return made;
}

TEST(Materials, StandOnceInAList) {
  std::vector<Material> materials = {bone, muscle, bone};
  MaterialList list(materials);
  EXPECT_EQ(list.index(bone), 0u);
  EXPECT_EQ(list.index(soft), 3u);
  EXPECT_EQ(list.index(muscle), 1u);
  EXPECT_EQ(list.index(soft), 3u);
  EXPECT_EQ(list.index({10000, -0.0, 0, -0.0}), 0u) << "zeros are equal whatever their signs";
  EXPECT_THAT(materials, ElementsAre(bone, muscle, bone, soft));
}

TEST(Materials, GoWhenNothingIsMadeOfThemUnlessTheyAreOfTheExperiment) {
  Body body = body_of({bone, muscle, soft, odd, bone}, {4, 1, 0}, {3, no_material});
  const std::vector<Material> before = made_of(body);
  drop_unused_materials(body);
  EXPECT_THAT(body.materials, ElementsAre(bone, muscle, odd));
  EXPECT_EQ(made_of(body), before);
  EXPECT_EQ(body.masses[1].material, no_material);
  Body named = body_of({bone, soft, bone, muscle, soft}, {4, 2}, {1, 2}, 3);
  const std::vector<Material> named_before = made_of(named);
  drop_unused_materials(named);
  EXPECT_THAT(named.materials, ElementsAre(bone, soft, bone)) << "two names may stand for equal materials";
  EXPECT_EQ(made_of(named), named_before);
}

TEST(Materials, AreThoseOfTheSpringsHoweverOftenTheseChange) {
  LivingBody living{.body = body_of({bone, muscle}, std::vector<std::uint32_t>(50, 0), {1, 1}, 2)};
  const Body& body = living.body;
  for (int cycle = 1; cycle <= 16; ++cycle) {
    Edits edits(body);
    for (std::uint32_t s = 0; s < body.springs.size(); ++s) {
      Material material = body.materials[body.springs[s].material];
      material.stiffness *= s % 7 == 0 ? 1 : 0.9 + 0.01 * s;
      edits.change_spring(s, {.material = material});
    }
    apply(edits, living);
    for (const ChangedSpring& changed : edits.changed_springs)
      ASSERT_EQ(body.materials.at(body.springs[changed.spring].material), changed.material) << changed.spring;
    EXPECT_LE(body.materials.size(), 2 + body.springs.size()) << "after cycle " << cycle;
  }
}

TEST(Materials, OfALifeAreThoseOfItsSpringsAndOfTheExperimentEachOnce) {
  const Experiment experiment =
      small({"encoding.size=[2, 2, 1]", "development.cycles=16", "development.cycle_time=0.01",
             "materials.two words={ stiffness = 10000 }",
             "development.operator.1={name='stiffness-adaptation', springs=40, factor=1.07}",
             "development.operator.2={name='amplitude-adaptation', springs=25, factor=0.93}"});
  auto [born, lives] = Developed(experiment, 4);
  const auto expect_no_others = [&](const Body& body) {
    const std::size_t base = experiment.context.materials.size();
    ASSERT_EQ(body.base_materials, base);
    for (std::size_t i = 0; i < base; ++i) EXPECT_EQ(body.materials.at(i), experiment.context.materials[i]);
    std::set<std::uint32_t> used;
    for (const Spring& spring : body.springs)
      if (spring.material >= base) used.insert(spring.material);
    EXPECT_EQ(body.materials.size(), base + used.size());
    EXPECT_EQ(numbered({body.materials.begin() + static_cast<std::ptrdiff_t>(base), body.materials.end()}).size(),
              used.size());
  };
  std::size_t alive = 0;
  for (std::size_t i = 0; i < lives.size(); ++i) {
    if (!lives[i].alive()) continue;
    ++alive;
    const Body& body = born[i].body;
    expect_no_others(body);
    expect_no_others(lives[i].living.body);
    EXPECT_GT(lives[i].living.body.materials.size(), body.materials.size());
    for (const Change& change : lives[i].record.changes()) apply(change.edits, born[i], change.op);
    EXPECT_EQ(body.materials, lives[i].living.body.materials);
    EXPECT_EQ(made_of(body), made_of(lives[i].living.body));
  }
  EXPECT_GE(alive, 2u);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
