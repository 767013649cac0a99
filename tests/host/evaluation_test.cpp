// Evaluations: results do not depend on the other bodies or on the number of threads, and failures have a reason.
#include "life/evaluation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <set>

#include "life/body_building.hpp"
#include "support/changed.hpp"
#include "support/lives.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"
#include "support/scorer.hpp"
#include "support/told.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using testing::Told;
using testing::unwatched;

std::vector<Result> evaluate(const Experiment& experiment, const std::vector<Individual>& individuals) {
  const auto simulator = testing::simulator_for(experiment);
  return Evaluation(experiment, *simulator).evaluate(testing::newborns_of(individuals), unwatched);
}

/// The result of a body of two voxels of a material.
Result result_of(const Experiment& experiment, float material = 1) {
  return evaluate(experiment, {{.genome = {material, material}}}).front();
}

/// Replaces the devo operator by one that remembers these numbers about springs.
void develop_by(Experiment& experiment, std::function<void(const DevoContext&, Edits&)> action,
                std::vector<std::string> of_springs = {}) {
  auto told = std::make_unique<Told>(RecordRequest{}, std::move(action));
  told->of_springs = std::move(of_springs);
  experiment.devo.at(0).op = std::move(told);
}

/// The life that a genome develops, and what it was at birth.
struct Grown {
  LivingBody newborn;
  Life life;
};

/// `growth` is what the operator remembers about each spring at birth, unless it is that of the encoding.
Grown grown(const Experiment& experiment, const Genome& genome, std::optional<double> growth = std::nullopt) {
  const auto simulator = testing::simulator_for(experiment);
  const Evaluation evaluation(experiment, *simulator);
  std::vector<Life> lives = evaluation.birth.of(std::vector<Newborn>{{0, 0, &genome}});
  if (growth) std::ranges::fill(lives[0].living.memory.at(0).springs.values, *growth);
  LivingBody newborn = lives[0].living;
  evaluation.development.run(lives, unwatched);
  EXPECT_TRUE(lives[0].alive()) << lives[0].result.reason;
  return {std::move(newborn), std::move(lives[0])};
}

TEST(Evaluation, DoesNotDependOnThreadsOrCompanyEvenIfSomeAreAllAir) {
  const Experiment experiment = testing::small();
  std::vector<Individual> individuals = breed(experiment, {}, 0, 0, 24);
  individuals.push_back({.id = 24, .genome = {0, 0}});
  const std::vector<Result> results = testing::expect_independent_lives(experiment, individuals);
  EXPECT_GE(std::ranges::count(results, Status::ok, &Result::status), 8) << "there must be something to compare";
  EXPECT_EQ(results[24].status, Status::invalid);
  EXPECT_NE(results[24].reason, "");
  EXPECT_TRUE(results[24].objectives.empty());
}

TEST(Evaluation, CountsEverySpringOfEveryStep) {
  const Result result = result_of(testing::small());  // 12 masses, 28 + 28 - 6 springs
  ASSERT_EQ(result.status, Status::ok) << result.reason;
  EXPECT_EQ(result.spring_evaluations, 50u * (2 * 100 + 100 + 200));
}

/// rk4 computes drag as a force, which grows with the square of the speed, and the time step is too long for it.
TEST(Evaluation, ADivergedBodyIsToldWithTimeAndReason) {
  const Result result = result_of(
      testing::small({"scene.drag.coefficient=1e6", "scene.gravity.acceleration=1000", "simulation.method=rk4"}), 2);
  EXPECT_EQ(result.status, Status::diverged);
  EXPECT_GT(result.ended_at, 0);
  EXPECT_LE(result.ended_at, 0.25);
  EXPECT_NE(result.reason, "");
  EXPECT_TRUE(result.objectives.empty());
}

/// Lets operators with these requests, which score as said, take the place of those of an experiment. Returns what they
/// see.
std::vector<Observation> watch(Experiment& experiment, const std::vector<Request>& requests, Result& result,
                               double value = 0, float material = 1) {
  std::vector<Observation> seen(requests.size());
  std::vector<testing::Scorer> scorers;
  for (std::size_t i = 0; i < requests.size(); ++i)
    scorers.push_back({requests[i], {{"seen", "1", true}}, [&seen, i, value](const Observation& observation) {
                         seen[i] = observation;
                         return std::vector{value};
                       }});
  testing::score_by(experiment, scorers);
  result = result_of(experiment, material);
  return seen;
}

TEST(Evaluation, AFitnessThatIsNotANumberIsNoFitness) {
  Experiment experiment = testing::small();
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Result result;
    watch(experiment, {{.settle = 0, .window = 0.01}}, result, value);
    EXPECT_EQ(result.status, Status::invalid);
    EXPECT_THAT(result.reason, testing::naming("not finite", "seen"));
    EXPECT_TRUE(result.objectives.empty());
  }
}

/// Returns what is seen, in windows as requested, of a muscular body that only falls: z = -g t^2 / 2.
std::vector<Observation> watch_falling(Experiment& experiment, const std::vector<Request>& requests, Result& result) {
  experiment.scene = {};
  experiment.scene.gravity = Gravity{};
  std::vector<Observation> seen = watch(experiment, requests, result, 0, 2);
  EXPECT_EQ(result.status, Status::ok) << result.reason;
  return seen;
}

double fallen(const Observation& seen) { return seen.centre_before.z - seen.centre_after.z; }

TEST(Evaluation, EveryFitnessSeesItsOwnWindow) {
  Experiment experiment = testing::small();
  experiment.development = {};
  Result result;
  const auto seen = watch_falling(
      experiment,
      {{.settle = 0.1, .window = 0.2}, {.settle = 0.2, .window = 0.3}, {.settle = 0, .window = 0.5, .work = true}},
      result);
  EXPECT_NEAR(fallen(seen[0]), 9.81 / 2 * (0.3 * 0.3 - 0.1 * 0.1), 2e-3);
  EXPECT_NEAR(fallen(seen[1]), 9.81 / 2 * (0.5 * 0.5 - 0.2 * 0.2), 2e-3);
  EXPECT_NEAR(fallen(seen[2]), 9.81 / 2 * 0.25, 2e-3);
  EXPECT_THROW(static_cast<void>(static_cast<double>(seen[0].work)), std::logic_error) << "nobody asked for it";
  EXPECT_GT(seen[2].work, 0);
  EXPECT_NEAR(seen[2].box.longest_side(), 1, 1e-6) << "two voxels of half a metre";
}

/// A first-order method overshoots the path by g t dt/2.
TEST(Evaluation, ABodysOwnStepEndsWithItsWindow) {
  Experiment experiment = testing::small({"simulation.dt=auto"});
  experiment.development.cycle_time = 0.0513;  // not a multiple of any step
  Result result;
  const auto seen = watch_falling(experiment, {{.settle = 0.1, .window = 0.2, .work = true}}, result);
  const double from = 2 * 0.0513 + 0.1, to = from + 0.2;
  EXPECT_NEAR(fallen(seen[0]), 9.81 / 2 * (to * to - from * from), 9.81 * 0.2 * 0.005);
  EXPECT_LT(result.spring_evaluations, 50u * 806) << "fewer steps than of 0.5 ms";
  EXPECT_GT(result.spring_evaluations, 50u * 40);
}

TEST(Evaluation, AnUnstableBodyIsInvalidOrRunsAsTheFileAsks) {
  const auto stiff = [](const std::string& unstable) {
    return result_of(testing::small({"materials.bone.stiffness=1e6", "simulation.unstable=" + unstable}));
  };
  const Result invalid = stiff("invalid"), run = stiff("run");
  EXPECT_EQ(invalid.status, Status::invalid);
  EXPECT_THAT(invalid.reason, testing::at_place("unstable dt: ", "0.0005 s", "springs"));
  EXPECT_EQ(invalid.spring_evaluations, 0u);
  EXPECT_GT(run.spring_evaluations, 0u);
  EXPECT_NE(run.status, Status::invalid);
}

/// Makes all springs a thousand times stiffer.
void stiffen(const DevoContext& context, Edits& edits) {
  for (std::uint32_t i = 0; i < context.body.springs.size(); ++i) {
    Material material = context.body.materials[context.body.springs[i].material];
    material.stiffness *= 1000;
    edits.change_spring(i, {.material = material});
  }
}

TEST(Evaluation, DevelopmentChangesTheStep) {
  Experiment experiment = testing::small({"simulation.dt=auto", "development.cycles=1"});
  const auto spring_evaluations = [&] {
    const Result result = result_of(experiment);
    EXPECT_EQ(result.status, Status::ok) << result.reason;
    return result.spring_evaluations;
  };
  develop_by(experiment, stiffen);
  const std::uint64_t stiff = spring_evaluations();
  experiment.devo.clear();
  EXPECT_GT(stiff, 4 * spring_evaluations()) << "the steps that follow are shorter";
}

TEST(Evaluation, DevelopmentThatAFixedStepCannotBearIsInvalid) {
  Experiment experiment = testing::small();
  develop_by(experiment, stiffen);
  const Result result = result_of(experiment);
  EXPECT_EQ(result.status, Status::invalid);
  EXPECT_THAT(result.reason, testing::at_place("unstable dt: ", "0.0005 s", "springs"));
}

TEST(Evaluation, ALoadSinksTheFasterInWater) {
  // terminal speed, at which weight and drag are equal: M g = 12 c v^2
  Experiment experiment =
      testing::small({"scene.payload.share=3", "scene.payload.top=1", "scene.drag.coefficient=0.5"});
  experiment.development = {};
  experiment.scene = {.gravity = Gravity{}, .drag = experiment.scene.drag};
  const auto speed = [&] {
    Result result;
    const Observation seen = watch(experiment, {{.settle = 2, .window = 0.5}}, result).front();
    EXPECT_EQ(result.status, Status::ok);
    return fallen(seen) / 0.5;
  };
  const double unloaded = std::sqrt(12 * 0.2 * 9.81 / (12 * 0.5));
  EXPECT_NEAR(speed(), 2 * unloaded, 0.01 * unloaded);
  experiment.payload.reset();
  EXPECT_NEAR(speed(), unloaded, 0.01 * unloaded);
}

/// Makes every spring three times as long.
void stretch(const DevoContext& context, Edits& edits) {
  for (std::uint32_t i = 0; i < context.body.springs.size(); ++i)
    edits.change_spring(i, {.rest_length = 3 * context.body.springs[i].rest_length});
}

TEST(Evaluation, TheEnergyThatGrowthBringsIsAllowed) {
  Experiment experiment = testing::small({"development.cycles=1"});
  develop_by(experiment, stretch);
  const double stretched = grown(experiment, {1, 1}).life.living.state.start_energy;
  develop_by(experiment, [](const DevoContext&, Edits& edits) { edits.scale_lengths({.to = 1}); }, {"growth"});
  EXPECT_NEAR(grown(experiment, {1, 1}, 2).life.living.state.start_energy, stretched, 1e-12 * stretched);
  EXPECT_LT(grown(experiment, {1, 1}, 0).life.living.state.start_energy, 0.5 * stretched) << "without growth";
}

TEST(Evaluation, ABodysLengthIsThatOfTheStartOfTheWindow) {
  Experiment experiment = testing::small();
  experiment.scene.gravity.reset();
  experiment.scene.damping->rate = 100;  // so that the body soon reaches its new length
  develop_by(experiment, stretch);
  experiment.development.cycles = 1;
  Result result;
  const auto seen = watch(experiment, {{.settle = 0, .window = 1}, {.settle = 1, .window = 1}}, result);
  ASSERT_EQ(result.status, Status::ok) << result.reason;
  EXPECT_NEAR(seen[0].box.longest_side(), 1, 0.05) << "development has just ended: two voxels of half a metre";
  EXPECT_NEAR(seen[1].box.longest_side(), 3, 0.05);
}

/// The cycles in which the body changed.
std::set<std::uint32_t> cycles_of_change(const Life& life) {
  std::set<std::uint32_t> cycles;
  for (const Change& change : LifeRecord(life.record.bytes()).changes()) cycles.insert(change.cycle);
  return cycles;
}

TEST(Evaluation, BallisticSpringsHaveTheLengthsThatANetworkGivesThem) {
  const std::pair<const char*, std::set<std::uint32_t>> schedules[] = {
      {"", {1, 2, 3, 4}}, {"to = 2", {1, 2}}, {"from = 3", {3, 4}}, {"every = 3", {1, 4}}, {"from = 2\nto = 2", {2}}};
  const std::string points = "points = 40\nneighbours = 6\nmaterials = ['bone', 'muscle']\nsize_range = 0.25\n";
  for (const std::string network : {"name = 'neural'\n", "name = 'cppn'\n"})
    for (const std::string pairing : {"pairing = 'after-mapping'\n", "pairing = 'before-mapping'\n"})
      for (const auto& [schedule, cycles] : schedules) {
        SCOPED_TRACE(network + pairing + schedule);
        const Experiment experiment = testing::read(
            testing::small_with({{"name = \"voxel\"\nsize = [2, 1, 1]\nedge = 0.5\n", points + network + pairing},
                                 {"\"spring-turnover\"\nsprings = 2", std::string("'ballistic-growth'\n") + schedule},
                                 {"cycles = 2", "cycles = 4"}}));
        const Individual individual = breed(experiment, {}, 0, 0, 1).front();
        const Blueprint blueprint = decoded(experiment, individual.genome);
        const std::vector<std::uint32_t> kept = build_body(blueprint).kept;
        const auto expect_lengths = [&](const Body& body, const char* size, double tolerance) {
          const std::vector<double>& sizes = blueprint.mass_memory.at(size);
          ASSERT_GT(body.springs.size(), 100u);
          for (const Spring& spring : body.springs) {
            const std::uint32_t a = kept.at(spring.a), b = kept.at(spring.b);
            const double distance = norm(blueprint.body.masses[a].rest - blueprint.body.masses[b].rest);
            const double expected = distance * (sizes.at(a) + sizes.at(b)) / 2;
            ASSERT_NEAR(spring.rest_length, expected, tolerance);
          }
        };
        const Grown of = grown(experiment, individual.genome);
        expect_lengths(of.newborn.body, "size at birth", 1e-12);
        expect_lengths(of.life.living.body, "size at the end", 1e-6);
        EXPECT_EQ(cycles_of_change(of.life), cycles);
      }
}

TEST(Evaluation, PhasesGoFromThoseAtBirthToThoseAtTheEndWhateverTheSchedule) {
  const std::pair<const char*, std::set<std::uint32_t>> schedules[] = {
      {"", {1, 4}}, {"to = 3", {1, 3}}, {"every = 2", {1, 3}}, {"from = 2\nto = 2", {2}}};
  for (const auto& [schedule, cycles] : schedules) {
    SCOPED_TRACE(schedule);
    const Experiment experiment = testing::read(
        testing::small_with({{"\"spring-turnover\"\nsprings = 2", std::string("'ballistic-phase'\n") + schedule},
                             {"edge = 0.5", "edge = 0.5\nphase_range = 1.0\nmaterials = ['muscle']"},
                             {"cycles = 2", "cycles = 4"}}));
    const Grown of = grown(experiment, {0.25f, -0.5f, 0, 0.75f, 1.0f, 0});  // of two voxels: phases in turns, material
    const Body &newborn = of.newborn.body, &matured = of.life.living.body;
    ASSERT_EQ(matured.springs.size(), newborn.springs.size());
    for (std::size_t s = 0; s < matured.springs.size(); ++s) {
      const Spring& spring = matured.springs[s];
      const Material &before = newborn.materials[newborn.springs[s].material],
                     &after = matured.materials[spring.material];
      const double turn = of.newborn.memory.at(0).springs.values.at(s);
      EXPECT_NE(turn, 0);
      EXPECT_NEAR(after.phase, before.phase + turn, 1e-6);
      EXPECT_NEAR(after.frequency, before.frequency, 1e-9);
    }
    EXPECT_EQ(cycles_of_change(of.life), cycles);
  }
}

TEST(Evaluation, ABodyThatDevelopmentEmptiesIsInvalid) {
  Experiment experiment = testing::small();
  develop_by(experiment, [](const DevoContext& context, Edits& edits) {
    for (std::uint32_t i = 0; i < context.body.springs.size(); ++i) edits.remove_spring(i);
  });
  const Result result = result_of(experiment);
  EXPECT_EQ(result.status, Status::invalid);
  EXPECT_THAT(result.reason, testing::naming("no springs"));
}

TEST(Evaluation, AFaultyOperatorIsNamed) {
  Experiment experiment = testing::small();
  const auto file_of = [&](std::string_view kind) {
    return std::ranges::find(experiment.uses, kind, &OperatorUse::kind)->file.string();
  };
  const auto said = [&] {
    return testing::refusal<std::runtime_error>([&] { evaluate(experiment, {{.id = 5, .genome = {1, 1}}}); });
  };
  develop_by(experiment, [](const DevoContext&, Edits& edits) { edits.join(0, 0, Material{1, 0, 0, 0}); });
  EXPECT_THAT(said(), testing::at_place("devo operator \"spring-turnover\" of " + file_of("devo") +
                                            ", individual 5, cycle 1, seed 7: ",
                                        "masses 0 and 0", "correct the operator", "new run"));
  experiment.encoding = std::make_unique<testing::GivenBlueprint>(
      Blueprint{.body = {.masses = {{{0, 0, 0}, 1}, {{1, 0, 0}, 1}}, .springs = {{0, 2, 1}}}});
  EXPECT_THAT(said(),
              testing::at_place("encoding operator \"voxel\" of " + file_of("encoding") + ", individual 5, seed 7: ",
                                "spring 0", "correct the operator", "new run"));
}

TEST(Evaluation, OnlyABodyInOnePointHasNoExtent) {
  for (const char* dt : {"0.00035", "\"auto\""}) {
    Experiment experiment =
        testing::read(testing::small_with({{"cycle_time = 0.05", "cycle_time = 0.07"},
                                           {"settle = 0.05\nwindow = 0.1", "settle = 3.5\nwindow = 0.7"},
                                           {"settle = 0.05\nwindow = 0.1", "settle = 0.7\nwindow = 0.07"}}),
                      {{"simulation.dt", dt, ""}, {"development.cycles", "1", ""}});
    experiment.devo.clear();
    // all masses are joined to each other by springs of the same rest length
    const auto result = [&](const std::vector<Vec3>& positions, double rest_length) {
      Blueprint blueprint;
      for (std::uint32_t a = 0; a < positions.size(); ++a) {
        blueprint.body.masses.push_back({positions[a], 0.2});
        for (std::uint32_t b = 0; b < a; ++b) blueprint.body.springs.push_back({a, b, rest_length, 1});
      }
      experiment.encoding = std::make_unique<testing::GivenBlueprint>(blueprint);
      return evaluate(experiment, {{}}).front();
    };
    const Vec3 here{0.1, -0.3, 7};
    for (const double rest_length : {0.0, 0.1}) {
      const Result point = result({here, here, here}, rest_length);
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

TEST(Evaluation, ResetPutsTheBodyBackAfterEveryCycle) {
  const auto heights = [](bool reset) {
    Experiment experiment = testing::small();
    experiment.scene = {};
    experiment.scene.gravity = Gravity{};
    experiment.development.reset = reset;
    std::vector<double> seen;
    develop_by(experiment, [&](const DevoContext& context, Edits&) { seen.push_back(context.state.position[0].z); });
    EXPECT_EQ(result_of(experiment).status, Status::ok);
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
    const Grown of = grown(testing::small({"development.reset=true", "scene.floor.roughness=0.05",
                                           std::string("scene.floor.seed=") + seed}),
                           {1, 1});
    const std::vector<Vec3>&born = of.newborn.state.position, &back = of.life.living.state.position;
    for (std::size_t i = 0; i < born.size(); ++i) EXPECT_NEAR(norm(back[i] - born[i]), 0, 1e-12) << "seed " << seed;
  }
}

// batches that are simulated in several cohorts at the same time -----------------------------------------------------

/// A simulator that should be called by several threads at the same time, like that of a GPU.
class Concurrent final : public testing::AlteredSimulator {
 public:
  Concurrent(const Experiment& experiment, int calls) : AlteredSimulator(experiment, 2), calls_(calls) {}

  void run(std::span<Task> tasks, Recording recording) override {
    if (fails) throw std::runtime_error("the device is lost");
    {
      const std::lock_guard lock(mutex_);
      ++runs;
      most = std::max<std::size_t>(most, announced);
      fewest = std::min<std::size_t>(fewest, announced);
    }
    AlteredSimulator::run(tasks, recording);
  }
  int concurrency() const override { return calls_; }
  std::shared_ptr<const void> announce(std::size_t bodies) override {
    announced += bodies;
    return {this, [bodies](Concurrent* simulator) { simulator->announced -= bodies; }};
  }

  bool fails = false;
  int runs = 0;
  std::atomic<std::size_t> announced = 0;
  std::size_t fewest = ~std::size_t{0}, most = 0;

 private:
  std::mutex mutex_;
  int calls_;
};

TEST(Cohorts, GiveTheResultsOfOneBatchOrPassOnAFailure) {
  const Experiment experiment = testing::small();
  const std::vector<Individual> individuals = breed(experiment, {}, 0, 0, 300);
  const std::vector<Newborn> newborns = testing::newborns_of(individuals);
  Concurrent one(experiment, 1), four(experiment, 4);
  const std::vector<Result> together = Evaluation(experiment, one).evaluate(newborns, unwatched);
  double before = 0;
  const std::vector<Result> apart = Evaluation(experiment, four).evaluate(newborns, [&](double done) {
    EXPECT_GE(done, before);  // progress of all cohorts together
    before = done;
  });
  EXPECT_NEAR(before, 1, 1e-12);
  EXPECT_EQ(four.runs, 4 * one.runs);
  EXPECT_EQ(four.most, 300u) << "all are announced before the first is simulated";
  EXPECT_GE(four.fewest, 75u) << "the last cohort is announced until it has ended";
  EXPECT_EQ(four.announced, 0u);
  ASSERT_EQ(apart.size(), together.size());
  for (std::size_t i = 0; i < together.size(); ++i) {
    EXPECT_EQ(apart[i].status, together[i].status);
    EXPECT_EQ(apart[i].objectives, together[i].objectives);
  }
  four.fails = true;
  EXPECT_THROW(Evaluation(experiment, four).evaluate(newborns, unwatched), std::runtime_error);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
