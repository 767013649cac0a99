// Scenarios: what they change, what they keep, and how the scores in them become one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "evolution/breeding.hpp"
#include "life/evaluation.hpp"
#include "report/filming.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

const Progress unwatched = [](double) {};

Experiment with(const std::string& scenarios, std::vector<Override> overrides = {}) {
  return testing::read(testing::small_experiment + scenarios, std::move(overrides));
}

Life lived(const Experiment& experiment, const Genome& genome = {2, 1}, std::uint32_t id = 0) {
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
  const Evaluation evaluation(experiment, *simulator);
  Matured matured = evaluation.matured(evaluation.birth.of(std::vector<Newborn>{{id, 0, &genome}}), unwatched);
  evaluation.measurement.run(matured, unwatched);
  return std::move(matured.lives.front());
}

/// What a fitness operator saw in one test.
struct Seen {
  std::string scenario;
  Body body;
  Vec3 way;
  Box box;
};

class Witness final : public Fitness {
 public:
  explicit Witness(std::vector<Seen>& seen) : seen_(seen) {}
  Request observes() const override { return {.settle = 0, .window = 0.02}; }
  std::vector<Objective> objectives() const override { return {{"number", "1"}}; }
  std::vector<double> score(const Observation& o) const override {
    seen_.push_back({std::string(o.scenario), *o.body, o.centre_after - o.centre_before, o.box});
    const std::size_t test = seen_.size();
    return {test == 4 ? 10.0 : static_cast<double>(test)};
  }

 private:
  std::vector<Seen>& seen_;
};

std::vector<Seen> seen_in(const std::string& scenarios, std::vector<Override> overrides = {}, std::uint32_t id = 0) {
  Experiment experiment = with(scenarios, std::move(overrides));
  std::vector<Seen> seen;
  experiment.fitness.clear();
  experiment.fitness.push_back({std::make_unique<Witness>(seen)});
  experiment.objectives = {{"number", "1"}};
  const Life life = lived(experiment, {2, 1}, id);
  EXPECT_TRUE(life.alive()) << life.result.reason;
  return seen;
}

TEST(Scenarios, ThatChangeNothingAreTheSceneItself) {
  const Life plain = lived(with("")), tested = lived(with("\n[[scenario]]\nname = 'as it is'\n"));
  ASSERT_TRUE(tested.alive()) << tested.result.reason;
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
  const std::string slope = "\n[[scenario]]\nname = 'slope'\n[scenario.gravity]\nslope = 12\n",
                    rough = "\n[[scenario]]\nname = 'rough'\n[scenario.floor]\nroughness = 0.03\n";
  const auto scores = [](const std::string& scenarios) {
    std::map<std::string, std::vector<double>> by_name;
    const Experiment experiment = with(scenarios);
    for (const TestScore& test : lived(experiment).result.tests)
      by_name[experiment.scenarios[test.scenario].name].push_back(test.value);
    return by_name;
  };
  auto both = scores(slope + rough), turned = scores(rough + slope);
  EXPECT_EQ(both, turned);
  EXPECT_EQ(both.at("slope"), scores(slope).at("slope"));
  EXPECT_EQ(both.at("rough"), scores(rough).at("rough"));
  EXPECT_NE(both.at("slope"), both.at("rough"));
}

TEST(Scenarios, ReplaceForces) {
  const Experiment experiment = with(R"(
[[scenario]]
name = "ice"
[scenario.friction]
coefficient = 0.01
[[scenario]]
name = "hills"
[scenario.floor]
roughness = 0.05
seed = 9
[[scenario]]
name = "mud"
[scenario.drag]
coefficient = 3
)",
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
      seen_in("\n[[scenario]]\nname = 'slide'\n[scenario.gravity]\nslope = 30\n[scenario.friction]\ncoefficient = 0\n",
              {{"scene.damping.rate", "0", ""}, {"development.cycles", "0", ""}, {"encoding.mass", "1", ""}});
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_EQ(seen[0].scenario, "slide");
  EXPECT_NEAR(seen[0].way.x, 9.81 * 0.5 / 2 * 0.02 * 0.02, 5e-5);
}

TEST(Scenarios, StillMuscles) {
  const auto seen = seen_in("\n[[scenario]]\nname = 'still'\nmuscles = false\n[[scenario]]\nname = 'moving'\n");
  ASSERT_EQ(seen.size(), 2u);
  const auto moves = [](const Body& body) {
    return std::any_of(body.materials.begin(), body.materials.end(), [](const Material& m) { return m.amplitude > 0; });
  };
  EXPECT_FALSE(moves(seen[0].body));
  EXPECT_TRUE(moves(seen[1].body));
}

TEST(Scenarios, LoadTheBody) {
  const auto seen =
      seen_in("\n[[scenario]]\nname = 'bare'\n[[scenario]]\nname = 'loaded'\n[scenario.payload]\nshare = 0.7\n",
              {{"scene.payload.share", "0.2", ""}});
  const auto weight = [](const Body& body) {
    double sum = 0;
    for (const Mass& mass : body.masses) sum += mass.mass;
    return sum;
  };
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_NEAR(weight(seen[0].body), 12 * 0.2 * 1.2, 1e-12);
  EXPECT_NEAR(weight(seen[1].body), 12 * 0.2 * 1.7, 1e-12) << "in place of the scene's load";
}

TEST(Scenarios, DamageTheSameInAllIndividualsAndOtherwiseInEveryRepeat) {
  const std::string damage = "\n[[scenario]]\nname = 'hurt'\ndamage = 0.2\nrepeat = 3\n";
  const auto whole = seen_in("", {{"development.cycles", "0", ""}}),
             one = seen_in(damage, {{"development.cycles", "0", ""}}, 0),
             other = seen_in(damage, {{"development.cycles", "0", ""}}, 5);
  ASSERT_EQ(one.size(), 3u);
  const std::size_t springs = whole[0].body.springs.size(), left = springs - std::lround(0.2 * double(springs));
  const auto pairs = [](const Body& body) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> joined;
    for (const Spring& spring : body.springs) joined.insert({spring.a, spring.b});
    return joined;
  };
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LE(one[i].body.springs.size(), left) << "and those of pieces that come off";
    EXPECT_GE(one[i].body.springs.size(), left / 2);
    EXPECT_EQ(pairs(one[i].body), pairs(other.at(i).body));
  }
  EXPECT_FALSE(pairs(one[0].body) == pairs(one[1].body) && pairs(one[1].body) == pairs(one[2].body));
}

/// A fitness operator that sees every mass.
class Counter final : public Fitness {
 public:
  explicit Counter(std::vector<std::vector<std::uint32_t>>& numbers) : numbers_(numbers) {}
  Request observes() const override {
    return {.settle = 0, .window = 0.02, .rate = 50, .channels = {.positions = true}};
  }
  std::vector<Objective> objectives() const override { return {{"masses", "1"}}; }
  std::vector<double> score(const Observation& o) const override {
    const auto numbers = o.samples.numbers(1);
    numbers_.emplace_back(numbers.begin(), numbers.end());
    EXPECT_EQ(numbers.size(), o.samples.body(1).masses.size());
    EXPECT_EQ(numbers.size(), o.body->masses.size());
    return {static_cast<double>(numbers.size())};
  }

 private:
  std::vector<std::vector<std::uint32_t>>& numbers_;
};

TEST(Scenarios, LeaveTheMassesTheirNumbers) {
  Experiment experiment =
      with("\n[[scenario]]\nname = 'whole'\n[[scenario]]\nname = 'hurt'\ndamage = 0.6\nrepeat = 4\n");
  std::vector<std::vector<std::uint32_t>> numbers;
  experiment.fitness.clear();
  experiment.fitness.push_back({std::make_unique<Counter>(numbers)});
  experiment.objectives = {{"masses", "1"}};
  const Genome genome{2, 1};
  const Life life = lived(experiment, genome);
  ASSERT_TRUE(life.alive()) << life.result.reason;
  ASSERT_EQ(numbers.size(), 5u);
  EXPECT_EQ(numbers[0].size(), 12u);
  std::size_t least = 12;
  for (const auto& hurt : numbers) {
    EXPECT_THAT(numbers[0], ::testing::IsSupersetOf(hurt));
    least = std::min(least, hurt.size());
  }
  EXPECT_LT(least, 12u) << "pieces come off";

  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
  for (std::int64_t repeat = 0; repeat < 4; ++repeat) {
    const Film film =
        film_lives(experiment, *simulator, std::vector<Newborn>{{0, 0, &genome}}, {1, repeat}).front().film;
    ASSERT_EQ(film.size(), 3u) << "two cycles and the window";
    EXPECT_EQ(film.back().numbers, numbers[static_cast<std::size_t>(1 + repeat)]);
    EXPECT_EQ(film.back().body.masses.size(), film.back().numbers.size());
  }
}

TEST(Scenarios, ShakeTheStart) {
  const auto seen =
      seen_in("\n[[scenario]]\nname = 'calm'\n[[scenario]]\nname = 'shaken'\nstart_noise = 0.01\nrepeat = 2\n");
  ASSERT_EQ(seen.size(), 3u);
  for (std::size_t i = 1; i < 3; ++i) {
    EXPECT_FALSE(seen[i].box.high == seen[0].box.high);
    EXPECT_NEAR(seen[i].box.longest_side(), seen[0].box.longest_side(), 0.03);
  }
  EXPECT_FALSE(seen[1].box.high == seen[2].box.high);
}

TEST(Scenarios, AreSummedUpAsTheExperimentSays) {
  const std::string four = "\n[[scenario]]\nname = 'a'\nrepeat = 3\n[[scenario]]\nname = 'b'\n";
  for (const auto& [over, expected] : {std::pair{Over::mean, 4.0}, {Over::worst, 1.0}, {Over::median, 2.5}}) {
    Experiment experiment = with(four);
    std::vector<Seen> seen;
    experiment.fitness.clear();
    experiment.fitness.push_back({std::make_unique<Witness>(seen), over});  // scores 1, 2, 3, 10
    experiment.objectives = {{"number", "1", true}};
    EXPECT_EQ(lived(experiment).result.objectives, std::vector{expected});
    experiment.objectives[0].maximise = false;
    seen.clear();
    EXPECT_EQ(lived(experiment).result.objectives, std::vector{over == Over::worst ? 10.0 : expected});
  }
  const Experiment read = with(four, {{"fitness.0.over", "worst", ""}});
  EXPECT_EQ(read.fitness.at(0).over, Over::worst);
  EXPECT_EQ(read.fitness.at(1).over, Over::mean);
}

/// Scores near the largest number.
struct Enormous final : Fitness {
  Request observes() const override { return {.settle = 0, .window = 0.02}; }
  std::vector<Objective> objectives() const override { return {{"size", "1"}}; }
  std::vector<double> score(const Observation&) const override { return {std::numeric_limits<double>::max()}; }
};

TEST(Scenarios, AreNotSummedUpToInfinity) {
  Experiment experiment = with("\n[[scenario]]\nname = 'a'\nrepeat = 2\n");
  experiment.fitness.clear();
  experiment.fitness.push_back({std::make_unique<Enormous>(), Over::mean});
  experiment.objectives = {{"size", "1", true}};
  const Result mean = lived(experiment).result;
  EXPECT_EQ(mean.status, Status::invalid);
  EXPECT_THAT(mean.reason, testing::naming("mean", "size"));
  EXPECT_TRUE(mean.objectives.empty());
  experiment.fitness[0].over = Over::median;
  EXPECT_EQ(lived(experiment).result.objectives, std::vector{std::numeric_limits<double>::max()});
}

TEST(Scenarios, OneAloneMayCount) {
  const std::string four = "\n[[scenario]]\nname = 'a'\nrepeat = 3\n[[scenario]]\nname = 'b'\n";
  for (const auto& [scenario, expected] : {std::pair<std::size_t, double>{0, 2.0}, {1, 10.0}}) {
    Experiment experiment = with(four);
    std::vector<Seen> seen;
    experiment.fitness.clear();
    experiment.fitness.push_back({std::make_unique<Witness>(seen), Over::mean, scenario});  // scores 1, 2, 3, 10
    experiment.objectives = {{"number", "1", true}};
    const Life life = lived(experiment);
    EXPECT_EQ(life.result.objectives, std::vector{expected});
    EXPECT_EQ(life.result.tests.size(), 4u) << "the others are measured all the same";
  }
}

TEST(Scenarios, OneAloneIsNamedByTheKeyOver) {
  const std::string two = "\n[[scenario]]\nname = 'flat'\n[[scenario]]\nname = 'slope'\n";
  const Experiment read = with(two, {{"fitness.0.over", "slope", ""}});
  EXPECT_EQ(read.fitness.at(0).scenario, 1u);
  EXPECT_FALSE(read.fitness.at(1).scenario.has_value());
  EXPECT_EQ(testing::read(read.resolved).fitness.at(0).scenario, 1u) << "the record says it too";
  EXPECT_THAT(
      [&] {
        with(two, {{"fitness.0.over", "slop", "--set"}});
      },
      ::testing::ThrowsMessage<ConfigError>(testing::naming("--set: fitness.0.over ", "slop", "slope")));
  EXPECT_THAT(
      [&] {
        with("", {{"fitness.0.over", "flat", "--set"}});
      },
      ::testing::ThrowsMessage<ConfigError>(testing::naming("--set: fitness.0.over ", "flat", "median")));
  for (const char* name : {"mean", "worst", "median"})
    EXPECT_THAT(
        [&] {
          with(two, {{"scenario.1.name", name, "--set"}});
        },
        ::testing::ThrowsMessage<ConfigError>(testing::naming("--set: scenario.1.name ", name, "another name")));
}

TEST(Scenarios, ThatFailAreNamed) {
  const Experiment experiment = with(R"(
[[scenario]]
name = "flat"
[[scenario]]
name = "storm"
repeat = 2
[scenario.gravity]
acceleration = 1000
[scenario.drag]
coefficient = 1e6
)");
  const Life life = lived(experiment, {2, 2});
  EXPECT_EQ(life.result.status, Status::diverged);
  EXPECT_THAT(life.result.reason, testing::at_place("scenario \"storm\", repeat 1: "));
  EXPECT_GT(life.result.ended_at, 0.1) << "since birth";
  EXPECT_TRUE(life.result.objectives.empty());

  const Life stiff = lived(with("\n[[scenario]]\nname = 'rock'\n[scenario.floor]\nstiffness = 1e9\n"));
  EXPECT_EQ(stiff.result.status, Status::invalid);
  EXPECT_THAT(stiff.result.reason, testing::at_place("scenario \"rock\": unstable dt: "));
}

const std::string muddy = "\n[[scenario]]\nname = 'mud'\ndevelops = true\n[scenario.drag]\ncoefficient = 3\n";

TEST(Scenarios, ThatDevelopAreLivesInTheirSceneFromBirthOn) {
  const Life there = lived(with("", {{"scene.drag.coefficient", "3", ""}}));
  const Life here = lived(with("")), both = lived(with(muddy));
  ASSERT_TRUE(both.alive()) << both.result.reason;
  EXPECT_EQ(both.result.objectives, there.result.objectives);
  EXPECT_NE(both.result.objectives, here.result.objectives);
  EXPECT_EQ(both.result.record, here.result.record) << "the record is of the life in the experiment's own scene";
  EXPECT_GT(both.result.spring_evaluations, there.result.spring_evaluations) << "it developed in both scenes";
  const Life matured_here = lived(with("\n[[scenario]]\nname = 'mud'\n[scenario.drag]\ncoefficient = 3\n"));
  EXPECT_NE(both.result.objectives, matured_here.result.objectives);
}

TEST(Scenarios, ThatDevelopCarryTheirLoadFromBirthOn) {
  const std::string loaded = "\n[[scenario]]\nname = 'load'\ndevelops = true\n[scenario.payload]\nshare = 0.7\n";
  EXPECT_EQ(lived(with(loaded)).result.objectives,
            lived(with("", {{"scene.payload.share", "0.7", ""}})).result.objectives);
}

TEST(Scenarios, ThatDevelopMayBeginWithNoiseAndDamage) {
  const std::string hurt = "repeat = 3\ndamage = 0.2\nstart_noise = 0.01\ndevelops = ";
  const auto scores = [&](const std::string& develops) {
    std::vector<double> values;
    for (const TestScore& test : lived(with("\n[[scenario]]\nname = 'hurt'\n" + hurt + develops + "\n")).result.tests)
      values.push_back(test.value);
    return values;
  };
  EXPECT_EQ(scores("true").size(), 6u);
  EXPECT_EQ(scores("true"), scores("false")) << "it is the same scene, and noise and damage begin after maturing";
}

TEST(Scenarios, ThatDevelopHoldTheWindowsWithinTheLife) {
  Experiment experiment = with("\n[[scenario]]\nname = 'matured'\n" + muddy);
  struct Grower final : Fitness {
    explicit Grower(std::vector<std::string>& scenarios) : seen_in(scenarios) {}
    Request observes() const override { return {.settle = 0, .window = 0.08, .cycle = 0}; }
    std::vector<Objective> objectives() const override { return {{"way", "m", true}}; }
    std::vector<double> score(const Observation& o) const override {
      seen_in.emplace_back(o.scenario);
      return {norm(o.centre_after - o.centre_before)};
    }
    std::vector<std::string>& seen_in;
  };
  std::vector<std::string> seen_in;
  std::vector<Seen> seen;
  experiment.fitness.clear();
  experiment.fitness.push_back({std::make_unique<Grower>(seen_in)});
  experiment.fitness.push_back({std::make_unique<Witness>(seen)});
  experiment.objectives = {{"way", "m", true}, {"number", "1", true}};
  const Life life = lived(experiment);
  ASSERT_TRUE(life.alive()) << life.result.reason;
  EXPECT_EQ(seen_in, (std::vector<std::string>{"", "mud"}));
  ASSERT_EQ(life.result.tests.size(), 3u) << "one window in the first scenario, and two in the second one";
  EXPECT_EQ(life.result.tests[1].value, life.result.objectives[0]) << "the way in the scenario that develops";
}

TEST(Scenarios, ThatDevelopAreNamedWhereALifeFails) {
  const Life life = lived(with("\n[[scenario]]\nname = 'rock'\ndevelops = true\n[scenario.floor]\nstiffness = 1e9\n"));
  EXPECT_EQ(life.result.status, Status::invalid);
  EXPECT_THAT(life.result.reason, testing::at_place("scenario \"rock\": unstable dt: "));
  EXPECT_TRUE(life.result.objectives.empty());
}

TEST(Scenarios, ThatDevelopGiveTheSameInAnyBatch) {
  const Experiment experiment = with("\n[[scenario]]\nname = 'flat'\n" + muddy);
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 2);
  const std::vector<Individual> individuals = breed(experiment, {}, 0, 0, 6);
  std::vector<Newborn> newborns;
  for (const Individual& individual : individuals) newborns.push_back({individual.id, 0, &individual.genome});
  const std::vector<Result> together = Evaluation(experiment, *simulator).evaluate(newborns, unwatched);
  for (std::size_t i = 0; i < newborns.size(); ++i) {
    const Life alone = lived(experiment, individuals[i].genome, newborns[i].id);
    EXPECT_EQ(together[i].objectives, alone.result.objectives);
    EXPECT_EQ(together[i].spring_evaluations, alone.result.spring_evaluations);
  }
}

TEST(Scenarios, ThatDevelopAreFilmedFromBirthOn) {
  const Experiment experiment = with(muddy), there = with("", {{"scene.drag.coefficient", "3", ""}});
  const Genome genome{2, 1};
  const auto filmed = [&](const Experiment& of) {
    const auto simulator = make_cpu_simulator(of.scene, of.stepping, 1);
    return film_lives(of, *simulator, std::vector<Newborn>{{0, 0, &genome}}).front();
  };
  const FilmedLife film = filmed(experiment), film_there = filmed(there);
  EXPECT_EQ(film.result.objectives, lived(experiment).result.objectives);
  ASSERT_EQ(film.film.size(), film_there.film.size());
  for (std::size_t shot = 0; shot < film.film.size(); ++shot)
    EXPECT_EQ(film.film[shot].frames.back().positions, film_there.film[shot].frames.back().positions);
}

TEST(Scenarios, WithFaultsAreRefused) {
  const auto told = [](const std::string& scenarios) {
    try {
      with(scenarios);
    } catch (const ConfigError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(told("\n[[scenario]]\nrepeat = 2\n"), testing::at_place("test.toml:50:1", "name"));
  EXPECT_THAT(told("\n[[scenario]]\nname = ''\n"), testing::naming("scenario.0.name"));
  EXPECT_THAT(told("\n[[scenario]]\nname = 'a'\n[[scenario]]\nname = 'a'\n"),
              testing::naming("scenario.1.name", "\"a\""));
  EXPECT_THAT(told("\n[[scenario]]\nname = 'a'\ndamage = 1.5\n"), testing::naming("scenario.0.damage", "1.5", "0.99"));
  EXPECT_THAT(told("\n[[scenario]]\nname = 'a'\ndamag = 0.5\n"), testing::naming("damag", "damage"));
  EXPECT_THAT(told("\n[[scenario]]\nname = 'a'\n[scenario.gravity]\nslop = 5\n"), testing::naming("slop", "slope"));
  EXPECT_THAT(told("\n[[scenario]]\nname = 'a'\nstart_noise = nan\n"), testing::naming("scenario.0.start_noise"));
}

TEST(Labels, TellTwoUsesOfOneOperatorApart) {
  const std::string second = "\n[[fitness]]\nname = 'distance'\ndirection = [0, 1, 0]\nsettle = 0.05\nwindow = 0.1\n";
  const Experiment experiment = with(second + "label = 'sideways'\n");
  ASSERT_EQ(experiment.objectives.size(), 3u);
  EXPECT_EQ(experiment.objectives[0].name, "distance");
  EXPECT_EQ(experiment.objectives[2].name, "sideways");
  EXPECT_EQ(read_experiment(experiment.resolved, {"record", {}}).objectives[2].name, "sideways") << "read back";
  EXPECT_THAT([&] { with(second); },
              ::testing::ThrowsMessage<ConfigError>(testing::naming("fitness.2.name", "\"distance\"", "label")));
  EXPECT_THAT([&] { with(second + "label = 'actuation-work'\n"); },
              ::testing::ThrowsMessage<ConfigError>(testing::naming("fitness.2", "\"actuation-work\"", "label")));
}

TEST(Labels, NameTheSectionsOfGenomes) {
  const std::string mutations = R"(
[[mutation]]
name = "gaussian"
label = "small"
[[mutation]]
name = "gaussian"
label = "large"
)";
  const Experiment experiment = with(mutations);
  EXPECT_THAT(experiment.layout.sections, ::testing::IsSupersetOf({"small", "large"}));
}

/// A fitness operator with a score of each role; they grow by one in every test.
class AllRoles final : public Fitness {
 public:
  explicit AllRoles(double violation) : violation_(violation) {}
  Request observes() const override { return {.settle = 0, .window = 0.02}; }
  std::vector<Objective> objectives() const override {
    return {{"limit", "N", true, Role::constraint},
            {"goal", "m"},
            {"place", "m", true, Role::descriptor, -1, 1},
            {"note", "s", true, Role::measure}};
  }
  std::vector<double> score(const Observation&) const override {
    const double test = ++tests_;
    return {violation_ + test, 10 + test, 20 + test, 30 + test};
  }

 private:
  double violation_;
  mutable int tests_ = 0;
};

Life with_all_roles(double violation) {
  Experiment experiment = with("\n[[scenario]]\nname = 'a'\nrepeat = 3\n");
  experiment.fitness.clear();
  experiment.fitness.push_back({std::make_unique<AllRoles>(violation), Over::worst});
  const std::vector<Objective> all = experiment.fitness[0].op->objectives();
  experiment.objectives = {all[1]};
  experiment.measures = {all[0], all[2], all[3]};
  return lived(experiment);
}

TEST(Roles, AreSummedUpEachInItsWay) {
  const Life life = with_all_roles(-3);
  ASSERT_TRUE(life.alive()) << life.result.reason;
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
  const std::string described = "\n[[fitness]]\nname = 'descriptor'\nwhat = 'contact'\nsettle = 0.05\nwindow = 0.1\n";
  const Experiment experiment = with(described);
  EXPECT_EQ(experiment.objectives.size(), 2u);
  ASSERT_EQ(experiment.measures.size(), 1u);
  EXPECT_EQ(experiment.measures[0].name, "contact");
  const Life life = lived(experiment);
  ASSERT_TRUE(life.alive()) << life.result.reason;
  ASSERT_EQ(life.result.measures.size(), 1u);
  EXPECT_GT(life.result.measures[0], 0);
  EXPECT_LT(life.result.measures[0], 1);
  EXPECT_THAT(
      [&] {
        with(described,
             {{"fitness.0", "{name='descriptor'}", ""}, {"fitness.1", "{name='descriptor', label='b'}", ""}});
      },
      ::testing::ThrowsMessage<ConfigError>(testing::naming("fitness", "objective")));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
