// Runs that begin with the population of another run.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "evolution/archive/archive.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/process.hpp"
#include "support/runs.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using testing::Finished;

class Start : public ::testing::Test {
 protected:
  Start() { EXPECT_EQ(run("home", {}).exit_code, 0); }

  /// Runs the small experiment into a folder, with values for keys.
  Finished run(const std::string& folder, const std::vector<std::string>& values, const char* command = "run") {
    std::vector<std::string> words{EVODEVO_PROGRAM, command, file_};
    if (std::string(command) == "run")
      words.insert(words.end(), {"--no-report", "--out", (scratch_ / folder).string()});
    for (const std::string& value : values) words.insert(words.end(), {"--set", value});
    return testing::run(words);
  }

  /// Returns the individuals of a run that were born in its first generation.
  std::vector<Individual> first_born(const std::string& folder) const {
    const Archive archive = Archive::read(scratch_ / folder);
    std::vector<Individual> born;
    for (std::uint32_t id = 0; archive.individual(id) && archive.individual(id)->born == 0; ++id)
      born.push_back(*archive.individual(id));
    return born;
  }

  testing::Scratch scratch_;
  std::string file_ = scratch_.write("small.toml", testing::small_experiment);
  std::string start_ = "experiment.start=\"home\"";  // relative to the file
};

TEST_F(Start, ThePopulationIsBornAgainInAnotherScene) {
  const Finished finished = run("away", {start_, "experiment.seed=8", "scene.friction.coefficient=0.1",
                                         "experiment.children=9", "experiment.evaluations=23"});
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  const std::vector<Individual> home = Archive::read(scratch_ / "home").population(), away = first_born("away");
  ASSERT_EQ(away.size(), 9u);
  ASSERT_EQ(home.size(), 6u);
  for (std::size_t i = 0; i < away.size(); ++i) {
    EXPECT_EQ(away[i].origin, 0u);
    EXPECT_TRUE(away[i].parents.empty());
    if (i >= home.size()) {
      EXPECT_EQ(away[i].made_by, "random");
      EXPECT_FALSE(away[i].migrated);
      continue;
    }
    EXPECT_EQ(away[i].made_by, "start");
    EXPECT_EQ(away[i].genome, home[i].genome);
    EXPECT_EQ(away[i].migrated, (Migrated{0, home[i].id}));
  }
  const auto scores = [](const std::vector<Individual>& some) {
    std::vector<std::vector<double>> all;
    for (const Individual& one : some) all.push_back(one.result.objectives);
    return all;
  };
  EXPECT_NE(scores(home), scores({away.begin(), away.begin() + 6})) << "they are measured in the new scene";
}

TEST_F(Start, IfThereIsNotRoomForAllTheBestCome) {
  ASSERT_EQ(run("small", {start_, "experiment.population=4", "experiment.children=4"}).exit_code, 0);
  const Archive home = Archive::read(scratch_ / "home");
  std::vector<std::uint32_t> best = home.best(100), living;
  for (const Individual& one : home.population()) living.push_back(one.id);
  std::erase_if(best, [&](std::uint32_t id) { return std::ranges::find(living, id) == living.end(); });
  ASSERT_GE(best.size(), 4u);
  best.resize(4);
  std::ranges::sort(best);
  std::vector<std::uint32_t> came;
  for (const Individual& one : first_born("small")) came.push_back(one.migrated->individual);
  EXPECT_EQ(came, best);
}

TEST_F(Start, ARunThatIsInterruptedAfterwardsNeedsTheOtherRunNoMore) {
  const std::string evaluations = "experiment.evaluations=600";
  ASSERT_EQ(run("straight", {start_, evaluations}).exit_code, 0);
  testing::Process process({EVODEVO_PROGRAM, "run", file_, "--no-report", "--out", (scratch_ / "killed").string(),
                            "--set", start_, "--set", evaluations});
  for (int line = 0; line < 3; ++line) process.read_line();  // its folder, and two generations
  process.send(SIGKILL);
  process.wait();
  const std::size_t done = Archive::read(scratch_ / "killed").generations().size();
  ASSERT_GE(done, 1u);
  ASSERT_LT(done, Archive::read(scratch_ / "straight").generations().size()) << "it was done before it could be killed";
  std::filesystem::remove_all(scratch_ / "home");
  const Finished resumed = testing::run({EVODEVO_PROGRAM, "resume", "--no-report", (scratch_ / "killed").string()});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.output;
  testing::expect_same_runs(Archive::read(scratch_ / "straight"), Archive::read(scratch_ / "killed"));
}

TEST_F(Start, FoundersAreNoImmigrants) {
  ASSERT_EQ(run("islands", {start_, "islands.count=2", "islands.every=1", "islands.migrants=3",
                            "islands.emigrants=\"random\"", "experiment.evaluations=132"})
                .exit_code,
            0);
  const auto shown = [&](const std::vector<std::string>& words) {
    std::vector<std::string> command{EVODEVO_PROGRAM, "show"};
    command.insert(command.end(), words.begin(), words.end());
    const Finished finished = testing::run(command);
    EXPECT_EQ(finished.exit_code, 0) << finished.output;
    return finished.output;
  };
  shown({(scratch_ / "islands").string()});
  const std::string island = (scratch_ / "islands/island-2").string();
  const Archive archive = Archive::read(island);
  EXPECT_EQ(first_born("islands/island-2").front().migrated->island, 0);
  for (const Immigrant& one : archive.immigrants()) EXPECT_EQ(one.from.island, 1);
  EXPECT_FALSE(archive.immigrants().empty()) << "children of founders have migrated";
  const Individual founder = *archive.individual(0);
  EXPECT_THAT(shown({island, "--individual", "0"}),
              testing::naming("start", std::to_string(founder.migrated->individual)));
}

TEST_F(Start, CheckSaysWhatComes) {
  const Finished finished = run("", {start_}, "check");
  EXPECT_EQ(finished.exit_code, 0);
  EXPECT_THAT(finished.output, testing::naming("6", (scratch_ / "home").lexically_normal().string()));
}

TEST_F(Start, WhatCannotBeBornAgainIsRefusedBeforeAnythingIsWritten) {
  const auto refusal = [&](const std::vector<std::string>& values) {
    for (const char* command : {"check", "run"}) {
      const Finished finished = run("refused", values, command);
      EXPECT_EQ(finished.exit_code, 2) << finished.output;
      EXPECT_FALSE(std::filesystem::exists(scratch_ / "refused"));
      if (std::string(command) == "run") return finished.output;
    }
    return std::string();
  };
  EXPECT_THAT(refusal({"experiment.start=\"elsewhere\""}),
              testing::naming("experiment.start: " + (scratch_ / "elsewhere").lexically_normal().string()));
  EXPECT_THAT(refusal({start_, "encoding.size=[3, 1, 1]"}), testing::naming("experiment.start", "encoding"));
  std::filesystem::copy(scratch_ / "home", scratch_ / "damaged");
  SQLite::Database((scratch_ / "damaged/run.sqlite").string(), SQLite::OPEN_READWRITE)
      .exec("UPDATE individuals SET genes = substr(genes, 1, length(genes) - 4)");
  EXPECT_THAT(refusal({"experiment.start=\"damaged\""}),
              testing::naming("experiment.start", "damaged", "individual ", "undamaged copy"));

  std::string text = testing::small_experiment;
  const std::size_t begin = text.find("[encoding]"), end = text.find("[scene.gravity]");
  text.replace(begin, end - begin, "[encoding]\nname = \"neural\"\npoints = 9\n");
  file_ = scratch_.write("without-variation.toml", text);
  EXPECT_THAT(refusal({start_, "selection.name=\"cma-es\"", "experiment.random_individuals=0"}),
              testing::naming("experiment.start", "cma-es"));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
