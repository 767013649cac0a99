// However a run is interrupted, committed generations are kept, and resuming gives the same result.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "evolution/archive/archive.hpp"
#include "report/report.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/process.hpp"
#include "support/runs.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Process;

/// A run of thirteen generations, each of which takes long enough for a test to interrupt the run after it.
class Interruption : public ::testing::Test {
 protected:
  testing::Scratch scratch_;
  std::string file_ = scratch_.write("small.toml", testing::small_experiment);

  std::vector<std::string> run_command(const std::string& folder, const std::string& window = "30") const {
    return {EVODEVO_PROGRAM,
            "run",
            file_,
            "--out",
            (scratch_ / folder).string(),
            "--set",
            "experiment.evaluations=75",
            "--set",
            "fitness.0.window=" + window,
            "--set",
            "fitness.1.window=" + window};
  }
  std::vector<std::string> resume_command(const std::string& folder) const {
    return {EVODEVO_PROGRAM, "resume", (scratch_ / folder).string()};
  }
};

class InterruptedJournal : public Interruption, public ::testing::WithParamInterface<const char*> {};

TEST_P(InterruptedJournal, KilledAtEachLineAndResumedEndsTheSame) {
  ASSERT_EQ(testing::run(run_command("straight")).exit_code, 0);
  std::vector<std::string> command = run_command("killed");
  command.insert(command.end(), {"--journal", GetParam()});
  std::set<std::size_t> complete;  // how many generations were complete each time the run was killed
  const auto run_to_line = [&](int line) {
    Process process(command);
    // once the first line, which names the folder, is printed, the run can be resumed
    for (int i = 0; i < line; ++i) process.read_line();
    process.send(SIGKILL);
    process.wait();
    command = resume_command("killed");
    complete.insert(Archive::read(scratch_ / "killed").generations().size());
  };
  run_to_line(1);
  for (int generation = 1; generation < 13; ++generation) run_to_line(2);
  EXPECT_GT(complete.size(), 1u) << "it was done before it could be killed";
  const testing::Finished finished = testing::run(command);
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  testing::expect_same_runs(Archive::read(scratch_ / "straight"), Archive::read(scratch_ / "killed"));
}

TEST_F(Interruption, ByTheClockEndsVerifiedAndGoesOnAsIfItHadNotBeen) {
  std::vector<std::string> command = run_command("limited");
  command.insert(command.end(), {"--no-report", "--until", "2s", "--set", "experiment.evaluations=100000"});
  const testing::Finished ended = testing::run(command);
  EXPECT_EQ(ended.exit_code, 130) << ended.output;
  EXPECT_THAT(ended.output, testing::naming("verifying the best 1", "resume " + (scratch_ / "limited").string()));
  const Archive limited = Archive::read(scratch_ / "limited");
  const std::size_t generations = limited.generations().size();
  ASSERT_GE(generations, 1u);
  EXPECT_TRUE(limited.verification(limited.best(1).front())) << ended.output;

  command = run_command("straight");
  command.insert(command.end(), {"--no-report", "--set", "experiment.evaluations=" + std::to_string(6 * generations)});
  const testing::Finished straight = testing::run(command);
  ASSERT_EQ(straight.exit_code, 0) << straight.output;
  testing::expect_same_runs(Archive::read(scratch_ / "straight"), limited);
}

INSTANTIATE_TEST_SUITE_P(Journals, InterruptedJournal, ::testing::Values("wal", "delete"),
                         [](const auto& instance) { return std::string(instance.param); });

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
    std::vector<std::string> command = run_command(folder, "1");
    command.insert(command.end(),
                   {"--set", "selection.name=comma", "--set", "experiment.verify_front=true", "--threads", threads});
    return command;
  };
  ASSERT_EQ(testing::run(verifying("straight", "1")).exit_code, 0);
  ASSERT_EQ(testing::run(verifying("three threads", "3")).exit_code, 0);
  std::vector<std::string> command = verifying("killed", "2");
  for (int kill = 0; kill < 4; ++kill) {
    Process process(command);
    for (int line = 0; line < 3; ++line) process.read_line();
    process.send(SIGKILL);
    process.wait();
    command = resume_command("killed");
  }
  EXPECT_LT(Archive::read(scratch_ / "killed").generations().size(), 13u) << "it was done before it could be killed";
  const testing::Finished finished = testing::run(command);
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  const Archive straight = Archive::read(scratch_ / "straight");
  EXPECT_GT(straight.statuses().at("artefact") + straight.statuses().at("passive"), 10);
  EXPECT_GT(refused_elders(straight), 0);
  testing::expect_same_runs(straight, Archive::read(scratch_ / "three threads"));
  testing::expect_same_runs(straight, Archive::read(scratch_ / "killed"));
}

TEST_F(Interruption, ARunWhoseDevoOperatorRemembersIsTheSameAfterAKill) {
  const std::string library = (fs::path(EVODEVO_FAULTY_PLUGINS) / "special/plugin.evodevo.so").string();
  const auto with_memory = [&](std::vector<std::string> command) {
    command.insert(command.end(), {"--plugin-path", library});
    return command;
  };
  const auto run = [&](const std::string& folder) {
    std::vector<std::string> command = with_memory(run_command(folder));
    command.insert(command.end(), {"--set", "development.operator.0={name='feeling'}"});
    return command;
  };
  const testing::Finished straight = testing::run(run("straight"));
  ASSERT_EQ(straight.exit_code, 0) << straight.output;
  {
    Process process(run("killed"));
    for (int line = 0; line < 5; ++line) process.read_line();
    process.send(SIGKILL);
    process.wait();
  }
  EXPECT_LT(Archive::read(scratch_ / "killed").generations().size(), 13u) << "it was done before it could be killed";
  const testing::Finished resumed = testing::run(with_memory(resume_command("killed")));
  ASSERT_EQ(resumed.exit_code, 0) << resumed.output;
  testing::expect_same_runs(Archive::read(scratch_ / "straight"), Archive::read(scratch_ / "killed"));
}

TEST_F(Interruption, AJournalThatThereIsNotIsRefused) {
  std::vector<std::string> command = run_command("run");
  command.insert(command.end(), {"--journal", "off"});
  const testing::Finished finished = testing::run(command);
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_THAT(finished.output, testing::naming("--journal off: ", "wal or delete"));
}

TEST_F(Interruption, AFolderThatGoesEndsTheRun) {
  const fs::path folder = scratch_ / "run";
  std::vector<std::string> command = run_command("run");
  command.insert(command.end(), {"--set", "experiment.evaluations=6000"});
  Process process(command);
  process.read_line();
  process.read_line();  // the first generation
  fs::remove_all(folder);
  EXPECT_EQ(process.wait(), 1);
  EXPECT_THAT(process.output(),
              testing::naming("evodevo: " + folder.string() + ": run.sqlite", "removed", "moved", "replaced"));
  EXPECT_THAT(process.output(), Not(HasSubstr("resume " + folder.string())));
  EXPECT_FALSE(fs::exists(folder)) << "and nothing is left behind";
}

TEST_F(Interruption, AVerificationWhileARunGoesOnIsKept) {
  const std::string folder = (scratch_ / "run").string();
  std::vector<std::string> command = run_command("run");
  command.insert(command.end(), {"--set", "experiment.evaluations=6000", "--set", "experiment.verify=0"});
  Process process(command);
  process.read_line();
  process.read_line();
  for (int i = 0; i < 2; ++i) {
    const testing::Finished verified = testing::run({EVODEVO_PROGRAM, "verify", folder, "--best", "1", "--json"});
    EXPECT_EQ(verified.exit_code, 0) << verified.output;
    const auto id = nlohmann::json::parse(verified.output).at(0).at("individual").get<std::uint32_t>();
    EXPECT_TRUE(Archive::read(folder).verification(id).has_value());
  }
  process.send(SIGINT);
  EXPECT_EQ(process.wait(), 130) << process.output();
}

TEST_F(Interruption, AYokedRunGoesOnTheSame) {
  const auto yoked = [&](const std::string& folder) {
    std::vector<std::string> command = run_command(folder);
    command.insert(command.end(), {"--set", "development.control=random-places"});
    return command;
  };
  ASSERT_EQ(testing::run(yoked("straight")).exit_code, 0);
  Process process(yoked("killed"));
  for (int line = 0; line < 3; ++line) process.read_line();
  process.send(SIGKILL);
  process.wait();
  EXPECT_LT(Archive::read(scratch_ / "killed").generations().size(), 13u) << "it was done before it could be killed";
  const testing::Finished finished = testing::run(resume_command("killed"));
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  testing::expect_same_runs(Archive::read(scratch_ / "straight"), Archive::read(scratch_ / "killed"));
}

TEST_F(Interruption, CtrlCCommitsAndSaysHowToGoOn) {
  ASSERT_EQ(testing::run(run_command("straight")).exit_code, 0);
  Process process(run_command("stopped"));
  process.read_line();
  process.read_line();
  process.send(SIGINT);
  EXPECT_EQ(process.wait(), 130) << process.output();
  const std::string folder = (scratch_ / "stopped").string();
  EXPECT_THAT(process.output(), testing::naming("ended early", "evodevo resume " + folder));
  const auto finished = [&] {
    return nlohmann::json::parse(testing::run({EVODEVO_PROGRAM, "show", folder, "--json"}).output).at("finished");
  };
  EXPECT_EQ(finished(), false);
  const std::size_t done = Archive::read(folder).generations().size();
  EXPECT_GE(done, 1u);
  EXPECT_LT(done, 13u);
  EXPECT_EQ(testing::run(resume_command("stopped")).exit_code, 0);
  EXPECT_EQ(finished(), true);
  testing::expect_same_runs(Archive::read(scratch_ / "straight"), Archive::read(folder));
}

class EndingSignal : public Interruption, public ::testing::WithParamInterface<int> {
 protected:
  std::vector<std::string> restartable_command(const std::string& folder) const {
    std::vector<std::string> command = run_command(folder);
    command.emplace_back("--resume");
    return command;
  }
};

TEST_P(EndingSignal, EndsARunAfterItsGenerationAndTheSameCommandFinishesIt) {
  ASSERT_EQ(testing::run(run_command("straight")).exit_code, 0);
  Process process(restartable_command("stopped"));
  for (int line = 0; line < 2; ++line) process.read_line();
  process.send(GetParam());
  EXPECT_EQ(process.wait(), 130) << process.output();
  const std::size_t done = Archive::read(scratch_ / "stopped").generations().size();
  EXPECT_GE(done, 1u);
  EXPECT_LT(done, 13u);
  const testing::Finished finished = testing::run(restartable_command("stopped"));
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  testing::expect_same_runs(Archive::read(scratch_ / "straight"), Archive::read(scratch_ / "stopped"));
  const testing::Finished again = testing::run(restartable_command("stopped"));
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_THAT(again.output, testing::naming((scratch_ / "stopped").string(), "complete", "75 evaluations",
                                            "--set experiment.start=" + (scratch_ / "stopped").string()));
}

INSTANTIATE_TEST_SUITE_P(Signals, EndingSignal, ::testing::Values(SIGINT, SIGTERM, SIGUSR1),
                         [](const auto& instance) { return std::string(sigabbrev_np(instance.param)); });

/// The first generation takes hours, so only a second signal ends the run in time.
TEST_F(Interruption, ASecondSignalEndsARunAtOnceAndKeepsWhatWasCommitted) {
  std::vector<std::string> command = run_command("run");
  command.insert(command.end(), {"--set", "experiment.population=2", "--set", "experiment.children=1000000", "--set",
                                 "experiment.evaluations=3000000", "--threads", "1"});
  Process process(command);
  process.read_line();  // which names the folder
  process.send(SIGUSR1);
  process.send(SIGTERM);
  EXPECT_EQ(process.wait(), 130) << process.output();
  EXPECT_EQ(Archive::read(scratch_ / "run").generations().size(), 0u);
}

TEST_F(Interruption, TheSameCommandWithAnotherExperimentIsRefused) {
  std::vector<std::string> command = run_command("run");
  command.emplace_back("--resume");
  ASSERT_EQ(testing::run(command).exit_code, 0);
  command.insert(command.end(), {"--seed", "83"});
  const testing::Finished finished = testing::run(command);
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_THAT(finished.output,
              testing::naming((scratch_ / "run").string(), "[experiment] seed = 7", "[experiment] seed = 83", "--out"));
}

TEST_F(Interruption, ResumingAnUnnamedFolderIsRefused) {
  const testing::Finished finished = testing::run({EVODEVO_PROGRAM, "run", file_, "--resume"});
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_THAT(finished.output, testing::naming("--resume", "--out"));
}

TEST_F(Interruption, ASecondProcessOnOneFolderIsRefused) {
  const std::string folder = (scratch_ / "run").string();
  Process first(run_command("run"));
  first.read_line();
  const testing::Finished second = testing::run(resume_command("run"));
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_EQ(second.output,
            "evodevo: " + folder + ": another evodevo process is writing this run; wait for it or stop it first\n");
  EXPECT_EQ(testing::run({EVODEVO_PROGRAM, "show", folder}).exit_code, 0) << "looking is allowed";
  EXPECT_EQ(first.wait(), 0) << "and disturbs nobody";
}

TEST_F(Interruption, ReportsOfARunThatGoesOnDisturbItNotAtAll) {
  ASSERT_EQ(testing::run(run_command("straight")).exit_code, 0);
  const fs::path folder = scratch_ / "run";
  Process process(run_command("run"));
  process.read_line();
  process.read_line();  // the first generation
  std::set<std::int64_t> seen;
  do {
    const Archive archive = Archive::read(folder);
    Experiment experiment = recorded_experiment(archive);
    const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
    const auto run = reported_run(archive, std::move(experiment), *simulator, {.best = 1}, 1'000'000);
    seen.insert(run["evaluations"].get<std::int64_t>());
    // all numbers in a report must belong to the same moment
    std::int64_t evaluations = 0;
    for (const auto& count : run["statuses"]) evaluations += count.get<std::int64_t>();
    EXPECT_EQ(run["evaluations"], evaluations);
    for (const auto& individual : run["population"])
      EXPECT_LE(individual["age"].get<std::size_t>(), run["generations"].size());
  } while (process.read_line());
  EXPECT_EQ(process.wait(), 0) << process.output();
  EXPECT_GT(seen.size(), 1u) << "nothing was seen of it going on";
  EXPECT_LT(*seen.begin(), 75);
  testing::expect_same_runs(Archive::read(scratch_ / "straight"), Archive::read(folder));
}

TEST_F(Interruption, AFinishedRunHasNothingToResume) {
  ASSERT_EQ(testing::run(run_command("run")).exit_code, 0);
  const std::size_t before = Archive::read(scratch_ / "run").generations().size();
  EXPECT_EQ(testing::run(resume_command("run")).exit_code, 0);
  EXPECT_EQ(Archive::read(scratch_ / "run").generations().size(), before);
}

TEST_F(Interruption, GoingOnElsewhereOrByAnotherBuildWarns) {
  // the run is created by this test program, which is another build than the program that resumes it
  { Archive::create(scratch_ / "run", testing::read(testing::small_experiment), "cpu, an older one"); }
  const std::string begun_by = Archive::read(scratch_ / "run").provenances().front().program;
  const testing::Finished resumed = testing::run(resume_command("run"));
  EXPECT_EQ(resumed.exit_code, 0);
  EXPECT_THAT(resumed.output, testing::naming("warning: ", "cpu, an older one", " on cpu, "));
  const Archive archive = Archive::read(scratch_ / "run");
  EXPECT_THAT(archive.evaluated_by_provenance(), ::testing::ElementsAre(0, 24));
  const Provenance now = archive.provenances().back();
  EXPECT_NE(now.device, "cpu, an older one");
  EXPECT_THAT(resumed.output, testing::naming("warning: ", "evodevo " EVODEVO_VERSION " (" + begun_by, now.program));
}

TEST_F(Interruption, GoesOnWithTheGivenDeviceAndThreads) {
  {
    Archive::create(scratch_ / "run", testing::read(testing::small_experiment, {{"simulation.device", "cuda", ""}}),
                    "");
  }
  std::vector<std::string> command = resume_command("run");
  command.insert(command.end(), {"--device", "cpu", "--threads", "1"});
  const testing::Finished resumed = testing::run(command);
  EXPECT_EQ(resumed.exit_code, 0) << resumed.output;
  EXPECT_THAT(resumed.output, testing::naming(" on cpu, ", ", 1 thread;"));
}

TEST_F(Interruption, GoingOnTheSameWayWarnsOfNothing) {
  ASSERT_EQ(testing::run(run_command("run")).exit_code, 0);
  const testing::Finished resumed = testing::run(resume_command("run"));
  EXPECT_EQ(resumed.exit_code, 0);
  EXPECT_THAT(resumed.output, Not(HasSubstr("warning")));
  EXPECT_EQ(Archive::read(scratch_ / "run").provenances().size(), 1u);
}

TEST_F(Interruption, ThreadsDoNotChangeARun) {
  ASSERT_EQ(testing::run(run_command("two")).exit_code, 0);
  std::vector<std::string> one_thread = run_command("one");
  one_thread.insert(one_thread.end(), {"--threads", "1"});
  ASSERT_EQ(testing::run(one_thread).exit_code, 0);
  testing::expect_same_runs(Archive::read(scratch_ / "two"), Archive::read(scratch_ / "one"));
}

TEST_F(Interruption, TwoRunsAtOnceTakeFoldersOfTheirOwn) {
  // without --out, each run makes a folder of its own in runs/
  const std::string command = "cd '" + (scratch_ / "").string() + "' && exec '" + EVODEVO_PROGRAM + "' run small.toml";
  Process one({"sh", "-c", command}), two({"sh", "-c", command});
  EXPECT_EQ(one.wait(), 0) << one.output();
  EXPECT_EQ(two.wait(), 0) << two.output();
  for (const char* name : {"runs/small-1", "runs/small-2"})
    EXPECT_EQ(Archive::read(scratch_ / name).generations().size(), 4u) << name;
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
