// The materials of a body: those of the experiment, and additional ones as long as a spring or mass uses them.
#include "base/materials.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "base/philox.hpp"
#include "evolution/breeding.hpp"
#include "life/edits.hpp"
#include "life/evaluation.hpp"
#include "life/life_record.hpp"
#include "support/experiments.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using ::testing::ElementsAre;

const Material bone{10000, 0, 0, 0}, muscle{5000, 0.14, 1, 0}, soft{700, 0, 0, 0}, odd{0.7, 0.1, 0.0007, -3};

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

TEST(Materials, GoWhenNothingIsMadeOfThem) {
  Body body = body_of({bone, muscle, soft, odd, bone}, {4, 1, 0}, {3, no_material});
  const std::vector<Material> before = made_of(body);
  drop_unused_materials(body);
  EXPECT_THAT(body.materials, ElementsAre(bone, muscle, odd));
  EXPECT_EQ(made_of(body), before);
  EXPECT_EQ(body.masses[1].material, no_material);
}

TEST(Materials, OfTheExperimentStayInTheirPlaces) {
  Body body = body_of({bone, soft, bone, muscle, soft}, {4, 2}, {1, 2}, 3);
  const std::vector<Material> before = made_of(body);
  drop_unused_materials(body);
  EXPECT_THAT(body.materials, ElementsAre(bone, soft, bone)) << "two names may stand for equal materials";
  EXPECT_EQ(made_of(body), before);
}

/// Tests a chain of fifty masses whose springs all change at every step, each to a different material.
TEST(Materials, AreNoMoreThanTheSpringsAreHoweverOftenTheseChange) {
  LivingBody living;
  living.body = body_of({bone, muscle}, {}, {}, 2);
  for (std::uint32_t i = 0; i < 50; ++i) {
    living.body.masses.push_back({{0.1 * i, 0, 0}, 0.2, 1});
    living.state.position.push_back({0.1 * i, 0, 0});
    if (i > 0) living.body.springs.push_back({i - 1, i, 0.1, i % 2});
  }
  living.state.velocity.resize(50);
  LivingBody replayed = living;
  const Genome genome;
  const Layout layout;
  LifeRecord record;
  Rng rng(philox, {7, 0, 0, 0});
  for (int cycle = 1; cycle <= 16; ++cycle) {
    const DevoContext context{living.body, living.state, cycle, 16, cycle, 16, 0, {}, 0.2, false, genome, layout};
    Edits edits;
    std::vector<Material> wanted;
    for (std::uint32_t s = 0; s < living.body.springs.size(); ++s) {
      Material material = living.body.materials[living.body.springs[s].material];
      material.stiffness *= s % 7 == 0 ? 1 : rng.uniform(0.5, 2);
      edits.changed_springs.push_back({.spring = s, .material = material});
      wanted.push_back(material);
    }
    const Change change = change_by(edits, 0, context);
    apply(resolved(edits, context), living);
    record.add(change);
    for (std::size_t s = 0; s < wanted.size(); ++s)
      ASSERT_EQ(living.body.materials.at(living.body.springs[s].material), wanted[s]) << s;
    EXPECT_LE(living.body.materials.size(), 2 + living.body.springs.size()) << "after cycle " << cycle;
  }
  for (const Change& change : LifeRecord(record.bytes()).changes()) apply(change.edits, replayed.body);
  EXPECT_EQ(replayed.body.materials, living.body.materials);
  EXPECT_EQ(made_of(replayed.body), made_of(living.body));
}

TEST(Materials, OfALifeAreThoseOfItsSpringsAndOfTheExperimentEachOnce) {
  std::string text = testing::small_experiment;
  text.insert(text.find("[[fitness]]"), R"(
[[development.operator]]
name = "stiffness-adaptation"
springs = 40
factor = 1.07
[[development.operator]]
name = "amplitude-adaptation"
springs = 25
factor = 0.93
)");
  const Experiment experiment = testing::read(text, {{"encoding.size", "[2, 2, 1]", ""},
                                                     {"development.cycles", "16", ""},
                                                     {"development.cycle_time", "0.01", ""},
                                                     {"materials.two words", "{ stiffness = 10000 }", ""}});
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
  const Evaluation evaluation(experiment, *simulator);
  const std::vector<Individual> individuals = breed(experiment, {}, 0, 0, 4);
  std::vector<Newborn> newborns;
  for (const Individual& individual : individuals) newborns.push_back({individual.id, 0, &individual.genome});
  std::vector<Life> lives = evaluation.birth.of(newborns);
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
  std::vector<Body> born;
  for (const Life& life : lives) born.push_back(life.living.body);
  evaluation.development.run(lives, [](double) {});
  std::size_t alive = 0;
  for (std::size_t i = 0; i < lives.size(); ++i) {
    if (!lives[i].alive()) continue;
    ++alive;
    expect_no_others(born[i]);
    expect_no_others(lives[i].living.body);
    EXPECT_GT(lives[i].living.body.materials.size(), born[i].materials.size());
    for (const Change& change : lives[i].result.record.changes()) apply(change.edits, born[i]);
    EXPECT_EQ(born[i].materials, lives[i].living.body.materials);
    EXPECT_EQ(made_of(born[i]), made_of(lives[i].living.body));
  }
  EXPECT_GE(alive, 2u);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
