// Runs that fail in the middle: committed generations are kept, and resuming gives the same result as without a
// failure.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "archive/progress.hpp"
#include "archive/record_check.hpp"
#include "base/statistics.hpp"
#include "commands/run/run.hpp"
#include "support/experiments.hpp"
#include "support/lives.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"
#include "support/runs.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

/// A simulator whose device is lost when the lives of generation `lost` begin, counted from 0.
class Breaking final : public testing::AlteredSimulator {
 public:
  Breaking(const Experiment& experiment, std::size_t lost) : AlteredSimulator(experiment), lost_(lost) {}

  void run(std::span<Task> tasks, Recording recording) override {
    const bool is_birth = !tasks.empty() && tasks.front().state->time == 0;
    if (is_birth && generations_++ == lost_) throw std::runtime_error("CUDA: simulating on the GPU failed");
    AlteredSimulator::run(tasks, recording);
  }

 private:
  std::size_t lost_, generations_ = 0;
};

TEST(LostDevice, SaysWhatIsCompleteAndARunThatGoesOnEndsAsIfItHadNotBeen) {
  const testing::Scratch scratch;
  const Experiment experiment = testing::small();
  const auto failure = [&](const std::string& name, std::size_t generations) {
    evodevo::Run run = testing::run_of(testing::small(), std::make_unique<Breaking>(experiment, generations),
                                       Archive::create(scratch / name, experiment, "test"));
    const std::string said = testing::refusal<std::runtime_error>([&] { evolve_and_report(run); });
    EXPECT_EQ(run.archives().front().generations().size(), generations);
    return said;
  };
  const std::string device = "CUDA: simulating on the GPU failed\n";
  EXPECT_THAT(failure("early", 0), testing::at_place(device, "no generation", " resume "));
  const auto folder = scratch / "broken";
  EXPECT_THAT(failure("broken", 3), testing::at_place(device, "generation 2", " resume " + folder.string()));
  {
    evodevo::Run run = testing::run_of(testing::small(), std::make_unique<testing::AlteredSimulator>(experiment),
                                       Archive::resume(folder));
    EXPECT_EQ(evolve_and_report(run), 0);
  }
  testing::expect_same_runs(Archive::read(folder), testing::FinishedRun(testing::small()).archive);
}

TEST(LostDevice, ARunThatIsHeldGoesOnFromTheGenerationBefore) {
  const testing::Scratch scratch;
  evodevo::Run run = testing::run_of(testing::small(), std::make_unique<Breaking>(testing::small(), 2),
                                     Archive::create(scratch / "run", testing::small(), "test"));
  EXPECT_TRUE(run.advance());
  EXPECT_TRUE(run.advance());
  EXPECT_THROW(run.advance(), std::runtime_error);
  EXPECT_EQ(run.archives().front().generations().size(), 2u);
  while (run.advance()) {
  }
  run.pause();
  testing::expect_same_runs(run.archives().front(), testing::FinishedRun(testing::small()).archive);
}

/// Bone is so stiff that whole voxels of it diverge at 0.5 ms. Before such a body is flagged, it moves farther than any
/// robot walks. Where more is measured than the objectives, it has none of those scores.
TEST(Flagged, BodiesAreTakenFromTheRecordAndNeverWinThoughManyAreBorn) {
  const testing::Scratch scratch;
  const std::string height = "[[fitness]]\nname = \"descriptor\"\nwhat = \"height\"\nrange = [0.0, 2.0]\n";
  const Experiment experiment = testing::read(
      testing::small_experiment + height,
      testing::overrides({"materials.bone.stiffness=1e6", "simulation.unstable=run", "experiment.evaluations=60"}));
  Archive archive = Archive::create(scratch / "run", experiment, "test");
  testing::evolve_to(1, experiment, archive);
  const std::vector<Individual> population = archive.population();
  const auto flagged = std::ranges::count_if(population, [](const Individual& individual) {
    return individual.result.status == Status::diverged && individual.result.measures.empty();
  });
  EXPECT_GE(flagged, 1);
  EXPECT_LT(flagged, static_cast<std::ptrdiff_t>(population.size()));
  EXPECT_NO_THROW(check_resumable(archive, experiment));

  testing::evolve_to(100, experiment, archive);
  int diverged = 0, survivors = 0;
  for (std::uint32_t id = 0; id < experiment.evaluations; ++id) {
    const ArchivedIndividual individual = archive.individual(id).value();
    survivors += !individual.died;
    if (individual.result.status != Status::diverged) continue;
    ++diverged;
    EXPECT_TRUE(individual.died) << id << " survived";
  }
  EXPECT_GE(diverged, 5);
  EXPECT_EQ(survivors, 6);
  for (const std::uint32_t id : archive.best(60)) EXPECT_EQ(archive.individual(id)->result.status, Status::ok);
}

TEST(ARun, EndsWithTheGenerationThatReachesOneOfItsLimits) {
  Experiment experiment;
  experiment.evaluations = 31;
  std::vector<Summary> generations;
  for (const double seconds : {100.0, 250.0, 25.0})
    generations.push_back({.evaluations = 30, .spring_evaluations = 7, .wall_time = seconds});
  const auto is_finished = [&] { return evodevo::is_finished(experiment, generations); };
  EXPECT_FALSE(is_finished());
  experiment.hours = 374.0 / 3600;
  EXPECT_TRUE(is_finished());
  experiment.hours = 376.0 / 3600;
  EXPECT_FALSE(is_finished());
  experiment.spring_evaluations = 21;
  EXPECT_TRUE(is_finished());
  experiment.spring_evaluations = 22;
  EXPECT_FALSE(is_finished());
  experiment.evaluations = 30;
  EXPECT_TRUE(is_finished());
}

TEST(TimeSpent, HasPartsThatFitIntoTheWhole) {
  const testing::Scratch scratch;
  const Experiment experiment = testing::small();
  Archive archive = Archive::create(scratch / "run", experiment, "test");
  const TimeSpent time = testing::evolve_to(100, experiment, archive);
  EXPECT_LE(time.breed + time.verify + time.select, time.whole);
  EXPECT_LE(time.archive, time.whole);
  EXPECT_GT(archive.generations().front().spring_evaluations, 0u);
  const TimeSpent more{.whole = 100, .breed = 10, .verify = 20, .select = 30, .archive = 40};
  record_time_spent(archive, time);
  record_time_spent(archive, more);
  const TimeSpent both = recorded_time_spent(archive).value();
  for (const auto part :
       {&TimeSpent::whole, &TimeSpent::breed, &TimeSpent::verify, &TimeSpent::select, &TimeSpent::archive}) {
    EXPECT_GE(time.*part, 0);
    EXPECT_DOUBLE_EQ(both.*part, time.*part + more.*part);
  }
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
