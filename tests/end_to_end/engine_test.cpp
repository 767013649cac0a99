// Runs that are made through the engine alone, without the command line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/run.hpp"
#include "support/experiments.hpp"
#include "support/islands.hpp"
#include "support/lives.hpp"
#include "support/messages.hpp"
#include "support/program.hpp"
#include "support/refusals.hpp"
#include "support/runs.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// Advances a run to its end. Returns the numbers of the generations that it told of.
std::vector<std::uint32_t> advanced(evodevo::Run& run, std::atomic<bool>& stop, std::uint32_t stop_in = ~0u) {
  std::vector<std::uint32_t> told;
  run.observe({.generation_done = [&](std::int64_t, const Summary& summary) {
    told.push_back(summary.generation);
    if (summary.generation == stop_in) stop = true;
  }});
  while (run.advance()) {
  }
  run.observe({});
  return told;
}

/// What a run told while it began or was opened.
struct Heard {
  std::vector<std::string> warnings, steps;

  RunEvents events() {
    return {.warning = [this](const std::string& warning) { warnings.push_back(warning); },
            .step =
                [this](const std::string& what, const std::function<void()>& work) {
                  work();
                  steps.push_back(what);
                }};
  }
};

/// The quickstart with few evaluations, as the command makes it and as the engine does with an interruption.
TEST(Engine, ARunThatItsTokenStopsAndThatIsOpenedAgainIsThatOfTheCommand) {
  const testing::Scratch scratch;
  const fs::path file = fs::path(EVODEVO_EXPERIMENTS) / "quickstart.toml";
  const std::vector<std::string> values = {"experiment.evaluations=60", "experiment.spring_evaluations=0"};
  testing::Words words = {"run", file.string(), "--out", (scratch / "command").string(), "--no-report"};
  for (const std::string& value : values) words.insert(words.end(), {"--set", value});
  testing::said(words);

  Heard heard;
  std::atomic<bool> stop = false;
  const RunSpec spec{.folder = scratch / "engine", .stop = &stop};
  {
    auto run = evodevo::Run::begin(read_islands({file.string(), testing::overrides(values)}), spec, heard.events());
    EXPECT_THAT(advanced(run, stop, 0), ::testing::ElementsAre(0));
    EXPECT_FALSE(run.advance());
    EXPECT_FALSE(run.is_finished());
    EXPECT_GT(run.pause().whole, 0);
    EXPECT_EQ(run.archives().front().generations().size(), 1u);
    EXPECT_FALSE(run.is_complete());
    EXPECT_THAT(testing::refusal<ArchiveError>([&] { evodevo::Run::open(spec); }),
                HasSubstr(spec.folder.string() + ": another"))
        << "two hold one run";
  }
  EXPECT_THAT(heard.steps, ::testing::ElementsAre("opening the simulator"));
  stop = false;
  {
    auto run = evodevo::Run::open(spec, heard.events());
    EXPECT_THAT(advanced(run, stop), ::testing::ElementsAre(1, 2));
    EXPECT_TRUE(run.is_finished());
    const std::vector<VerifiedBest> verified = run.finish();
    ASSERT_EQ(verified.size(), 1u);
    EXPECT_EQ(verified.front().island, 0);
    ASSERT_EQ(verified.front().verifications.size(), 1u);
    EXPECT_EQ(verified.front().verifications.front().individual, run.archives().front().best(1).front());
    EXPECT_TRUE(run.is_complete());
  }
  EXPECT_THAT(heard.warnings, ::testing::IsEmpty());
  const Archive command = Archive::read(scratch / "command"), engine = Archive::read(spec.folder);
  testing::expect_same_runs(engine, command);
  const std::uint32_t best = command.best(1).front();
  EXPECT_EQ(engine.verification(best)->trials.size(), command.verification(best)->trials.size());
  EXPECT_GT(recorded_time_spent(engine)->whole, 0);

  const auto complete = evodevo::Run::open(spec);
  EXPECT_TRUE(complete.is_complete());
}

TEST(Engine, IslandsThatAreStoppedAndOpenedAgainAreThoseOfTheCommandAndMakeTheirGenerationsTogether) {
  const testing::Scratch scratch;
  const std::string file = scratch.write("islands.toml", testing::small_islands);
  testing::said({"run", file, "--out", (scratch / "command").string(), "--no-report"});
  std::atomic<bool> stop = false;
  const RunSpec spec{.folder = scratch / "engine", .stop = &stop};
  {
    auto run = evodevo::Run::begin(read_islands({file, {}}), spec);
    EXPECT_THAT(advanced(run, stop, 1), ::testing::ElementsAre(0, 0, 0, 1, 1, 1));
    run.pause();
    EXPECT_THAT(next_generations(run.archives()), ::testing::ElementsAre(2, 2, 2));
    EXPECT_FALSE(run.is_finished());
  }
  stop = false;
  auto run = evodevo::Run::open(spec);
  EXPECT_THAT(advanced(run, stop), ::testing::SizeIs(15));
  std::size_t verified = 0;
  for (const VerifiedBest& best : run.finish()) {
    EXPECT_GT(best.island, 0);
    verified += best.verifications.size();
  }
  EXPECT_EQ(verified, static_cast<std::size_t>(run.experiments().front().verify));
  EXPECT_TRUE(run.is_complete());
  testing::expect_same_islands(scratch / "command", spec.folder);
}

TEST(Engine, ManyRunsLiveInOneProcessAndStopOneByOne) {
  const testing::Scratch scratch;
  std::atomic<bool> stop = false;
  auto first = evodevo::Run::begin(testing::alone(testing::small()), {.folder = scratch / "first", .stop = &stop});
  auto second = evodevo::Run::begin(testing::alone(testing::small()), {.folder = scratch / "second"});
  EXPECT_TRUE(first.advance());
  stop = true;
  EXPECT_FALSE(first.advance());
  while (second.advance()) {
  }
  stop = false;
  while (first.advance()) {
  }
  first.finish();
  second.finish();
  testing::expect_same_runs(first.archives().front(), second.archives().front());
}

TEST(Engine, ARunGoesOnAfterAPauseWithItsTimesAddedUp) {
  const testing::Scratch scratch;
  auto run = evodevo::Run::begin(testing::alone(testing::small()), {.folder = scratch / "run"});
  double sum = 0;
  do {
    sum += run.pause().whole;
  } while (run.advance());
  sum += run.pause().whole;
  EXPECT_NEAR(recorded_time_spent(run.archives().front())->whole, sum, 1e-9 + 1e-6 * sum);
  testing::expect_same_runs(run.archives().front(), testing::FinishedRun(testing::small()).archive);
}

TEST(Engine, TellsWarningsAndRefusesBeforeAnythingIsWritten) {
  const testing::Scratch scratch;
  Heard heard;
  const auto begin = [&](const char* value) {
    evodevo::Run::begin(testing::alone(testing::small({value})), {.folder = scratch / "run"}, heard.events());
  };
  const std::string start = "experiment.start='" + (scratch / "nowhere").string() + "'";
  EXPECT_THAT(testing::refusal<InputError>([&] { begin(start.c_str()); }), HasSubstr("nowhere"));
  EXPECT_FALSE(fs::exists(scratch / "run"));
  begin("experiment.random_individuals=6");
  EXPECT_THAT(heard.warnings, ::testing::Contains(HasSubstr("experiment.random_individuals = 6")));
  EXPECT_TRUE(fs::exists(scratch / "run"));
  const auto other = testing::alone(testing::small());
  EXPECT_THAT(testing::refusal<ArchiveError>([&] { evodevo::Run::open({.folder = scratch / "run"}, {}, &other); }),
              HasSubstr("random_individuals = 1"));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
