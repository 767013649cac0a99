// Evaluations: results do not depend on the other bodies or on the number of threads, and failures have a reason.
#include "life/evaluation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "evolution/breeding.hpp"
#include "life/body_building.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

const Progress unwatched = [](double) {};

std::vector<Result> evaluate(const Experiment& experiment, const std::vector<Individual>& individuals,
                             int threads = 1) {
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, threads);
  std::vector<Newborn> newborns;
  for (const Individual& individual : individuals)
    newborns.push_back({individual.id, individual.born, &individual.genome});
  return Evaluation(experiment, *simulator).evaluate(newborns, unwatched);
}

void expect_equal(const Result& a, const Result& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.reason, b.reason);
  EXPECT_EQ(a.objectives, b.objectives);
  EXPECT_EQ(a.spring_evaluations, b.spring_evaluations);
}

TEST(Evaluation, DoesNotDependOnThreadsOrCompanyOrOrder) {
  Experiment experiment = testing::read(testing::small_experiment);
  std::vector<Individual> individuals = breed(experiment, {}, 0, 0, 24);
  const std::vector<Result> together = evaluate(experiment, individuals);
  const auto ok =
      std::count_if(together.begin(), together.end(), [](const Result& r) { return r.status == Status::ok; });
  ASSERT_GE(ok, 8) << "there must be something to compare";

  experiment.threads = 8;
  const std::vector<Result> threaded = evaluate(experiment, individuals, 8);
  for (std::size_t i = 0; i < together.size(); ++i) {
    expect_equal(together[i], threaded[i]);
    expect_equal(together[i], evaluate(experiment, {individuals[i]}).front());
  }
  std::reverse(individuals.begin(), individuals.end());
  std::vector<Result> reversed = evaluate(experiment, individuals);
  std::reverse(reversed.begin(), reversed.end());
  for (std::size_t i = 0; i < together.size(); ++i) expect_equal(together[i], reversed[i]);
}

TEST(Evaluation, DevelopmentDependsOnTheIndividualsOwnNumbers) {
  const Experiment experiment = testing::read(testing::small_experiment, {{"encoding.size", "[3, 2, 2]", ""}});
  std::vector<Individual> twins = breed(experiment, {}, 0, 0, 1);
  twins.push_back(twins.front());
  twins.back().id = 1;
  const std::vector<Result> results = evaluate(experiment, twins);
  ASSERT_EQ(results[0].status, Status::ok);
  EXPECT_NE(results[0].objectives, results[1].objectives) << "springs come at random places";
}

TEST(Evaluation, CountsEverySpringOfEveryStep) {
  const Experiment experiment = testing::read(testing::small_experiment);
  const Individual full{.genome = {1, 1}};  // both voxels of bone: 12 masses, 28 + 28 - 6 springs
  const Result result = evaluate(experiment, {full}).front();
  ASSERT_EQ(result.status, Status::ok) << result.reason;
  EXPECT_EQ(result.spring_evaluations, 50u * (2 * 100 + 100 + 200));
}

TEST(Evaluation, ABodyWithoutMusclesDoesNoWork) {
  const Experiment experiment = testing::read(testing::small_experiment);
  const auto works = [&](float material) {
    return evaluate(experiment, {{.genome = {material, material}}})[0].objectives;
  };
  EXPECT_EQ(works(1)[1], 0) << "bone";
  EXPECT_GT(works(2)[1], 0) << "muscle";
}

TEST(Evaluation, AllAirIsInvalidAndDisturbsNobody) {
  const Experiment experiment = testing::read(testing::small_experiment);
  const Individual air{.id = 0, .genome = {0, 0}}, bone{.id = 1, .genome = {1, 1}};
  const std::vector<Result> results = evaluate(experiment, {air, bone});
  EXPECT_EQ(results[0].status, Status::invalid);
  EXPECT_NE(results[0].reason, "");
  EXPECT_TRUE(results[0].objectives.empty());
  expect_equal(results[1], evaluate(experiment, {bone}).front());
}

/// The time step is too long for this drag: a force that grows with the square of the speed overshoots.
TEST(Evaluation, ADivergedBodyIsToldWithTimeAndReason) {
  const Experiment experiment = testing::read(
      testing::small_experiment, {{"scene.drag.coefficient", "1e6", ""}, {"scene.gravity.acceleration", "1000", ""}});
  const Result result = evaluate(experiment, {{.genome = {2, 2}}}).front();
  EXPECT_EQ(result.status, Status::diverged);
  EXPECT_GT(result.ended_at, 0);
  EXPECT_LE(result.ended_at, 0.25);
  EXPECT_NE(result.reason, "");
  EXPECT_TRUE(result.objectives.empty());
}

/// A fitness operator that returns a given value.
class Constant final : public Fitness {
 public:
  explicit Constant(double value) : value_(value) {}
  Request observes() const override { return {.settle = 0, .window = 0.01}; }
  std::vector<Objective> objectives() const override { return {{"constant", "1", true}}; }
  std::vector<double> score(const Observation&) const override { return {value_}; }

 private:
  double value_;
};

TEST(Evaluation, AFitnessThatIsNotANumberIsNoFitness) {
  Experiment experiment = testing::read(testing::small_experiment);
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    experiment.fitness.clear();
    experiment.fitness.push_back({std::make_unique<Constant>(value)});
    experiment.objectives = experiment.fitness[0].op->objectives();
    const Result result = evaluate(experiment, {{.genome = {1, 1}}}).front();
    EXPECT_EQ(result.status, Status::invalid);
    EXPECT_THAT(result.reason, testing::naming("not finite", "constant"));
    EXPECT_TRUE(result.objectives.empty());
  }
}

/// A fitness operator that stores the observation of its window.
class Watcher final : public Fitness {
 public:
  Watcher(Request request, Observation& seen) : request_(request), seen_(seen) {}
  Request observes() const override { return request_; }
  std::vector<Objective> objectives() const override { return {{"seen", "1", true}}; }
  std::vector<double> score(const Observation& observation) const override {
    seen_ = observation;
    return {0};
  }

 private:
  Request request_;
  Observation& seen_;
};

TEST(Evaluation, EveryFitnessSeesItsOwnWindow) {
  Experiment experiment = testing::read(testing::small_experiment);
  experiment.development = {};
  experiment.scene = {};
  experiment.scene.gravity = Gravity{};  // the body only falls: z = -g t^2 / 2
  Observation early, late, whole;
  const auto observe = [&](Request request, Observation& seen) {
    experiment.fitness.push_back({std::make_unique<Watcher>(request, seen)});
  };
  experiment.fitness.clear();
  observe({.settle = 0.1, .window = 0.2}, early);
  observe({.settle = 0.2, .window = 0.3}, late);
  observe({.settle = 0, .window = 0.5, .work = true}, whole);
  experiment.objectives = {{"a", "", true}, {"b", "", true}, {"c", "", true}};
  ASSERT_EQ(evaluate(experiment, {{.genome = {2, 2}}}).front().status, Status::ok);
  const auto fallen = [](const Observation& seen) { return seen.centre_before.z - seen.centre_after.z; };
  EXPECT_NEAR(fallen(early), 9.81 / 2 * (0.3 * 0.3 - 0.1 * 0.1), 2e-3);
  EXPECT_NEAR(fallen(late), 9.81 / 2 * (0.5 * 0.5 - 0.2 * 0.2), 2e-3);
  EXPECT_NEAR(fallen(whole), 9.81 / 2 * 0.25, 2e-3);
  EXPECT_THROW(static_cast<void>(static_cast<double>(early.work)), std::logic_error) << "nobody asked for it";
  EXPECT_GT(whole.work, 0);
  EXPECT_NEAR(whole.box.longest_side(), 1, 1e-6) << "two voxels of half a metre";
}

TEST(Evaluation, ABodysOwnStepEndsWithItsWindow) {
  // the body only falls; a first-order method overshoots the path by g t dt/2
  Experiment experiment = testing::read(testing::small_experiment, {{"simulation.dt", "auto", ""}});
  experiment.scene = {};
  experiment.scene.gravity = Gravity{};
  experiment.development.cycle_time = 0.0513;  // not a multiple of any step
  Observation seen;
  experiment.fitness.clear();
  experiment.fitness.push_back({std::make_unique<Watcher>(Request{.settle = 0.1, .window = 0.2, .work = true}, seen)});
  experiment.objectives = {{"a", "", true}};
  const Result result = evaluate(experiment, {{.genome = {2, 2}}}).front();
  ASSERT_EQ(result.status, Status::ok) << result.reason;
  const double from = 2 * 0.0513 + 0.1, to = from + 0.2;
  EXPECT_NEAR(seen.centre_before.z - seen.centre_after.z, 9.81 / 2 * (to * to - from * from), 9.81 * 0.2 * 0.005);
  EXPECT_LT(result.spring_evaluations, 50u * 806) << "fewer steps than of 0.5 ms";
  EXPECT_GT(result.spring_evaluations, 50u * 40);
}

TEST(Evaluation, AnUnstableBodyIsInvalidOrRunsAsTheFileAsks) {
  const auto status = [](const char* unstable) {
    const Experiment experiment = testing::read(
        testing::small_experiment, {{"materials.bone.stiffness", "1e6", ""}, {"simulation.unstable", unstable, ""}});
    return evaluate(experiment, {{.genome = {1, 1}}}).front();
  };
  EXPECT_EQ(status("invalid").status, Status::invalid);
  EXPECT_THAT(status("invalid").reason, testing::at_place("unstable dt: ", "0.0005 s", "springs"));
  EXPECT_EQ(status("invalid").spring_evaluations, 0u);
  EXPECT_GT(status("run").spring_evaluations, 0u);
  EXPECT_NE(status("run").status, Status::invalid);
}

/// Makes all springs a thousand times stiffer, by changing them or by exchanging them for others.
struct Stiffener final : Devo {
  explicit Stiffener(bool by_exchange) : exchanges(by_exchange) {}

  void develop(const DevoContext& context, Edits& edits, Rng&) const override {
    for (std::uint32_t i = 0; i < context.body.springs.size(); ++i) {
      Material material = context.body.materials[context.body.springs[i].material];
      material.stiffness *= 1000;
      if (exchanges) {
        edits.removed_springs.push_back(i);
        edits.new_springs.push_back({context.body.springs[i].a, context.body.springs[i].b, material, {}});
      } else {
        edits.changed_springs.push_back({.spring = i, .material = material});
      }
    }
  }

  bool exchanges;  ///< whether springs are exchanged instead of changed
};

TEST(Evaluation, DevelopmentChangesTheStep) {
  Experiment experiment = testing::read(testing::small_experiment, {{"simulation.dt", "auto", ""}});
  experiment.development.cycles = 1;
  const auto result_with = [&](bool by_exchange) {
    experiment.devo[0].op = std::make_unique<Stiffener>(by_exchange);
    return evaluate(experiment, {{.genome = {1, 1}}}).front();
  };
  const Result exchanged = result_with(true), changed = result_with(false);
  EXPECT_EQ(exchanged.status, Status::ok) << exchanged.reason;
  EXPECT_EQ(changed.status, Status::ok) << changed.reason;
  experiment.devo.clear();
  const Result soft = evaluate(experiment, {{.genome = {1, 1}}}).front();
  EXPECT_EQ(soft.status, Status::ok) << soft.reason;
  EXPECT_GT(exchanged.spring_evaluations, 4 * soft.spring_evaluations) << "the steps that follow are shorter";
  EXPECT_GT(changed.spring_evaluations, 4 * soft.spring_evaluations);
}

TEST(Evaluation, DevelopmentThatAFixedStepCannotBearIsInvalid) {
  Experiment experiment = testing::read(testing::small_experiment);
  experiment.devo[0].op = std::make_unique<Stiffener>(false);
  const Result result = evaluate(experiment, {{.genome = {1, 1}}}).front();
  EXPECT_EQ(result.status, Status::invalid);
  EXPECT_THAT(result.reason, testing::at_place("unstable dt: ", "0.0005 s", "springs"));
}

TEST(Evaluation, ALoadSinksTheFasterInWater) {
  // terminal speed, at which weight and drag are equal: M g = 12 c v^2
  Experiment experiment = testing::read(
      testing::small_experiment,
      {{"scene.payload.share", "3", ""}, {"scene.payload.top", "1", ""}, {"scene.drag.coefficient", "0.5", ""}});
  experiment.development = {};
  experiment.scene.floor.reset();
  experiment.scene.friction.reset();
  experiment.scene.damping.reset();
  Observation seen;
  experiment.fitness.clear();
  experiment.fitness.push_back({std::make_unique<Watcher>(Request{.settle = 2, .window = 0.5}, seen)});
  experiment.objectives = {{"a", "", true}};
  const auto speed = [&] {
    EXPECT_EQ(evaluate(experiment, {{.genome = {1, 1}}}).front().status, Status::ok);
    return (seen.centre_before.z - seen.centre_after.z) / 0.5;
  };
  const double unloaded = std::sqrt(12 * 0.2 * 9.81 / (12 * 0.5));
  EXPECT_NEAR(speed(), 2 * unloaded, 0.01 * unloaded);
  experiment.payload.reset();
  EXPECT_NEAR(speed(), unloaded, 0.01 * unloaded);
}

/// Makes every spring three times as long.
struct Stretcher final : Devo {
  void develop(const DevoContext& context, Edits& edits, Rng&) const override {
    for (std::uint32_t i = 0; i < context.body.springs.size(); ++i)
      edits.changed_springs.push_back({.spring = i, .rest_length = 3 * context.body.springs[i].rest_length});
  }
};

/// Lets every spring grow to three times its length.
struct Grower final : Devo {
  void develop(const DevoContext&, Edits& edits, Rng&) const override { edits.growth = {0, 1}; }
};

TEST(Evaluation, TheEnergyThatGrowthBringsIsAllowed) {
  Experiment experiment = testing::read(testing::small_experiment);
  experiment.development.cycles = 1;
  const Genome genome = {1, 1};
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
  const auto start_energy = [&](std::unique_ptr<Devo> op) {
    experiment.devo[0].op = std::move(op);
    const Evaluation evaluation(experiment, *simulator);
    std::vector<Life> lives = evaluation.birth.of(std::vector<Newborn>{{0, 0, &genome}});
    for (Spring& spring : lives[0].living.body.springs) spring.growth = 3;
    evaluation.development.run(lives, unwatched);
    return lives[0].living.state.start_energy;
  };
  const double stretched = start_energy(std::make_unique<Stretcher>());
  EXPECT_NEAR(start_energy(std::make_unique<Grower>()), stretched, 1e-12 * stretched);
}

TEST(Evaluation, ABodysLengthIsThatOfTheStartOfTheWindow) {
  Experiment experiment = testing::read(testing::small_experiment);
  experiment.scene.gravity.reset();
  experiment.scene.damping->rate = 100;  // so that the body soon reaches its new length
  experiment.devo[0].op = std::make_unique<Stretcher>();
  experiment.development.cycles = 1;
  Observation born, grown;
  experiment.fitness.clear();
  experiment.fitness.push_back({std::make_unique<Watcher>(Request{.settle = 0, .window = 1}, born)});
  experiment.fitness.push_back({std::make_unique<Watcher>(Request{.settle = 1, .window = 1}, grown)});
  experiment.objectives = {{"a", "", true}, {"b", "", true}};
  const Result result = evaluate(experiment, {{.genome = {1, 1}}}).front();
  ASSERT_EQ(result.status, Status::ok) << result.reason;
  EXPECT_NEAR(born.box.longest_side(), 1, 0.05) << "development has just ended: two voxels of half a metre";
  EXPECT_NEAR(grown.box.longest_side(), 3, 0.05);
}

/// An experiment with ballistic growth in those of its four cycles that `schedule` selects.
Experiment ballistic(const std::string& encoding, const std::string& schedule) {
  std::string text = testing::small_experiment;
  const auto replace = [&](const char* from, const char* to, const std::string& by) {
    const std::size_t first = text.find(from);
    text.replace(first, text.find(to, first) - first, by);
  };
  replace("[encoding]", "[[mutation]]", R"([encoding]
points = 40
neighbours = 6
materials = ["bone", "muscle"]
size_range = 0.25
)" + encoding);
  replace("[[development.operator]]", "[[fitness]]",
          "[[development.operator]]\nname = 'ballistic-growth'\n" + schedule + "\n");
  return testing::read(text, {{"development.cycles", "4", ""}});
}

/// The cycles in which the body changed.
std::set<std::uint32_t> cycles_of_change(const Life& life) {
  std::set<std::uint32_t> cycles;
  for (const Change& change : LifeRecord(life.result.record.bytes()).changes()) cycles.insert(change.cycle);
  return cycles;
}

TEST(Evaluation, BallisticSpringsHaveTheLengthsThatANetworkGivesThem) {
  const std::pair<const char*, std::set<std::uint32_t>> schedules[] = {
      {"", {1, 2, 3, 4}}, {"to = 2", {1, 2}}, {"from = 3", {3, 4}}, {"every = 3", {1, 4}}, {"from = 2\nto = 2", {2}}};
  for (const std::string network : {"name = 'neural'\n", "name = 'cppn'\n"})
    for (const std::string pairing : {"pairing = 'after-mapping'\n", "pairing = 'before-mapping'\n"})
      for (const auto& [schedule, cycles] : schedules) {
        SCOPED_TRACE(network + pairing + schedule);
        const Experiment experiment = ballistic(network + pairing, schedule);
        const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
        const Individual individual = breed(experiment, {}, 0, 0, 1).front();
        const Blueprint blueprint = decoded(experiment, individual.genome);
        const std::vector<std::uint32_t> kept = build_body(blueprint).kept;
        const auto expect_lengths = [&](const Body& body, double Size::*size, double tolerance) {
          ASSERT_GT(body.springs.size(), 100u);
          for (const Spring& spring : body.springs) {
            const std::uint32_t a = kept.at(spring.a), b = kept.at(spring.b);
            const double distance = norm(blueprint.body.masses[a].rest - blueprint.body.masses[b].rest);
            const double expected = distance * (blueprint.sizes[a].*size + blueprint.sizes[b].*size) / 2;
            ASSERT_NEAR(spring.rest_length, expected, tolerance);
          }
        };
        const Evaluation evaluation(experiment, *simulator);
        std::vector<Life> lives = evaluation.birth.of(std::vector<Newborn>{{0, 0, &individual.genome}});
        expect_lengths(lives[0].living.body, &Size::start, 1e-12);
        evaluation.development.run(lives, unwatched);
        ASSERT_TRUE(lives[0].alive()) << lives[0].result.reason;
        expect_lengths(lives[0].living.body, &Size::end, 1e-6);
        EXPECT_EQ(cycles_of_change(lives[0]), cycles);
      }
}

TEST(Evaluation, PhasesGoFromThoseAtBirthToThoseAtTheEndWhateverTheSchedule) {
  const std::pair<const char*, std::set<std::uint32_t>> schedules[] = {
      {"", {1, 4}}, {"to = 3", {1, 3}}, {"every = 2", {1, 3}}, {"from = 2\nto = 2", {2}}};
  for (const auto& [schedule, cycles] : schedules) {
    SCOPED_TRACE(schedule);
    std::string text = testing::small_experiment;
    const std::string operator_before = "name = \"spring-turnover\"\nsprings = 2";
    text.replace(text.find(operator_before), operator_before.size(),
                 std::string("name = 'ballistic-phase'\n") + schedule);
    const Experiment experiment = testing::read(text, {{"development.cycles", "4", ""},
                                                       {"encoding.phase_range", "1.0", ""},
                                                       {"encoding.materials", "[\"muscle\"]", ""}});
    const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
    const Genome genome{0.25f, -0.5f, 0, 0.75f, 1.0f, 0};  // of two voxels: phases in turns, material
    const Evaluation evaluation(experiment, *simulator);
    std::vector<Life> lives = evaluation.birth.of(std::vector<Newborn>{{0, 0, &genome}});
    const Body newborn = lives[0].living.body;
    evaluation.development.run(lives, unwatched);
    ASSERT_TRUE(lives[0].alive()) << lives[0].result.reason;
    const Body& matured = lives[0].living.body;
    ASSERT_EQ(matured.springs.size(), newborn.springs.size());
    for (std::size_t s = 0; s < matured.springs.size(); ++s) {
      const Spring& spring = matured.springs[s];
      const Material &before = newborn.materials[newborn.springs[s].material],
                     &after = matured.materials[spring.material];
      EXPECT_NE(spring.phase_growth, 0);
      EXPECT_NEAR(after.phase, before.phase + spring.phase_growth, 1e-6);
      EXPECT_NEAR(after.frequency, before.frequency, 1e-9);
    }
    EXPECT_EQ(cycles_of_change(lives[0]), cycles);
  }
}

/// Removes every spring.
struct Destroyer final : Devo {
  void develop(const DevoContext& context, Edits& edits, Rng&) const override {
    for (std::uint32_t i = 0; i < context.body.springs.size(); ++i) edits.removed_springs.push_back(i);
  }
};

/// Joins a mass to itself.
struct Faulty final : Devo {
  void develop(const DevoContext&, Edits& edits, Rng&) const override {
    edits.new_springs.push_back({0, 0, {1, 0, 0, 0}, {}});
  }
};

TEST(Evaluation, ABodyThatDevelopmentEmptiesIsInvalid) {
  Experiment experiment = testing::read(testing::small_experiment);
  experiment.devo[0].op = std::make_unique<Destroyer>();
  const Result result = evaluate(experiment, {{.genome = {1, 1}}}).front();
  EXPECT_EQ(result.status, Status::invalid);
  EXPECT_THAT(result.reason, testing::naming("no springs"));
}

std::string file_of(const Experiment& experiment, std::string_view kind) {
  const auto is_it = [&](const OperatorUse& use) { return use.kind == kind; };
  return std::find_if(experiment.uses.begin(), experiment.uses.end(), is_it)->file.string();
}

TEST(Evaluation, AFaultyOperatorIsNamed) {
  Experiment experiment = testing::read(testing::small_experiment);
  experiment.devo[0].op = std::make_unique<Faulty>();
  try {
    evaluate(experiment, {{.id = 5, .genome = {1, 1}}});
    FAIL() << "the fault went unnoticed";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::at_place("devo operator \"spring-turnover\" of " + file_of(experiment, "devo") +
                                                    ", individual 5, cycle 1, seed 7: ",
                                                "masses 0 and 0", "correct the operator", "new run"));
  }
}

/// An encoding with a spring to a mass that does not exist.
struct Dangling final : Encoding {
  Layout layout(const EncodingContext&) const override { return {}; }
  Blueprint decode(const Genome&, const Layout&, const EncodingContext& context) const override {
    return {
        .body = {.masses = {{{0, 0, 0}, 1}, {{1, 0, 0}, 1}}, .springs = {{0, 2, 1}}, .materials = context.materials}};
  }
};

TEST(Evaluation, AFaultyEncodingIsNamed) {
  Experiment experiment = testing::read(testing::small_experiment);
  experiment.encoding = std::make_unique<Dangling>();
  try {
    evaluate(experiment, {{.genome = {1, 1}}});
    FAIL() << "the fault went unnoticed";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::at_place("encoding operator \"voxel\" of " + file_of(experiment, "encoding") +
                                                    ", individual 0, seed 7: ",
                                                "spring 0", "correct the operator", "new run"));
  }
}

/// An encoding of masses at given positions, all joined to each other by springs of the same rest length.
struct Placed final : Encoding {
  std::vector<Vec3> positions;
  double rest_length;
  Placed(std::vector<Vec3> positions_, double rest_length_)
      : positions(std::move(positions_)), rest_length(rest_length_) {}

  Layout layout(const EncodingContext&) const override { return {}; }
  Blueprint decode(const Genome&, const Layout&, const EncodingContext& context) const override {
    Blueprint blueprint{.body = {.masses = {}, .springs = {}, .materials = context.materials}};
    for (const Vec3& position : positions) blueprint.body.masses.push_back({position, context.mass});
    for (std::uint32_t a = 0; a < positions.size(); ++a)
      for (std::uint32_t b = 0; b < a; ++b) blueprint.body.springs.push_back({a, b, rest_length, 1});
    return blueprint;
  }
};

TEST(Evaluation, OnlyABodyInOnePointHasNoExtent) {
  for (const char* dt : {"0.00035", "\"auto\""}) {
    Experiment experiment = testing::read(testing::small_experiment, {{"simulation.dt", dt, ""},
                                                                      {"development.cycles", "1", ""},
                                                                      {"development.cycle_time", "0.07", ""},
                                                                      {"fitness.0.settle", "3.5", ""},
                                                                      {"fitness.0.window", "0.7", ""},
                                                                      {"fitness.1.settle", "0.7", ""},
                                                                      {"fitness.1.window", "0.07", ""}});
    experiment.devo.clear();
    const auto result = [&](std::vector<Vec3> positions, double rest_length) {
      experiment.encoding = std::make_unique<Placed>(std::move(positions), rest_length);
      return evaluate(experiment, {{}}).front();
    };
    const Vec3 here{0.1, -0.3, 7};
    for (const double rest_length : {0.0, 0.1}) {
      const Result point = result({here, here, here}, rest_length);
      EXPECT_EQ(point.status, Status::invalid);
      EXPECT_THAT(point.reason, testing::naming("no extent"));
      EXPECT_EQ(point.spring_evaluations, 0u) << "it is not simulated";
    }
    EXPECT_EQ(result({{0, 0, 0}, {0.3, 0, 0}}, 0.3).reason, "") << "straight";
    EXPECT_EQ(result({{0, 0, 0}, {0, 0, 0.3}}, 0.3).reason, "") << "upright";
    EXPECT_EQ(result({{0, 0, 0}, {0.3, 0, 0}, {0, 0.3, 0}}, 0.3).reason, "") << "flat";
    // without a floor on which it could lie, its springs pull it into a single point
    experiment.scene = {.damping = Damping{}};
    const Result shrunk = result({{0, 0, 0}, {0.3, 0, 0}}, 0);
    EXPECT_THAT(shrunk.reason, testing::naming("no extent"));
    EXPECT_GT(shrunk.spring_evaluations, 0u);
    EXPECT_TRUE(shrunk.objectives.empty());
  }
}

/// A devo operator that stores the height of the body at each application.
class Place final : public Devo {
 public:
  explicit Place(std::vector<double>& heights) : heights_(heights) {}
  void develop(const DevoContext& context, Edits&, Rng&) const override {
    heights_.push_back(context.state.position[0].z);
  }

 private:
  std::vector<double>& heights_;
};

TEST(Evaluation, ResetPutsTheBodyBackAfterEveryCycle) {
  const auto heights = [](bool reset) {
    Experiment experiment = testing::read(testing::small_experiment);
    experiment.scene = {};
    experiment.scene.gravity = Gravity{};
    experiment.development.reset = reset;
    std::vector<double> seen;
    experiment.devo[0].op = std::make_unique<Place>(seen);
    EXPECT_EQ(evaluate(experiment, {{.genome = {1, 1}}}).front().status, Status::ok);
    return seen;
  };
  const auto kept = heights(false), reset = heights(true);
  ASSERT_EQ(kept.size(), 2u);
  ASSERT_EQ(reset.size(), 2u);
  EXPECT_NEAR(kept[1], 4 * kept[0], 0.02 * -kept[0]) << "falls on";
  EXPECT_NEAR(reset[1], reset[0], 1e-6) << "falls anew";
}

TEST(Evaluation, ResetPutsTheBodyOnRoughGroundAsAtBirth) {
  for (const char* seed : {"1", "2", "3", "4"}) {  // grounds with hills and hollows
    const Experiment experiment = testing::read(
        testing::small_experiment,
        {{"development.reset", "true", ""}, {"scene.floor.roughness", "0.05", ""}, {"scene.floor.seed", seed, ""}});
    const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
    const Individual bone{.genome = {1, 1}};
    const Evaluation evaluation(experiment, *simulator);
    std::vector<Life> lives = evaluation.birth.of(std::vector<Newborn>{{0, 0, &bone.genome}});
    const std::vector<Vec3> born = lives[0].living.state.position;
    evaluation.development.run(lives, unwatched);
    ASSERT_TRUE(lives[0].alive()) << lives[0].result.reason;
    for (std::size_t i = 0; i < born.size(); ++i)
      EXPECT_NEAR(norm(lives[0].living.state.position[i] - born[i]), 0, 1e-12) << "seed " << seed;
  }
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
