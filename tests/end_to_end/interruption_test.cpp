// However a run is interrupted, committed generations are kept, and resuming gives the same result.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "archive/archive.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/program.hpp"
#include "support/runs.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using namespace testing;
using ::testing::HasSubstr;
using ::testing::Not;

/// A run of thirteen generations, each of which takes long enough for a test to interrupt the run after it.
class Interruption : public ::testing::Test {
 protected:
  Scratch scratch_;
  std::string file_ = scratch_.write("small.toml", small_experiment);

  std::string path(const std::string& folder) const { return (scratch_ / folder).string(); }
  Words run_command(const std::string& folder, const Words& more = {}, const std::string& window = "30") const {
    const Words values{"experiment.evaluations=75", "fitness.0.window=" + window, "fitness.1.window=" + window};
    return joined(joined(program({"run", file_, "--out", path(folder)}), setting(values)), more);
  }
  Words resume_command(const std::string& folder) const { return program({"resume", path(folder)}); }
  std::size_t generations(const std::string& folder) const { return Archive::read(path(folder)).generations().size(); }
  /// Kills a run when it has printed some lines, the first of which names the folder.
  static void kill_after(int lines, const Words& command) {
    Process process(command);
    for (int line = 0; line < lines; ++line) process.read_line();
    process.send(SIGKILL);
    process.wait();
  }
  void expect_interrupted(const std::string& folder) const {
    EXPECT_LT(generations(folder), 13u) << "it was done before it could be interrupted";
  }
  void expect_same(const std::string& a, const std::string& b) const {
    expect_same_runs(Archive::read(path(a)), Archive::read(path(b)));
  }
};

TEST_F(Interruption, AYokedRunKilledAtEachLineAndResumedEndsTheSameWithEitherJournal) {
  const Words yoked{"--set", "development.control=random-places"};
  output_of(run_command("straight", yoked));
  for (const std::string journal : {"wal", "delete"}) {
    std::set<std::size_t> complete;  // how many generations were complete each time the run was killed
    kill_after(1, run_command(journal, joined(yoked, {"--journal", journal})));
    for (int generation = 1; generation < 13; ++generation) {
      complete.insert(generations(journal));
      kill_after(2, resume_command(journal));
    }
    complete.insert(generations(journal));
    EXPECT_GT(complete.size(), 1u) << "it was done before it could be killed";
    output_of(resume_command(journal));
    expect_same("straight", journal);
  }
}

TEST_F(Interruption, ByTheClockEndsVerifiedAndGoesOnAsIfItHadNotBeen) {
  const std::string ended = output_of(
      run_command("limited", {"--no-report", "--until", "2s", "--set", "experiment.evaluations=100000"}), 130);
  EXPECT_THAT(ended, naming("verifying the best 1", "resume " + path("limited")));
  const Archive limited = Archive::read(path("limited"));
  const std::size_t done = limited.generations().size();
  ASSERT_GE(done, 1u);
  EXPECT_TRUE(limited.verification(limited.best(1).front())) << ended;
  output_of(run_command("straight", {"--no-report", "--set", "experiment.evaluations=" + std::to_string(6 * done)}));
  expect_same("straight", "limited");
}

/// Returns how many individuals were refused in a later generation than that of their birth, at least.
std::int64_t refused_elders(const Archive& archive) {
  std::map<std::uint32_t, std::int64_t> newborns;  // who are refused, by the generation of their birth
  for (std::uint32_t id = 0; archive.individual(id); ++id) {
    const ArchivedIndividual one = *archive.individual(id);
    newborns[one.born] += one.result.status == Status::artefact || one.result.status == Status::passive;
  }
  std::int64_t elders = 0;
  for (const Summary& summary : archive.generations())
    elders += std::max<std::int64_t>(0, summary.artefact + summary.passive - newborns[summary.generation]);
  return elders;
}

/// With this selection all parents die, so that elders come to the front whom nobody has verified yet.
TEST_F(Interruption, ARunThatVerifiesItsFrontIsTheSameAfterKillsAndWithAnyThreads) {
  const auto verifying = [&](const std::string& folder, const std::string& threads) {
    const Words values{"selection.name=comma", "experiment.verify_front=trials", "development.draws=individual"};
    return run_command(folder, joined(setting(values), {"--threads", threads}), "1");
  };
  output_of(verifying("straight", "1"));
  output_of(verifying("three threads", "3"));
  kill_after(3, verifying("killed", "2"));
  for (int kill = 1; kill < 4; ++kill) kill_after(3, resume_command("killed"));
  expect_interrupted("killed");
  output_of(resume_command("killed"));
  const Archive straight = Archive::read(path("straight"));
  EXPECT_GT(straight.statuses().at("artefact") + straight.statuses().at("passive"), 10);
  EXPECT_GT(refused_elders(straight), 0);
  expect_same("straight", "three threads");
  expect_same("straight", "killed");
}

TEST_F(Interruption, ARunOfSeveralLivesIsTheSameAfterKillsAndWithAnyThreads) {
  const auto living = [&](const std::string& folder, const std::string& threads) {
    const Words values{"experiment.lives=3", "experiment.birth_noise=0.01", "development.draws_between_lives=new",
                       "selection.remeasure=2", "experiment.verify_front=lives"};
    return run_command(folder, joined(setting(values), {"--threads", threads}), "1");
  };
  output_of(living("straight", "1"));
  output_of(living("three threads", "3"));
  kill_after(3, living("killed", "2"));
  for (int kill = 1; kill < 4; ++kill) kill_after(3, resume_command("killed"));
  expect_interrupted("killed");
  output_of(resume_command("killed"));
  std::size_t lives = 0;
  for (const Individual& one : Archive::read(path("straight")).population())
    lives = std::max(lives, one.result.lives.size());
  EXPECT_GE(lives, 6u) << "some have been measured again";
  expect_same("straight", "three threads");
  expect_same("straight", "killed");
}

TEST_F(Interruption, WhileARunGoesOnOthersLookAndVerifyButOnlyItWritesUntilItsFolderGoes) {
  const std::string folder = path("run");
  Process process(run_command("run", {"--set", "experiment.evaluations=6000", "--set", "experiment.verify=0"}));
  process.read_line();
  const std::string refusal = output_of(resume_command("run"), 2);
  EXPECT_THAT(refusal, naming("evodevo: " + folder + ": another evodevo process", "stop"));
  EXPECT_EQ(std::count(refusal.begin(), refusal.end(), '\n'), 1) << refusal;
  process.read_line();  // the first generation
  said({"show", folder});
  for (int i = 0; i < 2; ++i) {
    const auto verified = nlohmann::json::parse(said({"verify", folder, "--best", "1", "--json"}));
    EXPECT_TRUE(Archive::read(folder).verification(verified.at(0).at("individual").get<std::uint32_t>()).has_value());
  }
  fs::remove_all(folder);
  EXPECT_EQ(process.wait(), 1);
  EXPECT_THAT(process.output(), naming("evodevo: " + folder + ": run.sqlite", "removed", "moved", "replaced"));
  EXPECT_THAT(process.output(), Not(HasSubstr("resume " + folder)));
  EXPECT_FALSE(fs::exists(folder)) << "and nothing is left behind";
}

TEST_F(Interruption, ASignalEndsARunAfterItsGenerationAndResumeOrTheSameCommandFinishesIt) {
  output_of(run_command("straight"));
  const auto finished = [&](const std::string& folder) {
    return nlohmann::json::parse(said({"show", folder, "--json"})).at("finished");
  };
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) {
    const std::string name = sigabbrev_np(signal), folder = path(name);
    SCOPED_TRACE(name);
    const Words same = run_command(name, {"--resume"});
    Process process(signal == SIGINT ? run_command(name) : same);
    for (int line = 0; line < 2; ++line) process.read_line();
    process.send(signal);
    EXPECT_EQ(process.wait(), 130) << process.output();
    EXPECT_THAT(process.output(), naming("ended early", "evodevo resume " + folder));
    EXPECT_EQ(finished(folder), false);
    EXPECT_GE(generations(name), 1u);
    expect_interrupted(name);
    output_of(signal == SIGINT ? resume_command(name) : same);
    EXPECT_EQ(finished(folder), true);
    EXPECT_EQ(Archive::read(folder).provenances().size(), 1u);
    EXPECT_THAT(output_of(resume_command(name)), Not(HasSubstr("warning")));
    EXPECT_THAT(output_of(same), naming(folder, "complete", "75 evaluations",
                                        "--set experiment.start=" + fs::path(folder).lexically_normal().string()));
    EXPECT_THAT(output_of(joined(same, {"--seed", "83"}), 2),
                naming(folder, "[experiment] seed = 7", "[experiment] seed = 83", "--out"));
    expect_same("straight", name);
  }
}

/// The first generation takes hours, so only a second signal ends the run in time.
TEST_F(Interruption, ASecondSignalEndsARunAtOnceAndKeepsWhatWasCommitted) {
  const Words values{"experiment.population=2", "experiment.children=1000000", "experiment.evaluations=3000000"};
  Process process(run_command("run", joined(setting(values), {"--threads", "1"})));
  process.read_line();  // which names the folder
  process.send(SIGUSR1);
  process.send(SIGTERM);
  EXPECT_EQ(process.wait(), 130) << process.output();
  EXPECT_EQ(generations("run"), 0u);
}

TEST_F(Interruption, AnUnnamedFolderAndAnUnknownJournalAreRefused) {
  EXPECT_THAT(testing::refusal({"run", file_, "--resume"}), naming("--resume", "--out"));
  EXPECT_THAT(output_of(run_command("run", {"--journal", "off"}), 2), naming("--journal off: ", "wal or delete"));
}

TEST_F(Interruption, GoingOnElsewhereOrByAnotherBuildWarnsAndHasTheGivenDeviceAndThreads) {
  // the run is created by this test program, which is another build than the program that resumes it
  {
    Archive::create(path("run"), testing::read(small_experiment, {{"simulation.device", "cuda", ""}}),
                    "cpu, an older one");
  }
  const std::string begun_by = Archive::read(path("run")).provenances().front().program;
  const std::string resumed = output_of(joined(resume_command("run"), {"--device", "cpu", "--threads", "1"}));
  const Archive archive = Archive::read(path("run"));
  EXPECT_THAT(archive.evaluated_by_provenance(), ::testing::ElementsAre(0, 24));
  const Provenance now = archive.provenances().back();
  EXPECT_NE(now.device, "cpu, an older one");
  EXPECT_THAT(resumed, naming("warning: ", "cpu, an older one", " on cpu, ", ", 1 thread;",
                              "evodevo " EVODEVO_VERSION " (" + begun_by, now.program));
}

TEST_F(Interruption, TwoRunsAtOnceTakeFoldersOfTheirOwn) {
  // without --out, each run makes a folder of its own in runs/
  const std::string command = "cd '" + path("") + "' && exec '" + EVODEVO_PROGRAM + "' run small.toml";
  Process one({"sh", "-c", command}), two({"sh", "-c", command});
  EXPECT_EQ(one.wait(), 0) << one.output();
  EXPECT_EQ(two.wait(), 0) << two.output();
  for (const char* name : {"runs/small-1", "runs/small-2"}) EXPECT_EQ(generations(name), 4u) << name;
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
