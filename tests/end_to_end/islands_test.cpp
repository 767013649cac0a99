// The commands on a run with islands.
#include "support/islands.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "support/messages.hpp"
#include "support/process.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using testing::Finished;
using testing::naming;

class IslandCommands : public ::testing::Test {
 protected:
  Finished evodevo(std::vector<std::string> words) const {
    words.insert(words.begin(), EVODEVO_PROGRAM);
    return testing::run(words);
  }
  Finished begin(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"run", file_, "--out", run_, "--device", "cpu", "--no-report"};
    words.insert(words.end(), more.begin(), more.end());
    return evodevo(words);
  }

  testing::Scratch scratch_;
  const std::string file_ = scratch_.write("islands.toml", testing::small_islands);
  const std::string run_ = (scratch_ / "run").string();
  const std::string second_ = (scratch_ / "run" / "island-2").string();
};

TEST_F(IslandCommands, ReadTheRunOrOneOfItsIslands) {
  const Finished finished = begin({"--log", (scratch_ / "log").string()});
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output, naming("evaluations 104/104", "3 islands", run_ + "/island-"));
  EXPECT_THAT(evodevo({"show", run_}).output,
              naming("\n     1           7           35", "\n     3           7           34"));
  EXPECT_THAT(evodevo({"show", run_, "--json"}).output, naming("\"islands\"", "\"topology\": \"ring\""));
  EXPECT_THAT(evodevo({"show", second_}).output, naming("island 2 of 3", "35 evaluations"));
  const Finished life = evodevo({"life", run_});
  EXPECT_EQ(life.exit_code, 2);
  EXPECT_THAT(life.output, naming(run_, run_ + "/island-1"));
  EXPECT_EQ(evodevo({"life", second_}).exit_code, 0);
  EXPECT_EQ(evodevo({"show", run_, "--individual", "7"}).exit_code, 2);
  std::ifstream log(scratch_ / "log");
  int lines = 0;
  for (std::string line; std::getline(log, line); ++lines) EXPECT_THAT(line, naming("\"island\":"));
  EXPECT_EQ(lines, 21);
}

TEST_F(IslandCommands, ContinueOnlyTheWholeRun) {
  ASSERT_EQ(begin().exit_code, 0);
  const Finished alone = evodevo({"resume", second_});
  EXPECT_EQ(alone.exit_code, 2);
  EXPECT_THAT(alone.output, naming(second_));
  EXPECT_EQ(evodevo({"resume", run_}).exit_code, 0);
  EXPECT_EQ(begin({"--resume"}).exit_code, 0);
  EXPECT_EQ(begin({"--resume", "--set", "islands.count=4"}).exit_code, 2);
  EXPECT_EQ(begin().exit_code, 2) << "the folder is not empty";
  fs::remove_all(second_);
  const Finished without = evodevo({"resume", run_});
  EXPECT_EQ(without.exit_code, 2);
  EXPECT_THAT(without.output, naming(second_, "3 islands"));
  EXPECT_EQ(begin({"--resume"}).exit_code, 2) << "the other islands have generations";
}

TEST_F(IslandCommands, WriteNoLogIntoAnIsland) {
  ASSERT_EQ(begin({"--until", "1s", "--set", "experiment.evaluations=100000"}).exit_code, 130);
  const Finished finished = evodevo({"resume", run_, "--log", second_ + "/run.sqlite"});
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_THAT(finished.output, naming("--log", second_ + "/run.sqlite"));
  EXPECT_EQ(evodevo({"show", second_}).exit_code, 0);
}

TEST_F(IslandCommands, BeginAgainWhatEndedWhileItWasCreated) {
  ASSERT_EQ(begin().exit_code, 0);
  const fs::path straight = scratch_ / "straight";
  fs::rename(run_, straight);
  { Archive::create(fs::path(run_) / "island-1", testing::read_islands(scratch_, testing::small_islands)[0], "cpu"); }
  fs::create_directory(second_);
  std::ofstream(second_ + "/run.sqlite") << "";
  const Finished finished = begin({"--resume"});
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  testing::expect_same_islands(straight, run_);
}

TEST_F(IslandCommands, CheckShowsWhoSendsToWhom) {
  const Finished finished = evodevo({"check", file_, "--set", "islands.topology=star"});
  EXPECT_EQ(finished.exit_code, 0);
  EXPECT_THAT(finished.output, naming("island 1: ", "sends to 2, 3\n", "seed 41", "elitist; sends to 1\n"));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
