// Batches that are simulated in several cohorts at the same time.
#include <gtest/gtest.h>

#include <atomic>

#include "evolution/breeding.hpp"
#include "life/evaluation.hpp"
#include "support/experiments.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

/// A simulator that should be called by several threads at the same time, like that of a GPU.
class Concurrent final : public Simulator {
 public:
  Concurrent(const Experiment& experiment, int calls)
      : simulator_(make_cpu_simulator(experiment.scene, experiment.stepping, 2)), calls_(calls) {}

  void run(std::span<Task> tasks, Recording recording) override {
    ++runs;
    const std::size_t now = announced;
    for (std::size_t before = most; now > before && !most.compare_exchange_weak(before, now);) {
    }
    for (std::size_t before = fewest; now < before && !fewest.compare_exchange_weak(before, now);) {
    }
    simulator_->run(tasks, recording);
  }
  NeighbourSearch& neighbours() override { return simulator_->neighbours(); }
  Workers& workers() override { return simulator_->workers(); }
  int concurrency() const override { return calls_; }
  std::string device() const override { return simulator_->device(); }
  std::shared_ptr<const void> announce(std::size_t bodies) override {
    announced += bodies;
    return {this, [bodies](Concurrent* simulator) { simulator->announced -= bodies; }};
  }

  std::atomic<int> runs = 0;
  std::atomic<std::size_t> announced = 0, fewest = ~std::size_t{0}, most = 0;

 private:
  std::unique_ptr<Simulator> simulator_;
  int calls_;
};

TEST(Cohorts, GiveTheResultsOfOneBatch) {
  const Experiment experiment = testing::read(testing::small_experiment);
  const std::vector<Individual> individuals = breed(experiment, {}, 0, 0, 300);
  std::vector<Newborn> newborns;
  for (const Individual& individual : individuals)
    newborns.push_back({individual.id, individual.born, &individual.genome});
  Concurrent one(experiment, 1), four(experiment, 4);
  const std::vector<Result> together = Evaluation(experiment, one).evaluate(newborns, [](double) {});
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
}

TEST(Cohorts, PassOnAFailure) {
  class Failing final : public Simulator {
   public:
    explicit Failing(std::unique_ptr<Simulator> simulator) : simulator_(std::move(simulator)) {}
    void run(std::span<Task>, Recording) override { throw std::runtime_error("the device is lost"); }
    NeighbourSearch& neighbours() override { return simulator_->neighbours(); }
    Workers& workers() override { return simulator_->workers(); }
    int concurrency() const override { return 4; }
    std::string device() const override { return "failing"; }

   private:
    std::unique_ptr<Simulator> simulator_;
  };
  const Experiment experiment = testing::read(testing::small_experiment);
  const std::vector<Individual> individuals = breed(experiment, {}, 0, 0, 300);
  std::vector<Newborn> newborns;
  for (const Individual& individual : individuals)
    newborns.push_back({individual.id, individual.born, &individual.genome});
  Failing simulator(make_cpu_simulator(experiment.scene, experiment.stepping, 1));
  const Evaluation evaluation(experiment, simulator);
  EXPECT_THROW(evaluation.evaluate(newborns, [](double) {}), std::runtime_error);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
