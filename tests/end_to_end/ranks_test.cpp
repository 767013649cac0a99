// Runs of several processes, started by an MPI launcher.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>

#include "evolution/archive/archive.hpp"
#include "operators/loader.hpp"
#include "support/experiments.hpp"
#include "support/islands.hpp"
#include "support/messages.hpp"
#include "support/process.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using testing::Finished;
using testing::Process;
using Words = std::vector<std::string>;

class Ranks : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::string(EVODEVO_MPIRUN).empty())
      GTEST_SKIP() << "MPI was not installed when evodevo was built (on Debian: libopenmpi-dev openmpi-bin)";
    // Open MPI refuses to work for root, or to start more processes than cores, unless it is told
    setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
    setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
  }

  /// Returns the command that starts `count` processes of another command.
  static Words started(int count, Words command) {
    const Words launcher{EVODEVO_MPIRUN, "--oversubscribe", "--bind-to", "none", "-n", std::to_string(count)};
    command.insert(command.begin(), launcher.begin(), launcher.end());
    return command;
  }
  Words run_command(const std::string& folder, const Words& settings = {}) const {
    Words command{EVODEVO_PROGRAM, "run", file_, "--device", "cpu", "--out", (scratch_ / folder).string()};
    for (const std::string& setting : settings) command.insert(command.end(), {"--set", setting});
    return command;
  }
  Words resume_command(const std::string& folder) const {
    return {EVODEVO_PROGRAM, "resume", (scratch_ / folder).string()};
  }
  void expect_equal(const std::string& a, const std::string& b) const {
    testing::expect_same_islands(scratch_ / a, scratch_ / b);
  }
  static void expect_success(const Words& command) {
    const Finished finished = testing::run(command);
    ASSERT_EQ(finished.exit_code, 0) << finished.output;
  }

  testing::Scratch scratch_;
  std::string file_ = scratch_.write("small.toml", testing::small_experiment);
};

TEST_F(Ranks, MakeTheSameRunAsOneProcess) {
  expect_success(run_command("alone"));
  for (const int count : {1, 2, 4}) {
    const std::string folder = std::to_string(count);
    expect_success(started(count, run_command(folder)));
    expect_equal("alone", folder);
  }
}

TEST_F(Ranks, OfWhichMostHaveNothingToDoMakeTheSameRun) {
  const Words tiny{"experiment.population=3", "experiment.evaluations=9"};
  expect_success(run_command("alone", tiny));
  expect_success(started(16, run_command("ranks", tiny)));
  expect_equal("alone", "ranks");
}

/// Returns the operators of an experiment.
std::set<std::string> operators_of(const Experiment& experiment) {
  std::istringstream lines(experiment.resolved);
  std::set<std::string> names;
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("name = ")) names.insert(line);
  return names;
}

TEST_F(Ranks, MakeTheSameRunWithEachOperatorOfAnExperiment) {
  std::map<std::string, std::set<std::string>> experiments;  // of each file
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(EVODEVO_EXPERIMENTS))
    if (const fs::path& file = entry.path(); file.extension() == ".toml")
      experiments[file] = operators_of(read_experiment({file, {}}));
  int count = 0;
  std::set<std::string> tried;
  const auto is_tried = [&](const std::string& name) { return tried.contains(name); };
  for (const auto& [file, operators] : experiments) {
    if (std::ranges::all_of(operators, is_tried)) continue;
    SCOPED_TRACE(file);
    tried.insert(operators.begin(), operators.end());
    file_ = file;
    const Words settings = testing::shrinking(file_);
    const std::string alone = std::to_string(count++), ranks = alone + " ranks";
    expect_success(run_command(alone, settings));
    expect_success(started(3, run_command(ranks, settings)));
    expect_equal(alone, ranks);
  }
  EXPECT_GT(count, 5);
}

TEST_F(Ranks, OfIslandsMakeTheSameRunAsOneProcess) {
  file_ = scratch_.write("islands.toml", testing::small_islands);
  expect_success(run_command("alone"));
  for (const int count : {1, 2, 3, 5, 7}) {
    const std::string folder = std::to_string(count);
    expect_success(started(count, run_command(folder)));
    expect_equal("alone", folder);
  }
}

TEST_F(Ranks, SayWhatEachOfThemHasDone) {
  const Finished finished = testing::run(started(3, run_command("ranks")));
  for (const char* rank : {"rank 0 on ", "rank 1 on ", "rank 2 on "})
    EXPECT_THAT(finished.output, ::testing::HasSubstr(rank));
}

/// Returns the processes that a process has started, in the order in which they were started.
std::vector<pid_t> children(pid_t parent) {
  const std::string id = std::to_string(parent);
  std::ifstream stream("/proc/" + id + "/task/" + id + "/children");
  return {std::istream_iterator<pid_t>(stream), {}};
}

/// Returns the value of a variable in the environment of a process.
std::string variable(pid_t process, const std::string& name) {
  std::ifstream stream("/proc/" + std::to_string(process) + "/environ");
  for (std::string entry; std::getline(stream, entry, '\0');)
    if (entry.starts_with(name + "=")) return entry.substr(name.size() + 1);
  return {};
}

/// Kills a rank of a run after its second generation.
void kill_rank(Process& launcher, int rank) {
  while (const std::optional<std::string> line = launcher.read_line())
    if (line->starts_with("generation 1 ")) break;
  int killed = 0;
  for (const pid_t child : children(launcher.id()))
    if (variable(child, "OMPI_COMM_WORLD_RANK") == std::to_string(rank)) killed += kill(child, SIGKILL) == 0;
  EXPECT_EQ(killed, 1);
}

/// Of 40 generations, which take some seconds.
const Words longer{"experiment.evaluations=240", "fitness.0.window=0.5", "fitness.1.window=0.5"};

TEST_F(Ranks, SurviveASignalToAllOfThemAndEndWithRank0) {
  expect_success(run_command("straight", longer));
  Words run = run_command("stopped", longer);
  run.emplace_back("--resume");
  Process process(started(3, run));
  while (const std::optional<std::string> line = process.read_line())
    if (line->starts_with("generation 1 ")) break;
  process.send(SIGUSR1);  // which mpirun forwards to all ranks
  EXPECT_EQ(process.wait(), 130) << process.output();
  EXPECT_THAT(process.output(), ::testing::HasSubstr("rank 2 on ")) << "rank 0 did not end in order";
  EXPECT_LT(Archive::read(scratch_ / "stopped").generations().size(), 40u) << "it was done before it could be stopped";
  expect_success(started(2, run));
  expect_equal("straight", "stopped");
}

class KilledRank : public Ranks, public ::testing::WithParamInterface<int> {};

TEST_P(KilledRank, EndsARunThatAnyNumberOfRanksResume) {
  expect_success(run_command("straight", longer));
  Process process(started(3, run_command("killed", longer)));
  kill_rank(process, GetParam());
  EXPECT_NE(process.wait(), 0);
  EXPECT_LT(Archive::read(scratch_ / "killed").generations().size(), 40u) << "it was done before it could be killed";
  expect_success(started(2, resume_command("killed")));
  expect_equal("straight", "killed");
}

TEST_F(Ranks, GoOnWithoutAKilledOneIfTheLauncherLetsThem) {
  expect_success(run_command("straight", longer));
  Words command = started(3, run_command("killed", longer));
  command.insert(command.begin() + 1, "--enable-recovery");
  Process process(command);
  kill_rank(process, 2);
  EXPECT_EQ(process.wait(), 0);
  EXPECT_THAT(process.output(), testing::naming("warning: rank 2 on ", "lost on the way"));
  expect_equal("straight", "killed");
}

/// Kills a rank of a run with islands when islands have completed about three generations.
void kill_rank_of_islands(Process& launcher, int rank) {
  while (const std::optional<std::string> line = launcher.read_line())
    if (line->find("evaluations 4") != std::string::npos) break;
  int killed = 0;
  for (const pid_t child : children(launcher.id()))
    if (variable(child, "OMPI_COMM_WORLD_RANK") == std::to_string(rank)) killed += kill(child, SIGKILL) == 0;
  EXPECT_EQ(killed, 1);
}

/// Ranks 0 and 1 belong to island 1, rank 2 is the first one of island 2.
TEST_P(KilledRank, EndsARunWithIslandsThatAnyNumberOfRanksResume) {
  file_ = scratch_.write("islands.toml", testing::small_islands);
  const Words slow{"fitness.0.window=2", "fitness.1.window=2"};
  expect_success(run_command("straight", slow));
  Process process(started(5, run_command("killed", slow)));
  kill_rank_of_islands(process, GetParam());
  EXPECT_NE(process.wait(), 0);
  std::int64_t done = 0;
  for (const fs::path& folder : island_folders(scratch_ / "killed"))
    if (const auto generations = Archive::read(folder).generations(); !generations.empty())
      done += generations.back().evaluations;
  EXPECT_LT(done, 104) << "it was done before it could be killed";
  expect_success(started(2, resume_command("killed")));
  expect_equal("straight", "killed");
}

INSTANTIATE_TEST_SUITE_P(Rank, KilledRank, ::testing::Values(0, 2));

/// Two ranks with a folder of operators, in which rank 1 sees other files than rank 0, as on another host.
class TwoHosts : public Ranks {
 protected:
  void SetUp() override {
    Ranks::SetUp();
    for (const fs::path& folder : {folder_, other_}) fs::create_directory(folder);
    if (testing::run({"unshare", "-m", "mount", "--bind", other_.string(), folder_.string()}).exit_code != 0)
      GTEST_SKIP() << "mounting needs root";
  }
  Finished run(const Words& more = {}) const {
    Words here = with_operators(run_command("run"));
    here.insert(here.end(), more.begin(), more.end());
    Words command{EVODEVO_MPIRUN, "--oversubscribe", "--bind-to", "none", "-n", "1"};
    command.insert(command.end(), here.begin(), here.end());
    const std::string mount = "mount --bind '" + other_.string() + "' '" + folder_.string() + "' && exec \"$@\"";
    const Words there{":", "-n", "1", "unshare", "-m", "sh", "-c", mount, "sh"};
    command.insert(command.end(), there.begin(), there.end());
    command.insert(command.end(), here.begin(), here.end());
    return testing::run(command);
  }
  Words with_operators(Words command) const {
    command.insert(command.end(), {"--plugin-path", folder_.string()});
    return command;
  }

  const fs::path folder_ = scratch_ / "operators", other_ = scratch_ / "other";
};

TEST_F(TwoHosts, OfWhichOneHasNotAllOperatorsAreRefused) {
  std::string text = testing::small_experiment;
  const auto begin = text.find("name = \"distance\""), end = text.find("[[fitness]]", begin);
  text.replace(begin, end - begin, "name = \"early-way\"\n\n");
  file_ = scratch_.write("early.toml", text);
  fs::copy(fs::path(EVODEVO_FAULTY_PLUGINS) / "special", folder_);
  const Finished alone = testing::run(with_operators(run_command("alone")));
  EXPECT_EQ(alone.exit_code, 0) << alone.output;
  const Finished finished = run();
  EXPECT_NE(finished.exit_code, 0);
  EXPECT_THAT(finished.output, testing::naming("rank 1 on ", "\"early-way\""));
  EXPECT_FALSE(fs::exists(scratch_ / "run"));
}

TEST_F(TwoHosts, OfWhichOneHasAnotherBuildOfAnOperatorAreRefused) {
  const fs::path library = "distance.evodevo.so";
  for (const fs::path& folder : {folder_, other_})
    fs::copy_file(fs::path(EVODEVO_PROGRAM).parent_path().parent_path() / "lib/evodevo" / library, folder / library);
  const Finished equal = run();
  EXPECT_EQ(equal.exit_code, 0) << equal.output;
  fs::remove_all(scratch_ / "run");
  std::ofstream(other_ / library, std::ios::app) << "more";
  const Finished finished = run();
  EXPECT_NE(finished.exit_code, 0);
  EXPECT_THAT(finished.output, testing::naming("rank 1 on ", "fitness operator \"distance\"", "the same libraries"));
  EXPECT_FALSE(fs::exists(scratch_ / "run"));
  const Finished mixed = run({"--mixed"});
  EXPECT_EQ(mixed.exit_code, 0) << mixed.output;
  const Archive archive = Archive::read(scratch_ / "run");
  ASSERT_EQ(archive.provenances().size(), 2u);
  EXPECT_FALSE(are_same_builds(archive.provenances()[0], archive.provenances()[1]));
  for (const std::int64_t evaluations : archive.evaluated_by_provenance()) EXPECT_GT(evaluations, 0);
}

TEST_F(Ranks, OfWhichOneIsAnotherBuildAreRefusedUnlessTheyAreMixed) {
  const fs::path program(EVODEVO_PROGRAM), other = scratch_ / "bin" / "evodevo";
  fs::create_directories(other.parent_path());
  fs::copy_file(program, other);
  fs::create_directory_symlink(program.parent_path().parent_path() / "lib", scratch_ / "lib");
  std::ofstream(other, std::ios::app) << "more";
  const auto run = [&](const Words& more) {
    Words here = run_command("run"), command = started(1, {});
    here.insert(here.end(), more.begin(), more.end());
    command.insert(command.end(), here.begin(), here.end());
    here.front() = other.string();
    command.insert(command.end(), {":", "-n", "1"});
    command.insert(command.end(), here.begin(), here.end());
    return testing::run(command);
  };
  EXPECT_THAT(run({}).output, testing::naming("rank 1 on ", file_hash(other), "the same program", "--mixed"));
  EXPECT_FALSE(fs::exists(scratch_ / "run"));
  const Finished mixed = run({"--mixed"});
  EXPECT_EQ(mixed.exit_code, 0) << mixed.output;
  expect_success(run_command("alone"));
  expect_equal("alone", "run");  // both builds compute the same
  const std::vector<Provenance> provenances = Archive::read(scratch_ / "run").provenances();
  ASSERT_EQ(provenances.size(), 2u);
  EXPECT_EQ(provenances[0].program, file_hash(program));
  EXPECT_EQ(provenances[1].program, file_hash(other));
}

TEST_F(Ranks, HaveThreadsOfTheirOwn) {
  Words command = started(1, run_command("run"));
  command.insert(command.end(), {":", "-n", "1"});
  const Words other = run_command("run");
  command.insert(command.end(), other.begin(), other.end());
  command.insert(command.end(), {"--threads", "-3"});
  const Finished finished = testing::run(command);
  EXPECT_NE(finished.exit_code, 0);
  EXPECT_THAT(finished.output, testing::naming("rank 1 on ", "--threads -3"));
}

TEST_F(Ranks, ThatDoNotKnowOfEachOtherAreRefused) {
  setenv("SLURM_STEP_NUM_TASKS", "4", 1);
  const Finished finished = testing::run(run_command("run"));
  unsetenv("SLURM_STEP_NUM_TASKS");
  EXPECT_EQ(finished.exit_code, 1);
  EXPECT_THAT(finished.output, testing::naming("4 processes", "srun --mpi=pmix"));
  EXPECT_FALSE(fs::exists(scratch_ / "run"));
}

TEST_F(Ranks, WithoutTheLibraryForMpiAreRefused) {
  const fs::path program(EVODEVO_PROGRAM);
  fs::create_directories(scratch_ / "bin");
  fs::copy_file(program, scratch_ / "bin" / "evodevo");
  Words command = run_command("run");
  command.front() = (scratch_ / "bin" / "evodevo").string();
  const Finished finished = testing::run(started(2, command));
  EXPECT_NE(finished.exit_code, 0);
  EXPECT_THAT(finished.output, testing::naming("2 processes", "libevodevo-mpi.so", "libopenmpi-dev"));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
