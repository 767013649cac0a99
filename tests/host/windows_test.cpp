// Windows of fitness operators: what is observed does not change the life, and what is seen is true. The top speed that
// friction allows against damping: its formula, and that simulated bodies obey it.
#include "life/measurement/windows.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "analysis/ground.hpp"
#include "cpu/simulator.hpp"
#include "life/measurement/top_speed.hpp"
#include "support/channels.hpp"
#include "support/experiments.hpp"
#include "support/lives.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"
#include "support/scorer.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using testing::alive, testing::score_by, testing::Scorer;
using See = std::function<void(const Observation&)>;

/// A fitness operator that scores the way along x, and calls a function with what it sees.
Scorer spy(
    const Request& request, const See& see = [](const Observation&) {}) {
  return {request, {{"way", "m", true}}, [=](const Observation& seen) {
            see(seen);
            double score = seen.centre_after.x - seen.centre_before.x;
            if (request.work) score += seen.work;
            for (std::size_t i = 0; request.channels.contact && i < seen.samples.size(); ++i)
              score += seen.samples.contact(i);
            return std::vector{score};
          }};
}

Life lived(const Experiment& experiment) { return testing::lived(experiment, {2, 2}); }

void expect_same_life(const Life& a, const Life& b) {
  EXPECT_EQ(a.record, b.record);
  EXPECT_EQ(a.result.spring_evaluations, b.result.spring_evaluations);
  EXPECT_EQ(a.living.state.position, b.living.state.position);
  EXPECT_EQ(a.living.state.velocity, b.living.state.velocity);
  EXPECT_EQ(a.living.state.time, b.living.state.time);
  EXPECT_EQ(a.living.state.start_energy, b.living.state.start_energy);
  EXPECT_EQ(a.result.objectives.at(0), b.result.objectives.at(0));
}

/// The method, the precision and the time step of an experiment.
using Way = std::tuple<std::string, std::string, std::string>;

class Observing : public ::testing::TestWithParam<Way> {
 protected:
  static Experiment experiment(const std::string& probe) {
    const auto& [method, precision, step] = GetParam();
    return testing::small({"simulation.method=" + method, "simulation.precision=" + precision, "simulation.dt=" + step,
                           "development.cycle_time=0.0707", "development.skip=7", "development.probe=" + probe});
  }
};

std::string name_of(const ::testing::TestParamInfo<Way>& instance) {
  const auto& [method, precision, step] = instance.param;
  return std::regex_replace(method + "_" + precision + "_" + step, std::regex("[-.]"), "_");
}

using ::testing::Combine, ::testing::Values;
INSTANTIATE_TEST_SUITE_P(FixedSteps, Observing,
                         Combine(Values("paper-euler", "symplectic-euler", "velocity-verlet", "rk4", "implicit",
                                        "xpbd"),
                                 Values("float", "double"), Values("0.0001")),
                         name_of);
INSTANTIATE_TEST_SUITE_P(OwnSteps, Observing,
                         Combine(Values("paper-euler", "symplectic-euler", "velocity-verlet", "rk4"),
                                 Values("float", "double"), Values("auto")),
                         name_of);

TEST_P(Observing, ChangesNoLifeWithTalliesOrWithout) {
  const Request first{.settle = 0.0511, .window = 0.1001, .work = true, .rate = 250, .channels = {.contact = true}};
  for (const std::string probe : {"exact", "skip-shift"}) {
    SCOPED_TRACE(probe);
    Experiment plain = experiment(probe), watched = experiment(probe);
    score_by(plain, {spy(first)});
    score_by(
        watched,
        {spy(first), spy({.settle = 0.0133, .window = 0.0417, .work = true}),
         spy({.settle = 0, .window = 0.1512, .rate = 333, .channels = test::all_channels}),
         spy({.settle = 0.0007,
              .window = 0.1331,
              .work = true,
              .cycle = 0,
              .rate = 97,
              .channels = test::all_channels}),
         spy({.settle = 0, .window = 0.0701, .work = true, .cycle = 1, .rate = 1000, .channels = {.contact = true}})});
    expect_same_life(alive(lived(plain)), alive(lived(watched)));
  }
}

double fallen(double from, double to) { return 9.81 / 2 * (to * to - from * from); }

TEST(Windows, WithinTheLifeRunThroughDevelopment) {
  for (const char* dt : {"simulation.dt=0.0005", "simulation.dt=auto"}) {
    Experiment experiment = testing::small(
        {dt, "simulation.method=velocity-verlet", "simulation.precision=double", "development.cycles=3"});
    experiment.scene = {};  // the body only falls: z = -g t^2/2 for a second-order method
    experiment.scene.gravity = Gravity{};
    int calls = 0;
    const auto see = [&](const Observation& seen) {
      ++calls;
      EXPECT_NEAR(seen.centre_before.z - seen.centre_after.z, fallen(0.07, 0.13), 9.81 * 0.13 * 0.002);
      EXPECT_NEAR(seen.window, 0.06, 0.002);
      EXPECT_EQ(seen.body, nullptr);
      ASSERT_EQ(seen.samples.size(), 7u);
      for (std::size_t i = 0; i < seen.samples.size(); ++i) {
        const double time = seen.samples.time(i);
        EXPECT_NEAR(time, 0.01 * static_cast<double>(i), 0.003) << "half a step at both ends";
        EXPECT_NEAR(seen.centre_before.z - seen.samples.centre(i).z, fallen(0.07, 0.07 + time), 0.003);
        EXPECT_NEAR(seen.samples.velocity(i).z, -9.81 * (0.07 + time), 0.02);
        EXPECT_EQ(seen.samples.edited(i), i == 4) << "the second cycle ends at 0.1 s, where sample 3 was taken";
        EXPECT_EQ(seen.samples.numbers(i).size(), 12u);
      }
    };
    Request request{.settle = 0.02, .window = 0.06, .cycle = 1, .rate = 100};
    request.channels = {.centre = true, .positions = true};
    score_by(experiment, {spy(request, see)});
    EXPECT_NEAR(alive(lived(experiment)).living.state.time, 0.15, 1e-9) << "no final evaluation follows";
    EXPECT_EQ(calls, 1);
  }
}

TEST(Windows, GoOnCountingAcrossEdits) {
  // a body at rest on the ground: its lowest masses touch the ground all the time, whatever its springs do
  Experiment experiment = testing::small({"development.cycles=4"});
  double all = 0, work = 0;
  const auto see = [&](const Observation& seen) {
    for (std::size_t i = 1; i < seen.samples.size(); ++i) {
      double mean = 0;
      const std::size_t masses = seen.samples.body(i).masses.size();
      for (std::size_t m = 0; m < masses; ++m) {
        EXPECT_GE(seen.samples.contact(i, m), 0);
        EXPECT_LE(seen.samples.contact(i, m), 1 + 1e-9);
        mean += seen.samples.contact(i, m) / static_cast<double>(masses);
      }
      EXPECT_NEAR(mean, seen.samples.contact(i), 1e-9) << i;
      EXPECT_GE(seen.samples.work(i), seen.samples.work(i - 1));
      all += seen.samples.contact(i);
    }
    work = seen.samples.work(seen.samples.size() - 1);
    EXPECT_NEAR(work, seen.work, 1e-9 * work);
  };
  Request request{.settle = 0, .window = 0.2, .work = true, .cycle = 0, .rate = 35};
  request.channels = {.contact = true, .work = true, .contacts = true};
  score_by(experiment, {spy(request, see)});
  EXPECT_FALSE(alive(lived(experiment)).record.empty()) << "there must be edits";
  EXPECT_GT(all, 0.1);
  EXPECT_GT(work, 0);
}

TEST(Windows, SampleOnlyAsManyBodiesAtOnceAsFitInMemory) {
  Experiment experiment = testing::read(testing::small_experiment);
  score_by(experiment, {spy({.settle = 0, .window = 0.05, .rate = 1e6, .channels = {.positions = true}}),
                        spy({.settle = 0, .window = 0.05, .cycle = 0, .rate = 1e6, .channels = {.positions = true}})});
  // a window has 50,001 samples, each with three floats for each mass
  std::vector<Life> lives(5);
  for (Life& life : lives)
    life.living.body.masses.resize(static_cast<std::size_t>(most_sample_bytes / 50'001 / 12 / 2.5));
  const Windows windows(experiment, 0);
  EXPECT_EQ(windows.fitting_after_maturing(lives), 2u);
  EXPECT_EQ(windows.fitting_within_life(lives), 2u);
  EXPECT_EQ(windows.fitting_within_life(std::span(lives).first(1)), 1u);
  experiment.scenarios.push_back({.name = "a", .scene = {}, .develops = true});
  EXPECT_EQ(Windows(experiment, 0).fitting_within_life(lives), 1u) << "each lives twice";
  lives[0].living.body.masses.resize(lives[0].living.body.masses.size() * 5);
  EXPECT_EQ(windows.fitting_within_life(lives), 1u) << "a body that does not fit is simulated alone";
}

TEST(Windows, AskForNothingThatIsNotRequested) {
  Experiment experiment = testing::read(testing::small_experiment);
  const Request centres{.settle = 0, .window = 0.05, .rate = 100, .channels = {.centre = true}};
  const auto told = [&](const See& see, const std::vector<Scorer>& others = {}) {
    std::vector<Scorer> all{spy(centres, see)};
    all.insert(all.end(), others.begin(), others.end());
    score_by(experiment, all);
    return testing::refusal<std::exception>([&] { lived(experiment); });
  };
  const auto number = [](double) {};
  EXPECT_EQ(told([&](auto& o) { number(o.samples.centre(5).x); }), "no refusal");
  EXPECT_THAT(told([&](auto& o) { number(o.work); }), testing::naming("work", "Request::work"));
  EXPECT_THAT(told([&](auto& o) { number(o.samples.work(1)); }), testing::naming("\"work\"", "channels"));
  EXPECT_THAT(told([&](auto& o) { number(o.samples.box(1).low.x); }), testing::naming("\"box\""));
  EXPECT_THAT(told([&](auto& o) { number(o.samples.contact(1)); }), testing::naming("\"contact\""));
  EXPECT_THAT(told([&](auto& o) { number(o.samples.position(1, 0).x); }), testing::naming("\"positions\""));
  EXPECT_THAT(told([&](auto& o) { number(o.samples.velocity(1, 0).x); }), testing::naming("\"velocities\""));
  EXPECT_THAT(told([&](auto& o) { number(o.samples.contact(1, 0)); }), testing::naming("\"contacts\""));
  EXPECT_THAT(told([&](auto& o) { number(o.samples.force(1, 0)); }), testing::naming("\"forces\""));
  EXPECT_THAT(told([&](auto& o) { number(o.samples.centre(6).x); }), testing::naming("sample 6", "only 6"));
  const See body = [](const Observation& o) { static_cast<void>(o.samples.body(1)); };
  EXPECT_THAT(told(body), testing::naming("body", "Request::channels"));
  Request places = centres;
  places.channels = {.positions = true};
  EXPECT_THAT(told(body, {spy(places)}), testing::naming("body", "Request::channels")) << "nor for what others asked";
}

TEST(Windows, ShorterThanAStepAreInvalid) {
  Experiment experiment = testing::read(testing::small_experiment);
  score_by(experiment, {spy({.settle = 0.01, .window = 0.0001})});
  const Life life = lived(experiment);
  EXPECT_EQ(life.result.status, Status::invalid);
  EXPECT_THAT(life.result.reason, testing::naming("window", "step"));
}

/// Removes the first mass after the second cycle.
struct Remover final : Devo {
  void develop(const DevoContext& context, Edits& edits, Rng&) const override {
    if (context.cycle == 2) edits.remove_mass(0);
  }
};

TEST(Windows, FollowMassesByTheirNumbers) {
  Experiment experiment = testing::small({"development.cycles=4"});
  experiment.devo[0].op = std::make_unique<Remover>();
  const auto see = [](const Observation& seen) {
    bool removed = false;
    for (std::size_t i = 1; i < seen.samples.size(); ++i) {
      removed |= seen.samples.edited(i);
      ASSERT_EQ(seen.samples.numbers(i).size(), removed ? 11u : 12u);
      EXPECT_EQ(seen.samples.numbers(i).front(), removed ? 1u : 0u);
      for (std::size_t m = 0; m < seen.samples.numbers(i).size(); ++m) {
        EXPECT_GE(seen.samples.contact(i, m), 0) << i;
        EXPECT_LE(seen.samples.contact(i, m), 1 + 1e-9) << i;
      }
    }
    EXPECT_TRUE(removed);
  };
  score_by(experiment,
           {spy({.settle = 0, .window = 0.2, .cycle = 0, .rate = 70, .channels = {.contacts = true}}, see)});
  ASSERT_TRUE(lived(experiment).alive());
}

TEST(Windows, ShowPartsByTheirIndices) {
  Experiment experiment = testing::read(testing::small_experiment);
  int calls = 0;
  const auto see = [&](const Observation& seen) {
    ++calls;
    ASSERT_NE(seen.body, nullptr);
    const Body& body = seen.samples.body(3);
    EXPECT_EQ(body.springs.size(), seen.body->springs.size());
    for (std::size_t s = 0; s < body.springs.size(); ++s) {
      const Spring& spring = body.springs[s];
      const Vec3 d = seen.samples.position(3, spring.b) - seen.samples.position(3, spring.a);
      const double time = 0.1 + 0.03;  // of the life: two cycles, then three samples
      const Material& material = body.materials[spring.material];
      const double force = material.stiffness * (norm(d) - spring.rest_length * material.relative_length(time));
      EXPECT_NEAR(seen.samples.force(3, s), force, 0.02) << s;
    }
    Vec3 sum;
    for (std::size_t m = 0; m < body.masses.size(); ++m) sum = sum + seen.samples.velocity(3, m);
    EXPECT_NEAR(sum.x / 12, seen.samples.velocity(3).x, 1e-5);
    EXPECT_NEAR(sum.z / 12, seen.samples.velocity(3).z, 1e-5);
  };
  Request request{.settle = 0, .window = 0.05, .rate = 100};
  request.channels = {.centre = true, .positions = true, .velocities = true, .forces = true};
  score_by(experiment, {spy(request, see)});
  ASSERT_TRUE(lived(experiment).alive());
  EXPECT_EQ(calls, 1);
}

const Scene hillside{Gravity{3.71, 12.3}, Floor{}, Friction{0.47}, Damping{7.9}, std::nullopt};

TEST(TopSpeed, IsTheBalanceOfFrictionWeightAndDamping) {
  EXPECT_NEAR(top_speed(hillside, 1), 0.3156983672, 1e-9);
  EXPECT_NEAR(top_speed(hillside, -1), 0.1156115994, 1e-9);
  EXPECT_NEAR(top_speed(hillside, 0.6), 0.2756810137, 1e-9);
  Scene level = hillside;
  level.gravity->slope = 0;
  EXPECT_DOUBLE_EQ(top_speed(level, 1), 0.47 * 3.71 / 7.9);
  EXPECT_EQ(top_speed(level, 1), top_speed(level, -1));
  Scene scene = hillside;
  scene.damping->rate = 0;
  EXPECT_TRUE(std::isinf(top_speed(scene, 1)));
  scene.damping.reset();
  EXPECT_TRUE(std::isinf(top_speed(scene, -1)));
}

TEST(TopSpeed, IsOnlyForScenesWhereNothingButFrictionPushes) {
  EXPECT_TRUE(moves_by_friction(hillside));
  const auto still = [](const auto& change) {
    Scene scene = hillside;
    change(scene);
    return moves_by_friction(scene);
  };
  EXPECT_TRUE(still([](Scene& s) { s.damping.reset(); }));
  EXPECT_FALSE(still([](Scene& s) { s.gravity.reset(); }));
  EXPECT_FALSE(still([](Scene& s) { s.gravity->acceleration = 0; }));
  EXPECT_FALSE(still([](Scene& s) { s.floor.reset(); }));
  EXPECT_FALSE(still([](Scene& s) { s.floor->stiffness = 0; }));
  EXPECT_FALSE(still([](Scene& s) { s.floor->roughness = 0.01; }));
  EXPECT_FALSE(still([](Scene& s) { s.friction.reset(); }));
  EXPECT_FALSE(still([](Scene& s) { s.friction->coefficient = 0; }));
  EXPECT_FALSE(still([](Scene& s) { s.drag = Drag{0.1}; }));
  EXPECT_TRUE(still([](Scene& s) { s.drag = Drag{0}; }));
}

TEST(TopSpeed, IsAboveThatOfVigorousRobots) {
  Experiment experiment =
      testing::small({"materials.muscle.amplitude=0.6", "materials.muscle2.amplitude=0.6",
                      "materials.muscle.frequency=4", "materials.muscle2.frequency=4", "simulation.dt=0.0001"});
  score_by(experiment,
           {{{.settle = 1, .window = 2}, {{"x", "m/s", true}, {"y", "m/s", true}}, [](const Observation& seen) {
               const Vec3 way = seen.centre_after - seen.centre_before;
               return std::vector{way.x / seen.window, way.y / seen.window};
             }}});
  const double limit = top_speed(experiment.scene, 0);
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 2);
  double fastest = 0;
  const std::vector<Individual> robots = breed(experiment, {}, 0, 0, 24);
  for (const Result& result : Evaluation(experiment, *simulator).evaluate(testing::newborns_of(robots), [](double) {}))
    if (result.status == Status::ok)
      fastest = std::max(fastest, std::hypot(result.objectives[0], result.objectives[1]));
  EXPECT_LT(fastest, 1.01 * limit);
  EXPECT_GT(fastest, 0.1 * limit) << "robots so slow show nothing";
}

/// Where every robot slides, what holds it back is all that it has: it slides as fast as the limit is below 0.
TEST(TopSpeed, BelowZeroItIsTheSpeedOfSliding) {
  Scene scene = hillside;
  scene.gravity->slope = 40;
  ASSERT_LT(top_speed(scene, -1), -0.1);
  const Stepping stepping{Method::velocity_verlet, Precision::float64, Materials::table};
  Body block;
  block.masses = {{{0, 0, 0}, 0.3}, {{0.7, 0, 0}, 0.3}, {{0.2, 0.5, 0}, 0.3}};
  block.springs = {{0, 1, 0.7, 0}, {0, 2, std::hypot(0.2, 0.5), 0}, {1, 2, std::hypot(0.5, 0.5), 0}};
  block.materials = {{1000, 0, 0, 0}};
  State state = state_at_birth(block, scene);
  Task task{.body = &block, .state = &state, .dt = 1e-4, .steps = 20'000};
  make_cpu_simulator(scene, stepping, 1)->run({&task, 1}, {});
  ASSERT_EQ(task.status, Status::ok) << task.reason;
  for (const Vec3& velocity : state.velocity) EXPECT_NEAR(velocity.x, -top_speed(scene, -1), 1e-4);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
