// Random numbers of development that follow from the identities of masses, and those identities.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "base/philox.hpp"
#include "life/edits.hpp"
#include "life/measurement/scenario_start.hpp"
#include "support/edits.hpp"
#include "support/experiments.hpp"
#include "support/lives.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"
#include "support/told.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using testing::Developed;
using ::testing::ElementsAre;
using testing::naming;
using testing::small;

/// A context of a body of some masses, which have these identities.
struct Seen {
  Body body;
  State state;
  Genome genome;
  Layout layout;
  std::vector<std::uint64_t> identities;
  std::vector<std::uint32_t> daughters;

  explicit Seen(std::vector<std::uint64_t> of) : identities(std::move(of)), daughters(identities.size()) {
    body.masses.resize(identities.size());
  }
  DevoContext context(Draws draws = {}) const {
    DevoContext context{body, state, 3, 4, 3, 4, 0.25, {}, 0.2, false, genome, layout};
    context.identities = identities;
    context.daughters = daughters;
    context.draws = draws;
    return context;
  }
};

TEST(Draws, AreFunctionsOfTheKeyTheTagAndTheIdentitiesAlone) {
  const Seen seen({4, 7, 9}), permuted({9, 4, 7});
  const Draws draws(philox, 1, 2, true), others(philox, 3, 2, true);
  const DevoContext here = seen.context(draws), there = permuted.context(draws);
  EXPECT_EQ(here.draw(0, "leg"), there.draw(1, "leg")) << "the identity counts, not the index";
  EXPECT_EQ(here.draw(0, 2, "leg"), there.draw(1, 0, "leg"));
  EXPECT_EQ(here.draw(0, 2, "leg"), here.draw(2, 0, "leg"));
  EXPECT_EQ(here.draw("leg"), there.draw("leg"));
  const std::set<double> all{here.draw("leg"),           here.draw(0, "leg"),
                             here.draw(1, "leg"),        here.draw(0, 1, "leg"),
                             here.draw(0, 2, "leg"),     here.draw(0, {"leg", 1}),
                             here.draw(0, {"leg", 256}), here.draw(0, "gel"),
                             here.draw(0, "leg "),       seen.context(others).draw(0, "leg")};
  EXPECT_EQ(all.size(), 10u);
  EXPECT_THAT(testing::refusal<std::logic_error>([&] { static_cast<void>(seen.context().draw("leg")); }),
              naming("no random numbers"));
}

TEST(Draws, AreUniformAndIndependent) {
  // neighbouring identities, numbers and tags, as they occur; the tolerances are five standard deviations
  constexpr int count = 20'000;
  const Draws draws(philox, 1, 2, true);
  double sum = 0, squares = 0, beside = 0, between = 0;
  for (std::uint64_t i = 0; i < count; ++i) {
    const double x = draws.number("a", {i}) - 0.5, y = draws.number("a", {i + 1}) - 0.5,
                 z = draws.number({"a", 1}, {i}) - 0.5;
    sum += x;
    squares += x * x;
    beside += x * y;
    between += x * z;
  }
  EXPECT_NEAR(sum / count, 0, 5 * std::sqrt(1 / 12.0 / count));
  EXPECT_NEAR(squares / count, 1 / 12.0, 5 * std::sqrt(1 / 180.0 / count));
  EXPECT_NEAR(beside / count, 0, 5 / 12.0 / std::sqrt(count));
  EXPECT_NEAR(between / count, 0, 5 / 12.0 / std::sqrt(count));
}

TEST(Ring, GivesTheNextItemAndOneItemLessGivesItsArcToTheNext) {
  const Ring ring({{0.2, 5}, {0.9, 1}, {0.5, 3}}), without({{0.2, 5}, {0.9, 1}});
  EXPECT_EQ(ring.at(0.1), 5u);
  EXPECT_EQ(ring.at(0.2), 5u);
  EXPECT_EQ(ring.at(0.3), 3u);
  EXPECT_EQ(without.at(0.3), 1u);
  EXPECT_EQ(ring.at(0.95), 5u) << "around";
  EXPECT_EQ(ring.at(0.95, 5), 3u);
  EXPECT_EQ(ring.at(0.6, 1), 5u);
}

TEST(Identities, OfDaughtersFollowFromTheirMothersAndOfNewcomersFromTheirOperator) {
  Seen seen({40, 70});
  seen.daughters = {2, 0};
  const auto come = [&](std::uint64_t origin) {
    Edits edits;
    edits.divide(0, {});
    edits.add_mass({});
    edits.divide(0, {});
    edits.divide(1, {});
    edits.add_mass({}, {.identity = 5});
    edits.add_mass({});
    std::vector<std::uint64_t> identities;
    for (const NewMass& mass : resolved(edits, seen.context({philox, 1, origin, true})).new_masses)
      identities.push_back(mass.identity.value());
    return identities;
  };
  EXPECT_THAT(come(8), ElementsAre(mixed(40, 2), mixed(8, 0), mixed(40, 3), mixed(70, 0), 5u, mixed(8, 2)));
  EXPECT_EQ(come(9)[0], come(8)[0]);
  EXPECT_NE(come(9)[1], come(8)[1]);

  MassNumbers names({40, 70});
  Edits edits;
  edits.remove_mass(1);
  edits.divide(0, {}, {.identity = 6});
  edits.divide(1, {}, {.identity = 7});
  names.apply(edits);
  EXPECT_THAT(names.identities(), ElementsAre(40, 6, 7));
  EXPECT_THAT(names.daughters(), ElementsAre(1, 0, 0));
  EXPECT_THAT(names.numbers(), ElementsAre(0, 2, 3));
}

TEST(Identities, OfTheBlueprintStayWithTheirMassesAndAreItsIndicesIfItHasNone) {
  Blueprint blueprint;
  for (int i = 0; i < 4; ++i) blueprint.body.masses.push_back({{double(i), 0, 0}, 0.2, no_material});
  blueprint.body.materials = {{1000, 0, 0, 0}};
  blueprint.body.springs = {{1, 2, 1, 0}, {2, 3, 1, 0}};  // mass 0 is dropped
  EXPECT_THAT(build_body(blueprint).identities, ElementsAre(1, 2, 3));
  blueprint.identities = {9, 8, 7, 6};
  EXPECT_THAT(build_body(blueprint).identities, ElementsAre(8, 7, 6));
  const EncodingContext context;
  const auto refusal = [&] {
    return testing::refusal<std::invalid_argument>([&] { check_blueprint(blueprint, context); });
  };
  blueprint.identities = {9, 8, 7, 8};
  EXPECT_THAT(refusal(), naming("masses 1 and 3", "identity 8"));
  blueprint.identities.pop_back();
  EXPECT_THAT(refusal(), naming("3 identities", "4 masses"));
}

/// Two individuals of one genome, of different generations.
std::vector<Newborn> twins(const Genome& genome) { return {{1, 0, &genome}, {5, 3, &genome}}; }

TEST(InheritedDraws, LetEqualGenomesDevelopAlikeWhateverDraws) {
  const std::string turnover = "development.operator.0={name='spring-turnover', springs=3";
  for (const std::string& what :
       {turnover + "}", turnover + ", where='by-stress'}", turnover + ", where='most-stressed'}",
        std::string("development.operator.0={name='mass-turnover', threshold=100, limit=2, springs=4}"),
        std::string("development.operator.0={name='mass-growth', masses=1, springs=5, where='by-stress'}"),
        std::string("development.operator.0={name='length-adaptation', springs=3}"),
        std::string("development.control=random-places"), std::string("development.control=shuffled-stress"),
        std::string("development.probe=skip-shift")}) {
    SCOPED_TRACE(what);
    const auto lives = [&](const char* draws, const char* seed) {
      const Experiment experiment =
          small({"encoding.size=[3, 2, 2]", "development.cycles=4", "development.skip=10", what,
                 std::string("development.draws=") + draws, std::string("development.seed=") + seed});
      const std::vector<Individual> one = breed(experiment, {}, 0, 0, 1);
      std::vector<Life> lived = Developed(experiment, twins(one.front().genome)).lives;
      EXPECT_TRUE(lived[0].alive());
      return lived;
    };
    const std::vector<Life> same = lives("inherited", "7"), others = lives("inherited", "8"),
                            own = lives("individual", "7");
    EXPECT_FALSE(same[0].record.empty()) << "there must be something to compare";
    EXPECT_TRUE(same[0].record == same[1].record);
    EXPECT_EQ(same[0].living.state.position, same[1].living.state.position);
    EXPECT_EQ(same[0].living.numbers.identities(), same[1].living.numbers.identities());
    if (what.find("adaptation") != what.npos) continue;  // draws only where stresses are equal
    EXPECT_FALSE(same[0].record == others[0].record) << "another seed, other numbers";
    EXPECT_FALSE(own[0].record == own[1].record) << "each has its own";
  }
}

TEST(InheritedDraws, ATableForThemAloneLetsNothingDevelop) {
  const std::string text = testing::small_experiment.substr(0, testing::small_experiment.find("[development]"));
  const std::string rest = testing::small_experiment.substr(testing::small_experiment.find("[[fitness]]"));
  const Experiment plain = testing::read(text + rest),
                   with_seed = testing::read(text + "[development]\nseed = 3\n" + rest);
  EXPECT_EQ(with_seed.development.cycles, 0);
  EXPECT_EQ(with_seed.development.seed, 3);
  EXPECT_EQ(plain.development.seed, 7) << "that of the run";
  EXPECT_EQ(testing::small().development.draws, DrawsBy::inherited) << "the default";
}

TEST(InheritedDraws, AreThoseOfTheLabelSoThatAnotherOperatorBeforeChangesNothing) {
  const auto drawn = [](const std::vector<std::string>& names) {
    std::map<std::string, double> numbers;
    for (const std::string& name : names) {
      Experiment experiment = small();
      numbers[name] = draws_of_development(experiment, {}, name, 1).number("x");
    }
    return numbers;
  };
  EXPECT_EQ(drawn({"a", "b"})["b"], drawn({"b"})["b"]);
  const Experiment experiment =
      small({"development.operator.0={name='spring-turnover', springs=1}",
             "development.operator.1={name='spring-turnover', springs=1, label='more'}",
             "development.operator.2={name='mass-growth'}", "development.operator.3={name='spring-turnover'}"});
  std::vector<std::string> labels;
  for (const Scheduled& op : experiment.devo) labels.push_back(op.label);
  EXPECT_THAT(labels, ElementsAre("spring-turnover", "more", "mass-growth", "spring-turnover 2"));
}

TEST(InheritedDraws, MoveTheSameMassesInTheSameWayWhenANoisyScenarioBegins) {
  const auto offsets = [](const std::string& draws, std::uint32_t removed) {
    const Experiment experiment =
        testing::read(testing::small_experiment + "\n[[scenario]]\nname = 'shaken'\nstart_noise = 0.01\n",
                      {{"development.draws", draws, ""}});
    const std::vector<Individual> one = breed(experiment, {}, 0, 0, 1);
    const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
    const Evaluation evaluation(experiment, *simulator);
    const Newborn newborn{1, 0, &one.front().genome};
    Life life = std::move(evaluation.birth.of({&newborn, 1}).front());
    if (removed > 0) apply(testing::removing(life.living.body, {}, {removed}), life.living);
    // held above the ground, so that nothing but the noise moves it
    for (Vec3& position : life.living.state.position) position.z += 1;
    const std::vector<Vec3> before = life.living.state.position;
    start_scenario({0, 0}, experiment, evaluation.simulation, life);
    std::map<std::uint64_t, double> moved;
    for (std::size_t i = 0; i < before.size(); ++i)
      moved[life.living.numbers.identities()[i]] = life.living.state.position[i].x - before[i].x;
    return moved;
  };
  for (const std::string draws : {"inherited", "individual"}) {
    SCOPED_TRACE(draws);
    const auto whole = offsets(draws, 0), less = offsets(draws, 2);
    std::size_t same = 0;
    for (const auto& [identity, x] : less) same += std::abs(whole.at(identity) - x) < 1e-12;
    EXPECT_EQ(same, draws == "inherited" ? less.size() : 2u) << "without them, those after the missing mass differ";
  }
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
