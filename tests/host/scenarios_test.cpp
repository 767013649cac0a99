// Scenarios: what they change, what they keep, and how the scores in them become one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "report/filming.hpp"
#include "support/experiments.hpp"
#include "support/lives.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"
#include "support/scorer.hpp"
#include "support/told.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using testing::alive, testing::score_by, testing::Scorer;

Experiment with(const std::string& scenarios, std::vector<Override> overrides = {}) {
  return testing::read(testing::small_experiment + scenarios, std::move(overrides));
}

std::string scenario(const std::string& name, const std::string& keys = "") {
  return "\n[[scenario]]\nname = '" + name + "'\n" + keys + "\n";
}

Life lived(const Experiment& experiment, std::uint32_t id = 0) { return testing::lived(experiment, {2, 1}, id); }

FilmedLife filmed(const Experiment& experiment, const Test& test = {}) {
  const Genome genome{2, 1};
  const Newborn newborn{0, 0, &genome};
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
  return film_lives(experiment, *simulator, {&newborn, 1}, test).front();
}

/// Returns the message with which an experiment is refused.
std::string complaint(const std::string& scenarios, const std::vector<Override>& overrides = {}) {
  return testing::refusal<ConfigError>([&] { with(scenarios, overrides); });
}

/// What a fitness operator saw in one test.
struct Seen {
  std::string scenario;
  Body body;
  Vec3 way;
  Box box;
};

const Request brief{.settle = 0, .window = 0.02};

/// Scores 1, 2, 3 and 10 in the first tests.
Scorer witness(std::vector<Seen>& all) {
  return {brief, {{"number", "1", true}}, [&all](const Observation& o) {
            all.push_back({std::string(o.scenario), *o.body, o.centre_after - o.centre_before, o.box});
            return std::vector{all.size() == 4 ? 10.0 : static_cast<double>(all.size())};
          }};
}

/// Returns what was seen in so many tests.
std::vector<Seen> seen_in(std::size_t tests, const std::string& scenarios, std::vector<Override> overrides = {},
                          std::uint32_t id = 0) {
  Experiment experiment = with(scenarios, std::move(overrides));
  std::vector<Seen> seen;
  score_by(experiment, {witness(seen)});
  alive(lived(experiment, id));
  EXPECT_EQ(seen.size(), tests);
  seen.resize(tests);
  return seen;
}

TEST(Scenarios, ThatChangeNothingAreTheSceneItself) {
  const Life plain = lived(with("")), tested = alive(lived(with(scenario("as it is"))));
  EXPECT_EQ(plain.result.objectives, tested.result.objectives);
  EXPECT_EQ(plain.result.spring_evaluations, tested.result.spring_evaluations);
  ASSERT_EQ(tested.result.tests.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(tested.result.tests[i].objective, i);
    EXPECT_EQ(tested.result.tests[i].value, plain.result.objectives.at(i));
  }
  EXPECT_TRUE(plain.result.tests.empty());
}

TEST(Scenarios, BeginWithTheMaturedBodyWhateverCameBefore) {
  const std::string slope = scenario("slope", "gravity.slope = 12"),
                    rough = scenario("rough", "floor.roughness = 0.03");
  const auto scores = [](const std::string& scenarios) {
    std::map<std::string, std::vector<double>> by_name;
    const Experiment experiment = with(scenarios);
    for (const TestScore& test : lived(experiment).result.tests)
      by_name[experiment.scenarios[test.scenario].name].push_back(test.value);
    return by_name;
  };
  const auto both = scores(slope + rough);
  EXPECT_EQ(both, scores(rough + slope));
  EXPECT_EQ(both.at("slope"), scores(slope).at("slope"));
  EXPECT_EQ(both.at("rough"), scores(rough).at("rough"));
  EXPECT_NE(both.at("slope"), both.at("rough"));
}

TEST(Scenarios, ReplaceForces) {
  const Experiment experiment =
      with(scenario("ice", "friction.coefficient = 0.01") +
               scenario("hills", "floor.roughness = 0.05\nfloor.seed = 9") + scenario("mud", "drag.coefficient = 3"),
           {{"scene.floor.stiffness", "1e5", ""}});
  EXPECT_EQ(experiment.scenarios.at(0).scene.friction->coefficient, 0.01);
  EXPECT_EQ(experiment.scenarios[1].scene.floor->stiffness, 1e5) << "keys that are left out are those of the scene";
  EXPECT_EQ(experiment.scenarios[1].scene.floor->roughness, 0.05);
  EXPECT_EQ(experiment.scenarios[1].scene.friction->coefficient, 0.5);
  EXPECT_EQ(experiment.scenarios[2].scene.drag->coefficient, 3);
  EXPECT_FALSE(experiment.scene.drag);
  EXPECT_EQ(read_settings(experiment.resolved, "record").scenarios, experiment.scenarios) << "read back";
}

TEST(Scenarios, TiltTheGround) {
  // without friction, a body slides down a slope with the acceleration g sin(slope)
  const auto seen =
      seen_in(1, scenario("slide", "gravity.slope = 30\nfriction.coefficient = 0"),
              {{"scene.damping.rate", "0", ""}, {"development.cycles", "0", ""}, {"encoding.mass", "1", ""}});
  EXPECT_EQ(seen[0].scenario, "slide");
  EXPECT_NEAR(seen[0].way.x, 9.81 * 0.5 / 2 * 0.02 * 0.02, 5e-5);
}

TEST(Scenarios, StillMuscles) {
  const auto seen = seen_in(2, scenario("still", "muscles = false") + scenario("moving"));
  const auto moves = [](const Body& body) {
    return std::any_of(body.materials.begin(), body.materials.end(), [](const Material& m) { return m.amplitude > 0; });
  };
  EXPECT_FALSE(moves(seen[0].body));
  EXPECT_TRUE(moves(seen[1].body));
}

TEST(Scenarios, LoadTheBody) {
  const auto seen =
      seen_in(2, scenario("bare") + scenario("loaded", "payload.share = 0.7"), {{"scene.payload.share", "0.2", ""}});
  const auto weight = [](const Body& body) {
    double sum = 0;
    for (const Mass& mass : body.masses) sum += mass.mass;
    return sum;
  };
  EXPECT_NEAR(weight(seen[0].body), 12 * 0.2 * 1.2, 1e-12);
  EXPECT_NEAR(weight(seen[1].body), 12 * 0.2 * 1.7, 1e-12) << "in place of the scene's load";
}

TEST(Scenarios, DamageTheSameInAllIndividualsAndOtherwiseInEveryRepeat) {
  const std::string damage = scenario("hurt", "damage = 0.2\nrepeat = 3");
  const std::vector<Override> at_birth{{"development.cycles", "0", ""}};
  const auto whole = seen_in(1, "", at_birth), one = seen_in(3, damage, at_birth, 0),
             other = seen_in(3, damage, at_birth, 5);
  const std::size_t springs = whole[0].body.springs.size(), left = springs - std::lround(0.2 * double(springs));
  const auto pairs = [](const Body& body) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> joined;
    for (const Spring& spring : body.springs) joined.insert({spring.a, spring.b});
    return joined;
  };
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LE(one[i].body.springs.size(), left) << "and those of pieces that come off";
    EXPECT_GE(one[i].body.springs.size(), left / 2);
    EXPECT_EQ(pairs(one[i].body), pairs(other[i].body));
  }
  EXPECT_FALSE(pairs(one[0].body) == pairs(one[1].body) && pairs(one[1].body) == pairs(one[2].body));
}

TEST(Scenarios, LeaveTheMassesTheirNumbers) {
  Experiment experiment = with(scenario("whole") + scenario("hurt", "damage = 0.6\nrepeat = 4"));
  std::vector<std::vector<std::uint32_t>> numbers;
  const Request every_mass{.settle = 0, .window = 0.02, .rate = 50, .channels = {.positions = true}};
  const auto score = [&](const Observation& o) {
    const auto seen = o.samples.numbers(1);
    numbers.emplace_back(seen.begin(), seen.end());
    EXPECT_EQ(seen.size(), o.samples.body(1).masses.size());
    EXPECT_EQ(seen.size(), o.body->masses.size());
    return std::vector{static_cast<double>(seen.size())};
  };
  score_by(experiment, {{every_mass, {{"masses", "1"}}, score}});
  alive(lived(experiment));
  ASSERT_EQ(numbers.size(), 5u);
  EXPECT_EQ(numbers[0].size(), 12u);
  std::size_t least = 12;
  for (const auto& hurt : numbers) {
    EXPECT_THAT(numbers[0], ::testing::IsSupersetOf(hurt));
    least = std::min(least, hurt.size());
  }
  EXPECT_LT(least, 12u) << "pieces come off";

  for (std::int64_t repeat = 0; repeat < 4; ++repeat) {
    const Film film = filmed(experiment, {1, repeat}).film;
    ASSERT_EQ(film.size(), 3u) << "two cycles and the window";
    EXPECT_EQ(film.back().numbers, numbers[static_cast<std::size_t>(1 + repeat)]);
    EXPECT_EQ(film.back().body.masses.size(), film.back().numbers.size());
  }
}

TEST(Scenarios, ShakeTheStart) {
  const auto seen = seen_in(3, scenario("calm") + scenario("shaken", "start_noise = 0.01\nrepeat = 2"));
  for (std::size_t i = 1; i < 3; ++i) {
    EXPECT_FALSE(seen[i].box.high == seen[0].box.high);
    EXPECT_NEAR(seen[i].box.longest_side(), seen[0].box.longest_side(), 0.03);
  }
  EXPECT_FALSE(seen[1].box.high == seen[2].box.high);
}

const std::string four = scenario("a", "repeat = 3\nstart_noise = 0.001") + scenario("b");

TEST(Scenarios, AreSummedUpAsTheExperimentSaysOrOneAloneCounts) {
  const struct {
    Over over;
    std::optional<std::size_t> alone;
    double expected, if_minimised;
  } cases[] = {{Over::mean, {}, 4, 4},
               {Over::worst, {}, 1, 10},
               {Over::median, {}, 2.5, 2.5},
               {Over::mean, 0, 2, 2},
               {Over::mean, 1, 10, 10}};
  for (const auto& [over, alone, expected, if_minimised] : cases) {
    Experiment experiment = with(four);
    std::vector<Seen> seen;
    score_by(experiment, {witness(seen)}, over, alone);
    const Result result = lived(experiment).result;
    EXPECT_EQ(result.objectives, std::vector{expected});
    EXPECT_EQ(result.tests.size(), 4u) << "if one counts, the others are measured all the same";
    experiment.objectives[0].maximise = false;
    seen.clear();
    EXPECT_EQ(lived(experiment).result.objectives, std::vector{if_minimised});
  }
  const Experiment read = with(four, {{"fitness.0.over", "worst", ""}});
  EXPECT_EQ(read.fitness.at(0).over, Over::worst);
  EXPECT_EQ(read.fitness.at(1).over, Over::mean);
}

TEST(Scenarios, AreNotSummedUpToInfinity) {
  Experiment experiment = with(scenario("a", "repeat = 2\nstart_noise = 0.001"));
  const std::vector<double> largest{std::numeric_limits<double>::max()};
  score_by(experiment, {{brief, {{"size", "1", true}}, [&](const Observation&) { return largest; }}});
  const Result mean = lived(experiment).result;
  EXPECT_EQ(mean.status, Status::invalid);
  EXPECT_THAT(mean.reason, testing::naming("mean", "size"));
  EXPECT_TRUE(mean.objectives.empty());
  experiment.fitness[0].over = Over::median;
  EXPECT_EQ(lived(experiment).result.objectives, largest);
}

TEST(Scenarios, OneAloneIsNamedByTheKeyOver) {
  const std::string two = scenario("flat") + scenario("slope");
  const Experiment read = with(two, {{"fitness.0.over", "slope", ""}});
  EXPECT_EQ(read.fitness.at(0).scenario, 1u);
  EXPECT_FALSE(read.fitness.at(1).scenario.has_value());
  EXPECT_EQ(testing::read(read.resolved).fitness.at(0).scenario, 1u) << "the record says it too";
  EXPECT_THAT(complaint(two, {{"fitness.0.over", "slop", "--set"}}),
              testing::naming("--set: fitness.0.over ", "slop", "slope"));
  EXPECT_THAT(complaint("", {{"fitness.0.over", "flat", "--set"}}),
              testing::naming("--set: fitness.0.over ", "flat", "median"));
  for (const char* name : {"mean", "worst", "median"})
    EXPECT_THAT(complaint(two, {{"scenario.1.name", name, "--set"}}),
                testing::naming("--set: scenario.1.name ", name, "another name"));
}

TEST(Scenarios, ThatFailAreNamed) {
  const std::string storm = "repeat = 2\nstart_noise = 0.001\ngravity.acceleration = 1000\ndrag.coefficient = 1e6";
  const auto rk4 = std::vector<Override>{{"simulation.method", "rk4", ""}};  // computes drag as a force
  const Life life = testing::lived(with(scenario("flat") + scenario("storm", storm), rk4), {2, 2});
  EXPECT_EQ(life.result.status, Status::diverged);
  EXPECT_THAT(life.result.reason, testing::at_place("scenario \"storm\", repeat 1: "));
  EXPECT_GT(life.result.ended_at, 0.1) << "since birth";
  EXPECT_TRUE(life.result.objectives.empty());
  for (const std::string develops : {"", "develops = true\n"}) {
    const Life stiff = lived(with(scenario("rock", develops + "floor.stiffness = 1e9")));
    EXPECT_EQ(stiff.result.status, Status::invalid);
    EXPECT_THAT(stiff.result.reason, testing::at_place("scenario \"rock\": unstable dt: "));
    EXPECT_TRUE(stiff.result.objectives.empty());
  }
}

const std::string muddy = scenario("mud", "develops = true\ndrag.coefficient = 3");

TEST(Scenarios, ThatDevelopAreLivesInTheirSceneFromBirthOn) {
  const Life there = lived(with("", {{"scene.drag.coefficient", "3", ""}}));
  const Life here = lived(with("")), both = alive(lived(with(muddy)));
  EXPECT_EQ(both.result.objectives, there.result.objectives);
  EXPECT_NE(both.result.objectives, here.result.objectives);
  EXPECT_EQ(both.record, here.record) << "the record is of the life in the experiment's own scene";
  EXPECT_GT(both.result.spring_evaluations, there.result.spring_evaluations) << "it developed in both scenes";
  EXPECT_NE(both.result.objectives, lived(with(scenario("mud", "drag.coefficient = 3"))).result.objectives);
  EXPECT_EQ(lived(with(scenario("load", "develops = true\npayload.share = 0.7"))).result.objectives,
            lived(with("", {{"scene.payload.share", "0.7", ""}})).result.objectives);
}

TEST(Scenarios, ThatDevelopMayBeginWithNoiseAndDamage) {
  const std::string hurt = "repeat = 3\ndamage = 0.2\nstart_noise = 0.01\ndevelops = ";
  const auto scores = [&](const std::string& develops) {
    std::vector<double> values;
    for (const TestScore& test : lived(with(scenario("hurt", hurt + develops))).result.tests)
      values.push_back(test.value);
    return values;
  };
  EXPECT_EQ(scores("true").size(), 6u);
  EXPECT_EQ(scores("true"), scores("false")) << "it is the same scene, and noise and damage begin after maturing";
}

TEST(Scenarios, ThatDevelopHoldTheWindowsWithinTheLife) {
  Experiment experiment = with(scenario("matured") + muddy);
  std::vector<std::string> seen_in;
  std::vector<Seen> seen;
  const Scorer grower({.settle = 0, .window = 0.08, .cycle = 0}, {{"way", "m", true}}, [&](const Observation& o) {
    seen_in.emplace_back(o.scenario);
    return std::vector{norm(o.centre_after - o.centre_before)};
  });
  score_by(experiment, {grower, witness(seen)});
  const Life life = alive(lived(experiment));
  EXPECT_EQ(seen_in, (std::vector<std::string>{"", "mud"}));
  ASSERT_EQ(life.result.tests.size(), 3u) << "one window in the first scenario, and two in the second one";
  EXPECT_EQ(life.result.tests[1].value, life.result.objectives[0]) << "the way in the scenario that develops";
}

TEST(Scenarios, ThatDevelopGiveTheSameInAnyBatch) {
  const Experiment experiment = with(scenario("flat") + muddy);
  testing::expect_independent_lives(experiment, breed(experiment, {}, 0, 0, 6));
}

TEST(Scenarios, ThatDevelopAreFilmedFromBirthOn) {
  const Experiment experiment = with(muddy);
  const FilmedLife film = filmed(experiment), film_there = filmed(with("", {{"scene.drag.coefficient", "3", ""}}));
  EXPECT_EQ(film.result.objectives, lived(experiment).result.objectives);
  ASSERT_EQ(film.film.size(), film_there.film.size());
  for (std::size_t shot = 0; shot < film.film.size(); ++shot)
    EXPECT_EQ(film.film[shot].frames.back().positions, film_there.film[shot].frames.back().positions);
}

TEST(Scenarios, AreKnownByNameToTheOperatorsThatDevelopABodyInThem) {
  Experiment experiment = with(muddy + scenario("slope", "gravity.slope = 2") + scenario("load", "develops = true"));
  std::map<std::string, int> calls;
  experiment.devo.at(0).op = std::make_unique<testing::Told>(RecordRequest{}, [&](const DevoContext& context, Edits&) {
    ++calls[std::string(context.scenario)];
    EXPECT_EQ(context.life, 1u);
  });
  alive(lived(experiment));
  // two cycles each: in the experiment's own scene, and in those in which it develops
  EXPECT_EQ(calls, (std::map<std::string, int>{{"", 2}, {"mud", 2}, {"load", 2}}));
}

TEST(Scenarios, WithFaultsAreRefused) {
  const auto told = [](const std::string& keys) { return complaint("\n[[scenario]]\n" + keys + "\n"); };
  EXPECT_THAT(told("repeat = 2"), testing::at_place("test.toml:50:1", "name"));
  EXPECT_THAT(told("name = ''"), testing::naming("scenario.0.name"));
  EXPECT_THAT(told("name = 'a'\n[[scenario]]\nname = 'a'"), testing::naming("scenario.1.name", "\"a\""));
  EXPECT_THAT(told("name = 'a'\ndamage = 1.5"), testing::naming("scenario.0.damage", "1.5", "0.99"));
  EXPECT_THAT(told("name = 'a'\ndamag = 0.5"), testing::naming("damag", "damage"));
  EXPECT_THAT(told("name = 'a'\n[scenario.gravity]\nslop = 5"), testing::naming("slop", "slope"));
  EXPECT_THAT(told("name = 'a'\nstart_noise = nan"), testing::naming("scenario.0.start_noise"));
  EXPECT_THAT(told("name = 'a'\ndevelops = true\nrepeat = 3"),
              testing::naming("scenario.0.repeat = 3", "start_noise", "damage"))
      << "all repeats would be the same";
}

TEST(Labels, TellTwoUsesOfOneOperatorApart) {
  const std::string second = "\n[[fitness]]\nname = 'distance'\ndirection = [0, 1, 0]\nsettle = 0.05\nwindow = 0.1\n";
  const Experiment experiment = with(second + "label = 'sideways'\n");
  ASSERT_EQ(experiment.objectives.size(), 3u);
  EXPECT_EQ(experiment.objectives[0].name, "distance");
  EXPECT_EQ(experiment.objectives[2].name, "sideways");
  EXPECT_EQ(read_experiment(experiment.resolved, {"record", {}}).objectives[2].name, "sideways") << "read back";
  EXPECT_THAT(complaint(second), testing::naming("fitness.2.name", "\"distance\"", "label"));
  EXPECT_THAT(complaint(second + "label = 'actuation-work'\n"),
              testing::naming("fitness.2", "\"actuation-work\"", "label"));
}

TEST(Labels, NameTheSectionsOfGenomes) {
  const std::string mutation = "\n[[mutation]]\nname = 'gaussian'\nlabel = ";
  EXPECT_THAT(with(mutation + "'small'" + mutation + "'large'\n").layout.sections,
              ::testing::IsSupersetOf({"small", "large"}));
}

/// The life of an individual with a score of each role, which grow by one in every test.
Life with_all_roles(double violation) {
  Experiment experiment = with(scenario("a", "repeat = 3\nstart_noise = 0.001"));
  double test = 0;
  const std::vector<Objective> all{{"limit", "N", true, Role::constraint},
                                   {"goal", "m"},
                                   {"place", "m", true, Role::descriptor, -1, 1},
                                   {"note", "s", true, Role::measure}};
  const auto score = [&](const Observation&) {
    ++test;
    return std::vector{violation + test, 10 + test, 20 + test, 30 + test};
  };
  score_by(experiment, {{brief, all, score}}, Over::worst);
  return lived(experiment);
}

TEST(Roles, AreSummedUpEachInItsWay) {
  const Life life = alive(with_all_roles(-3));
  EXPECT_EQ(life.result.objectives, std::vector{11.0}) << "the worst, as the experiment says";
  EXPECT_EQ(life.result.measures, (std::vector{0.0, 22.0, 31.0})) << "the worst, the mean, the worst";
  ASSERT_EQ(life.result.tests.size(), 3u) << "of the objective";
  EXPECT_EQ(life.result.tests[2].value, 13);
}

TEST(Roles, AConstraintAboveZeroEndsTheEvaluation) {
  const Life life = with_all_roles(-2.5);  // 0.5 N in the last test
  EXPECT_EQ(life.result.status, Status::invalid);
  EXPECT_THAT(life.result.reason, testing::naming("limit", "0.5 N"));
  EXPECT_TRUE(life.result.objectives.empty());
  EXPECT_EQ(life.result.measures.front(), 0.5) << "by which selection sees how far it is from feasible";
}

TEST(Roles, AreReadFromTheOperators) {
  const Override described{"fitness.2", "{name='descriptor', what='contact', settle=0.05, window=0.1}", ""};
  const Experiment experiment = with("", {described});
  EXPECT_EQ(experiment.objectives.size(), 2u);
  ASSERT_EQ(experiment.measures.size(), 1u);
  EXPECT_EQ(experiment.measures[0].name, "contact");
  EXPECT_THAT(alive(lived(experiment)).result.measures,
              ::testing::ElementsAre(::testing::AllOf(::testing::Gt(0), ::testing::Lt(1))));
  EXPECT_THAT(complaint("", {described,
                             {"fitness.0", "{name='descriptor'}", ""},
                             {"fitness.1", "{name='descriptor', label='b'}", ""}}),
              testing::naming("fitness", "objective"));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
