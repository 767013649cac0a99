// The top speed that friction allows against damping: its formula, and that simulated bodies obey it.
#include "life/measurement/top_speed.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "analysis/ground.hpp"
#include "evolution/breeding.hpp"
#include "life/evaluation.hpp"
#include "support/experiments.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

const Scene hillside{.gravity = Gravity{3.71, 12.3},
                     .floor = Floor{},
                     .friction = Friction{0.47},
                     .damping = Damping{7.9},
                     .drag = std::nullopt};

TEST(TopSpeed, IsTheBalanceOfFrictionWeightAndDamping) {
  EXPECT_NEAR(top_speed(hillside, 1), 0.3156983672, 1e-9);
  EXPECT_NEAR(top_speed(hillside, -1), 0.1156115994, 1e-9);
  EXPECT_NEAR(top_speed(hillside, 0.6), 0.2756810137, 1e-9);
  Scene level = hillside;
  level.gravity->slope = 0;
  EXPECT_DOUBLE_EQ(top_speed(level, 1), 0.47 * 3.71 / 7.9);
  EXPECT_EQ(top_speed(level, 1), top_speed(level, -1));
}

TEST(TopSpeed, DampingAloneLimitsIt) {
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
  Task task;
  task.body = &block;
  task.state = &state;
  task.dt = 1e-4;
  task.steps = 20'000;
  make_cpu_simulator(scene, stepping, 1)->run({&task, 1}, {});
  ASSERT_EQ(task.status, Status::ok) << task.reason;
  for (const Vec3& velocity : state.velocity) EXPECT_NEAR(velocity.x, -top_speed(scene, -1), 1e-4);
}

/// The velocity of the centre of mass along one direction, m/s.
class Velocity final : public Fitness {
 public:
  explicit Velocity(Vec3 along) : along_(along) {}
  Request observes() const override { return {.settle = 1, .window = 2}; }
  std::vector<Objective> objectives() const override { return {{"velocity", "m/s", true}}; }
  std::vector<double> score(const Observation& seen) const override {
    return {dot(seen.centre_after - seen.centre_before, along_) / seen.window};
  }

 private:
  Vec3 along_;
};

TEST(TopSpeed, IsAboveThatOfVigorousRobots) {
  Experiment experiment = testing::read(testing::small_experiment, {{"materials.muscle.amplitude", "0.6", ""},
                                                                    {"materials.muscle2.amplitude", "0.6", ""},
                                                                    {"materials.muscle.frequency", "4", ""},
                                                                    {"materials.muscle2.frequency", "4", ""},
                                                                    {"simulation.dt", "0.0001", ""}});
  experiment.fitness.clear();
  experiment.objectives.clear();
  for (const Vec3 along : {Vec3{1, 0, 0}, Vec3{0, 1, 0}}) {
    experiment.fitness.push_back({std::make_unique<Velocity>(along)});
    experiment.objectives.push_back(experiment.fitness.back().op->objectives().front());
  }
  const double limit = top_speed(experiment.scene, 0);
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 2);
  const std::vector<Individual> robots = breed(experiment, {}, 0, 0, 24);
  std::vector<Newborn> newborns;
  for (const Individual& robot : robots) newborns.push_back({robot.id, robot.born, &robot.genome});
  double fastest = 0;
  for (const Result& result : Evaluation(experiment, *simulator).evaluate(newborns, [](double) {}))
    if (result.status == Status::ok)
      fastest = std::max(fastest, std::hypot(result.objectives[0], result.objectives[1]));
  EXPECT_LT(fastest, 1.01 * limit);
  EXPECT_GT(fastest, 0.1 * limit) << "robots so slow show nothing";
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
