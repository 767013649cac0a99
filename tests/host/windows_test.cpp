// Windows of fitness operators: what is observed does not change the life, and what is seen is true.
#include "life/measurement/windows.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "evolution/breeding.hpp"
#include "life/evaluation.hpp"
#include "support/channels.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

const Progress unwatched = [](double) {};

/// A fitness operator that scores the way along x, and calls a function with what it sees.
class Spy final : public Fitness {
 public:
  using See = std::function<void(const Observation&)>;
  explicit Spy(
      Request request, See see = [](const Observation&) {})
      : request_(request), see_(std::move(see)) {}
  Request observes() const override { return request_; }
  std::vector<Objective> objectives() const override { return {{"way", "m", true}}; }
  std::vector<double> score(const Observation& seen) const override {
    see_(seen);
    double score = seen.centre_after.x - seen.centre_before.x;
    if (request_.work) score += seen.work;
    for (std::size_t i = 0; request_.channels.contact && i < seen.samples.size(); ++i) score += seen.samples.contact(i);
    return {score};
  }

 private:
  Request request_;
  See see_;
};

void set_fitness(Experiment& experiment, std::vector<Scored> fitness) {
  experiment.fitness = std::move(fitness);
  experiment.objectives.clear();
  for (std::size_t i = 0; i < experiment.fitness.size(); ++i)
    experiment.objectives.push_back({"way" + std::to_string(i), "m", true});
}

template <class... Spies>
void spy_on(Experiment& experiment, Spies... spies) {
  std::vector<Scored> fitness;
  (fitness.push_back({std::make_unique<Spy>(std::move(spies))}), ...);
  set_fitness(experiment, std::move(fitness));
}

Life lived(const Experiment& experiment, const Genome& genome = {2, 2}) {
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
  const Evaluation evaluation(experiment, *simulator);
  Matured matured = evaluation.matured(evaluation.birth.of(std::vector<Newborn>{{0, 0, &genome}}), unwatched);
  evaluation.measurement.run(matured, unwatched);
  return std::move(matured.lives.front());
}

void expect_same_life(const Life& a, const Life& b) {
  ASSERT_TRUE(a.alive()) << a.result.reason;
  ASSERT_TRUE(b.alive()) << b.result.reason;
  EXPECT_EQ(a.result.record, b.result.record);
  EXPECT_EQ(a.result.spring_evaluations, b.result.spring_evaluations);
  EXPECT_EQ(a.living.state.position, b.living.state.position);
  EXPECT_EQ(a.living.state.velocity, b.living.state.velocity);
  EXPECT_EQ(a.living.state.time, b.living.state.time);
  EXPECT_EQ(a.living.state.start_energy, b.living.state.start_energy);
  EXPECT_EQ(a.result.objectives.front(), b.result.objectives.front());
}

/// The method, the precision and the time step of an experiment.
using Way = std::tuple<std::string, std::string, std::string>;

class Observing : public ::testing::TestWithParam<Way> {
 protected:
  static Experiment experiment(std::vector<Override> more = {}) {
    const auto& [method, precision, step] = GetParam();
    const bool has_own_step = method != "implicit" && method != "xpbd";  // which are stable at any step
    const std::string dt = has_own_step ? step : "0.0001";
    std::vector<Override> overrides{{"simulation.method", method, ""},  {"simulation.precision", precision, ""},
                                    {"simulation.dt", dt, ""},          {"development.cycle_time", "0.0707", ""},
                                    {"fitness.0.settle", "0.0511", ""}, {"fitness.0.window", "0.1001", ""},
                                    {"fitness.1.settle", "0.0511", ""}, {"fitness.1.window", "0.1001", ""}};
    overrides.insert(overrides.end(), more.begin(), more.end());
    return testing::read(testing::small_experiment, overrides);
  }
};

INSTANTIATE_TEST_SUITE_P(Ways, Observing,
                         ::testing::Combine(::testing::Values("paper-euler", "symplectic-euler", "velocity-verlet",
                                                              "rk4", "implicit", "xpbd"),
                                            ::testing::Values("float", "double"), ::testing::Values("0.0001", "auto")),
                         [](const auto& instance) {
                           std::string name = std::get<0>(instance.param) + "_" + std::get<1>(instance.param) + "_" +
                                              (std::get<2>(instance.param) == "auto" ? "auto" : "fixed");
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST_P(Observing, ChangesNoLife) {
  const Request first{.settle = 0.0511, .window = 0.1001, .work = true, .rate = 250, .channels = {.contact = true}};
  Experiment plain = experiment(), watched = experiment();
  spy_on(plain, Spy(first));
  spy_on(watched, Spy(first), Spy({.settle = 0.0133, .window = 0.0417, .work = true}),
         Spy({.settle = 0, .window = 0.1512, .rate = 333, .channels = test::all_channels}),
         Spy({.settle = 0.0007, .window = 0.1331, .cycle = 0, .rate = 97, .channels = test::all_channels}),
         Spy({.settle = 0, .window = 0.0701, .work = true, .cycle = 1, .rate = 1000, .channels = {.contact = true}}));
  expect_same_life(lived(plain), lived(watched));
}

TEST_P(Observing, ChangesNoLifeWithTalliesEither) {
  const std::vector<Override> tallies{{"development.probe", "skip-shift", ""}, {"development.skip", "7", ""}};
  Experiment plain = experiment(tallies), watched = experiment(tallies);
  const Request first{.settle = 0.0511, .window = 0.1001};
  spy_on(plain, Spy(first));
  spy_on(watched, Spy(first),
         Spy({.settle = 0.0007,
              .window = 0.1331,
              .work = true,
              .cycle = 0,
              .rate = 97,
              .channels = {.centre = true, .contacts = true}}));
  expect_same_life(lived(plain), lived(watched));
}

/// The body only falls: z = -g t^2/2 for a second-order method.
Experiment falling(const std::string& dt) {
  Experiment experiment = testing::read(testing::small_experiment, {{"simulation.dt", dt, ""},
                                                                    {"simulation.method", "velocity-verlet", ""},
                                                                    {"simulation.precision", "double", ""},
                                                                    {"development.cycles", "3", ""}});
  experiment.scene = {};
  experiment.scene.gravity = Gravity{};
  return experiment;
}

double fallen(double from, double to) { return 9.81 / 2 * (to * to - from * from); }

TEST(Windows, WithinTheLifeRunThroughDevelopment) {
  for (const char* dt : {"0.0005", "auto"}) {
    Experiment experiment = falling(dt);
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
    spy_on(
        experiment,
        Spy({.settle = 0.02, .window = 0.06, .cycle = 1, .rate = 100, .channels = {.centre = true, .positions = true}},
            see));
    const Life life = lived(experiment);
    ASSERT_TRUE(life.alive()) << life.result.reason;
    EXPECT_EQ(calls, 1);
    EXPECT_NEAR(life.living.state.time, 0.15, 1e-9) << "no final evaluation follows";
  }
}

TEST(Windows, GoOnCountingAcrossEdits) {
  // a body at rest on the ground: its lowest masses touch the ground all the time, whatever its springs do
  Experiment experiment = testing::read(testing::small_experiment, {{"development.cycles", "4", ""}});
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
  spy_on(experiment, Spy({.settle = 0,
                          .window = 0.2,
                          .work = true,
                          .cycle = 0,
                          .rate = 35,
                          .channels = {.contact = true, .work = true, .contacts = true}},
                         see));
  const Life life = lived(experiment);
  ASSERT_TRUE(life.alive()) << life.result.reason;
  EXPECT_FALSE(life.result.record.empty()) << "there must be edits";
  EXPECT_GT(all, 0.1);
  EXPECT_GT(work, 0);
}

TEST(Windows, SampleOnlyAsManyBodiesAtOnceAsFitInMemory) {
  Experiment experiment = testing::read(testing::small_experiment);
  spy_on(experiment, Spy({.settle = 0, .window = 0.05, .rate = 1e6, .channels = {.positions = true}}),
         Spy({.settle = 0, .window = 0.05, .cycle = 0, .rate = 1e6, .channels = {.positions = true}}));
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
  const auto told = [&](const Spy::See& see) {
    spy_on(experiment, Spy({.settle = 0, .window = 0.05, .rate = 100, .channels = {.centre = true}}, see));
    try {
      lived(experiment);
    } catch (const std::exception& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const auto number = [](double) {};
  EXPECT_EQ(told([&](const Observation& o) { number(o.samples.centre(5).x); }), "");
  EXPECT_THAT(told([&](const Observation& o) { number(o.work); }), testing::naming("work", "Request::work"));
  EXPECT_THAT(told([&](const Observation& o) { number(o.samples.work(1)); }), testing::naming("\"work\"", "channels"));
  EXPECT_THAT(told([&](const Observation& o) { number(o.samples.box(1).low.x); }), testing::naming("\"box\""));
  EXPECT_THAT(told([&](const Observation& o) { number(o.samples.contact(1)); }), testing::naming("\"contact\""));
  EXPECT_THAT(told([&](const Observation& o) { number(o.samples.position(1, 0).x); }),
              testing::naming("\"positions\""));
  EXPECT_THAT(told([&](const Observation& o) { number(o.samples.velocity(1, 0).x); }),
              testing::naming("\"velocities\""));
  EXPECT_THAT(told([&](const Observation& o) { number(o.samples.contact(1, 0)); }), testing::naming("\"contacts\""));
  EXPECT_THAT(told([&](const Observation& o) { number(o.samples.force(1, 0)); }), testing::naming("\"forces\""));
  EXPECT_THAT(told([&](const Observation& o) { number(double(o.samples.body(1).masses.size())); }),
              testing::naming("body", "Request::channels"));
  EXPECT_THAT(told([&](const Observation& o) { number(o.samples.centre(6).x); }),
              testing::naming("sample 6", "only 6"));
}

TEST(Windows, AskForNothingThatOthersRequestedEither) {
  Experiment experiment = testing::read(testing::small_experiment);
  const Request centres{.settle = 0, .window = 0.05, .rate = 100, .channels = {.centre = true}};
  Request places = centres;
  places.channels = {.positions = true};
  spy_on(experiment, Spy(centres, [](const Observation& o) { static_cast<void>(o.samples.body(1)); }), Spy(places));
  EXPECT_THAT([&] { lived(experiment); },
              ::testing::ThrowsMessage<std::runtime_error>(testing::naming("body", "Request::channels")));
}

TEST(Windows, ShorterThanAStepAreInvalid) {
  Experiment experiment = testing::read(testing::small_experiment);
  spy_on(experiment, Spy({.settle = 0.01, .window = 0.0001}));
  const Life life = lived(experiment);
  EXPECT_EQ(life.result.status, Status::invalid);
  EXPECT_THAT(life.result.reason, testing::naming("window", "step"));
}

/// Removes the first mass after the second cycle.
struct Remover final : Devo {
  void develop(const DevoContext& context, Edits& edits, Rng&) const override {
    if (context.cycle == 2) edits.removed_masses.push_back(0);
  }
};

TEST(Windows, FollowMassesByTheirNumbers) {
  Experiment experiment = testing::read(testing::small_experiment, {{"development.cycles", "4", ""}});
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
  spy_on(experiment, Spy({.settle = 0, .window = 0.2, .cycle = 0, .rate = 70, .channels = {.contacts = true}}, see));
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
  spy_on(experiment, Spy({.settle = 0,
                          .window = 0.05,
                          .rate = 100,
                          .channels = {.centre = true, .positions = true, .velocities = true, .forces = true}},
                         see));
  ASSERT_TRUE(lived(experiment).alive());
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
