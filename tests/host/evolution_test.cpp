// Runs that fail in the middle: committed generations are kept, and resuming gives the same result as without a
// failure.
#include "evolution/evolution.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "commands/run/run.hpp"
#include "evolution/record_check.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

/// A simulator whose device is lost when the lives of generation `lost` begin, counted from 0.
class Breaking final : public Simulator {
 public:
  Breaking(const Experiment& experiment, std::size_t lost)
      : simulator_(make_cpu_simulator(experiment.scene, experiment.stepping, 1)), lost_(lost) {}

  void run(std::span<Task> tasks, Recording recording) override {
    const bool is_birth = !tasks.empty() && tasks.front().state->time == 0;
    if (is_birth && generations_++ == lost_) throw std::runtime_error("CUDA: simulating on the GPU failed");
    simulator_->run(tasks, recording);
  }
  NeighbourSearch& neighbours() override { return simulator_->neighbours(); }
  Workers& workers() override { return simulator_->workers(); }
  std::string device() const override { return simulator_->device(); }

 private:
  std::unique_ptr<Simulator> simulator_;
  std::size_t lost_, generations_ = 0;
};

class LostDevice : public ::testing::Test {
 protected:
  /// Returns the error message of a run in the folder `name` whose device is lost after `generations`.
  std::string failure(const std::string& name, std::size_t generations) {
    Archive archive = Archive::create(scratch_ / name, experiment_, "test");
    Breaking simulator(experiment_, generations);
    try {
      evolve_and_report(experiment_, simulator, archive);
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(archive.generations().size(), generations);
      return error.what();
    }
    return "no failure";
  }

  int finish(Archive archive) {
    const auto simulator = make_cpu_simulator(experiment_.scene, experiment_.stepping, 1);
    return evolve_and_report(experiment_, *simulator, archive);
  }

  testing::Scratch scratch_;
  Experiment experiment_ = testing::read(testing::small_experiment);
};

TEST_F(LostDevice, SaysWhatIsCompleteAndHowToGoOn) {
  const std::string said = failure("run", 3);
  EXPECT_THAT(said, testing::at_place("CUDA: simulating on the GPU failed\n", "generation 2",
                                      " resume " + (scratch_ / "run").string()));
}

TEST_F(LostDevice, BeforeAnythingIsCompleteSaysSo) {
  EXPECT_THAT(failure("run", 0),
              testing::at_place("CUDA: simulating on the GPU failed\n", "no generation", " resume "));
}

TEST_F(LostDevice, ResumedEndsAsIfItHadNotBeen) {
  failure("broken", 3);
  EXPECT_EQ(finish(Archive::resume(scratch_ / "broken")), 0);
  EXPECT_EQ(finish(Archive::create(scratch_ / "whole", experiment_, "test")), 0);
  const Archive broken = Archive::read(scratch_ / "broken"), whole = Archive::read(scratch_ / "whole");
  ASSERT_EQ(broken.generations().size(), whole.generations().size());
  for (std::uint32_t id = 0; id < experiment_.evaluations; ++id) {
    ASSERT_TRUE(broken.individual(id) && whole.individual(id)) << id;
    EXPECT_EQ(broken.individual(id)->genome, whole.individual(id)->genome) << id;
    EXPECT_EQ(broken.individual(id)->result.objectives, whole.individual(id)->result.objectives) << id;
    EXPECT_EQ(broken.individual(id)->died, whole.individual(id)->died) << id;
  }
}

/// Bone is so stiff that whole voxels of it diverge at 0.5 ms. Before such a body is flagged, it moves farther than any
/// robot walks.
TEST(Flagged, BodiesNeverWinThoughManyAreBorn) {
  const testing::Scratch scratch;
  const Experiment experiment = testing::read(testing::small_experiment, {{"materials.bone.stiffness", "1e6", ""},
                                                                          {"simulation.unstable", "run", ""},
                                                                          {"experiment.evaluations", "60", ""}});
  Archive archive = Archive::create(scratch / "run", experiment, "test");
  EXPECT_EQ(evolve_and_report(experiment, *make_cpu_simulator(experiment.scene, experiment.stepping, 1), archive), 0);
  int diverged = 0, survivors = 0;
  for (std::uint32_t id = 0; id < experiment.evaluations; ++id) {
    const ArchivedIndividual individual = archive.individual(id).value();
    survivors += !individual.died;
    if (individual.result.status != Status::diverged) continue;
    ++diverged;
    EXPECT_TRUE(individual.result.objectives.empty());
    EXPECT_GT(individual.result.ended_at, 0);
    EXPECT_FALSE(individual.result.reason.empty());
    EXPECT_TRUE(individual.died) << id << " survived";
  }
  EXPECT_GE(diverged, 5);
  EXPECT_EQ(survivors, 6);
  for (const std::uint32_t id : archive.best(60)) EXPECT_EQ(archive.individual(id)->result.status, Status::ok);
}

/// Where more is measured than the objectives, a body that diverged has none of those scores.
TEST(Flagged, BodiesOfAPopulationAreTakenFromTheRecord) {
  const testing::Scratch scratch;
  const std::string height = "[[fitness]]\nname = \"descriptor\"\nwhat = \"height\"\nrange = [0.0, 2.0]\n";
  const Experiment experiment =
      testing::read(testing::small_experiment + height,
                    {{"materials.bone.stiffness", "1e6", ""}, {"simulation.unstable", "run", ""}});
  Archive archive = Archive::create(scratch / "run", experiment, "test");
  std::atomic<bool> stop = false;
  evolve(experiment, *make_cpu_simulator(experiment.scene, experiment.stepping, 1), archive, stop,
         {.generation_done = [&](const Summary&) { stop = true; }});
  const std::vector<Individual> population = archive.population();
  const auto diverged = std::count_if(population.begin(), population.end(), [](const Individual& individual) {
    return individual.result.status == Status::diverged && individual.result.measures.empty();
  });
  EXPECT_GE(diverged, 1);
  EXPECT_LT(diverged, static_cast<std::ptrdiff_t>(population.size()));
  EXPECT_NO_THROW(check_resumable(archive, experiment));
}

TEST(SpringEvaluations, EndTheRunWithTheGenerationThatReachesThem) {
  const testing::Scratch scratch;
  Experiment experiment = testing::read(testing::small_experiment);
  const auto run = [&](const std::string& folder) {
    Archive archive = Archive::create(scratch / folder, experiment, "test");
    EXPECT_EQ(evolve_and_report(experiment, *make_cpu_simulator(experiment.scene, experiment.stepping, 1), archive), 0);
    return archive.generations();
  };
  const auto all = run("all");
  ASSERT_EQ(all.size(), 4u);
  // first exactly the number of spring evaluations in two generations, then one more
  experiment.spring_evaluations = static_cast<double>(all[0].spring_evaluations + all[1].spring_evaluations);
  EXPECT_EQ(run("two").size(), 2u);
  experiment.spring_evaluations += 1;
  EXPECT_EQ(run("three").size(), 3u);
  experiment.spring_evaluations = 1e18;
  EXPECT_EQ(run("never reached").size(), 4u);
}

TEST(Hours, EndTheRunWithTheGenerationThatReachesThem) {
  Experiment experiment;
  experiment.evaluations = 1000;
  std::vector<Summary> generations;
  for (const double seconds : {100.0, 250.0, 25.0}) generations.push_back({.evaluations = 10, .wall_time = seconds});
  EXPECT_FALSE(is_finished(experiment, generations));
  experiment.hours = 374.0 / 3600;
  EXPECT_TRUE(is_finished(experiment, generations));
  experiment.hours = 376.0 / 3600;
  EXPECT_FALSE(is_finished(experiment, generations));
}

TEST(TimeSpent, HasPartsThatFitIntoTheWhole) {
  const testing::Scratch scratch;
  const Experiment experiment = testing::read(testing::small_experiment);
  Archive archive = Archive::create(scratch / "run", experiment, "test");
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
  const std::atomic<bool> stop = false;
  const TimeSpent time = evolve(experiment, *simulator, archive, stop, {});
  for (const double part : {time.breed, time.verify, time.select, time.archive}) EXPECT_GE(part, 0);
  EXPECT_LE(time.breed + time.verify + time.select, time.whole);
  EXPECT_LE(time.archive, time.whole);

  record_time_spent(archive, time);
  record_time_spent(archive, {.whole = 100, .breed = 10, .verify = 20, .select = 30, .archive = 40});
  const TimeSpent both = recorded_time_spent(archive).value();
  EXPECT_DOUBLE_EQ(both.whole, time.whole + 100);
  EXPECT_DOUBLE_EQ(both.breed, time.breed + 10);
  EXPECT_DOUBLE_EQ(both.verify, time.verify + 20);
  EXPECT_DOUBLE_EQ(both.select, time.select + 30);
  EXPECT_DOUBLE_EQ(both.archive, time.archive + 40);
}

TEST(BestAndMedian, AreTheExtremeAndTheMiddle) {
  const auto expect = [](std::vector<double> scores, bool maximise, double best, double median) {
    const BestAndMedian found = best_and_median(std::move(scores), maximise);
    EXPECT_EQ(found.best, best);
    EXPECT_EQ(found.median, median);
  };
  expect({4, -1, 2}, true, 4, 2);
  expect({4, -1, 2}, false, -1, 2);
  expect({8, 1, 16, 2}, true, 16, 5);  // the mean of the middle two
  expect({8, 1, 16, 2}, false, 1, 5);
  expect({3}, true, 3, 3);
  const double lowest = std::numeric_limits<double>::lowest();  // what some operators give to failures
  expect({lowest, lowest}, true, lowest, lowest);
  EXPECT_FALSE(best_and_median({}, true).best.has_value());
  EXPECT_FALSE(best_and_median({}, true).median.has_value());
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
