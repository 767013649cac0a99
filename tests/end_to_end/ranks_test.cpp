// Runs of several processes, started by an MPI launcher.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

#include "archive/archive.hpp"
#include "operators/loader.hpp"
#include "support/experiments.hpp"
#include "support/islands.hpp"
#include "support/messages.hpp"
#include "support/program.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using namespace testing;

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
  static Words started(int count, const Words& command) {
    return joined({EVODEVO_MPIRUN, "--oversubscribe", "--bind-to", "none", "-n", std::to_string(count)}, command);
  }
  /// Returns the command that starts one process of each of two commands.
  static Words started(const Words& first, const Words& second) {
    return joined(joined(started(1, first), {":", "-n", "1"}), second);
  }
  Words run_command(const std::string& folder, const Words& settings = {}) const {
    const Words words{"run", file_, "--device", "cpu", "--out", (scratch_ / folder).string()};
    return joined(program(words), setting(settings));
  }
  Words resume_command(const std::string& folder) const { return program({"resume", (scratch_ / folder).string()}); }
  void expect_equal(const std::string& a, const std::string& b) const {
    expect_same_islands(scratch_ / a, scratch_ / b);
  }
  template <class... Parts>
  static void expect_refused(const Words& command, const Parts&... named) {
    const Finished finished = testing::run(command);
    EXPECT_NE(finished.exit_code, 0);
    EXPECT_THAT(finished.output, naming(named...));
  }
  void expect_nothing_written() const { EXPECT_FALSE(fs::exists(scratch_ / "run")); }

  Scratch scratch_;
  std::string file_ = scratch_.write("small.toml", small_experiment);
};

TEST_F(Ranks, MakeTheSameRunAsOneProcessAndSayWhatEachOfThemHasDone) {
  output_of(run_command("alone"));
  std::string output;
  for (const int count : {1, 2, 4}) {
    const std::string folder = std::to_string(count);
    output = output_of(started(count, run_command(folder)));
    expect_equal("alone", folder);
  }
  EXPECT_THAT(output, naming("rank 0 on ", "rank 1 on ", "rank 2 on "));
  const Words lives{"experiment.lives=3", "experiment.birth_noise=0.01", "selection.remeasure=2",
                    "experiment.verify_front=lives"};
  output_of(run_command("three lives", lives));
  output_of(started(2, run_command("three lives of two ranks", lives)));
  expect_equal("three lives", "three lives of two ranks");
}

TEST_F(Ranks, MakeTheSameRunWithEachOperatorOfAnExperiment) {
  std::set<fs::path> experiments;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(EVODEVO_EXPERIMENTS))
    if (entry.path().extension() == ".toml") experiments.insert(entry.path());
  int count = 0;
  std::set<std::string> tried;  // lines that name an operator
  for (const fs::path& experiment : experiments) {
    std::istringstream lines(read_experiment({experiment, {}}).resolved);
    bool is_new = false;
    for (std::string line; std::getline(lines, line);)
      if (line.starts_with("name = ")) is_new = tried.insert(line).second || is_new;
    if (!is_new) continue;
    SCOPED_TRACE(experiment);
    file_ = experiment;
    const Words settings = testing::shrinking(file_);
    const std::string alone = std::to_string(count++), ranks = alone + " ranks";
    output_of(run_command(alone, settings));
    output_of(started(3, run_command(ranks, settings)));
    expect_equal(alone, ranks);
  }
  EXPECT_GT(count, 5);
}

TEST_F(Ranks, OfIslandsMakeTheSameRunAsOneProcess) {
  file_ = scratch_.write("islands.toml", small_islands);
  output_of(run_command("alone"));
  for (const int count : {1, 2, 3, 5, 7}) {
    const std::string folder = std::to_string(count);
    output_of(started(count, run_command(folder)));
    expect_equal("alone", folder);
  }
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

/// Kills a rank of a run when it has printed a text.
void kill_rank_after(const std::string& text, Process& launcher, int rank) {
  while (const std::optional<std::string> line = launcher.read_line())
    if (line->find(text) != std::string::npos) break;
  int killed = 0;
  for (const pid_t child : children(launcher.id()))
    if (variable(child, "OMPI_COMM_WORLD_RANK") == std::to_string(rank)) killed += kill(child, SIGKILL) == 0;
  EXPECT_EQ(killed, 1);
}

TEST_F(Ranks, GoOnAfterASignalOrWithoutAKilledOneAndAnyNumberOfThemResumes) {
  // of 40 generations, which take some seconds
  const Words longer{"experiment.evaluations=240", "fitness.0.window=0.5", "fitness.1.window=0.5"};
  const auto expect_interrupted = [&](const std::string& folder) {
    EXPECT_LT(Archive::read(scratch_ / folder).generations().size(), 40u) << "it was done before it could be ended";
  };
  output_of(run_command("straight", longer));

  const Words run = joined(run_command("stopped", longer), {"--resume"});
  Process stopped(started(3, run));
  while (const std::optional<std::string> line = stopped.read_line())
    if (line->starts_with("generation 1 ")) break;
  stopped.send(SIGUSR1);  // which mpirun forwards to all ranks
  EXPECT_EQ(stopped.wait(), 130) << stopped.output();
  EXPECT_THAT(stopped.output(), ::testing::HasSubstr("rank 2 on ")) << "rank 0 did not end in order";
  expect_interrupted("stopped");
  output_of(started(2, run));
  expect_equal("straight", "stopped");

  for (const int rank : {0, 2}) {
    const std::string folder = "without " + std::to_string(rank);
    Process process(started(3, run_command(folder, longer)));
    kill_rank_after("generation 1 ", process, rank);
    EXPECT_NE(process.wait(), 0);
    expect_interrupted(folder);
    output_of(started(2, resume_command(folder)));
    expect_equal("straight", folder);
  }

  Words command = started(3, run_command("recovered", longer));
  command.insert(command.begin() + 1, "--enable-recovery");
  Process process(command);
  kill_rank_after("generation 1 ", process, 2);
  EXPECT_EQ(process.wait(), 0);
  EXPECT_THAT(process.output(), naming("warning: rank 2 on ", "lost on the way"));
  expect_equal("straight", "recovered");
}

/// Ranks 0 and 1 belong to island 1, rank 2 is the first one of island 2.
TEST_F(Ranks, OfIslandsEndWithAKilledOneAndAnyNumberOfThemResumes) {
  file_ = scratch_.write("islands.toml", small_islands);
  const Words slow{"fitness.0.window=2", "fitness.1.window=2"};
  output_of(run_command("straight", slow));
  for (const int rank : {0, 2}) {
    const std::string folder = "without " + std::to_string(rank);
    Process process(started(5, run_command(folder, slow)));
    kill_rank_after("evaluations 4", process, rank);  // when islands have completed about three generations
    EXPECT_NE(process.wait(), 0);
    std::int64_t done = 0;
    for (const fs::path& island : island_folders(scratch_ / folder))
      if (const auto generations = Archive::read(island).generations(); !generations.empty())
        done += generations.back().evaluations;
    EXPECT_LT(done, 104) << "it was done before it could be killed";
    output_of(started(2, resume_command(folder)));
    expect_equal("straight", folder);
  }
}

/// Two ranks with a folder of operators, in which rank 1 sees other files than rank 0, as on another host.
class TwoHosts : public Ranks {
 protected:
  void SetUp() override {
    Ranks::SetUp();
    for (const fs::path& folder : {folder_, other_}) fs::create_directory(folder);
    if (testing::run({"unshare", "-m", "mount", "--bind", other_.string(), folder_.string()}).exit_code != 0)
      GTEST_SKIP() << "mounting needs root";
  }
  Words run(const Words& more = {}) const {
    const Words here = joined(alone("run"), more);
    const std::string mount = "mount --bind '" + other_.string() + "' '" + folder_.string() + "' && exec \"$@\"";
    return started(here, joined({"unshare", "-m", "sh", "-c", mount, "sh"}, here));
  }
  Words alone(const std::string& folder) const {
    return joined(run_command(folder), {"--plugin-path", folder_.string()});
  }

  const fs::path folder_ = scratch_ / "operators", other_ = scratch_ / "other";
};

TEST_F(TwoHosts, OfWhichOneHasNotAllOperatorsAreRefused) {
  std::string text = small_experiment;
  const auto begin = text.find("name = \"distance\""), end = text.find("[[fitness]]", begin);
  text.replace(begin, end - begin, "name = \"early-way\"\n\n");
  file_ = scratch_.write("early.toml", text);
  fs::copy(fs::path(EVODEVO_FAULTY_PLUGINS) / "special", folder_);
  output_of(alone("alone"));
  expect_refused(run(), "rank 1 on ", "\"early-way\"");
  expect_nothing_written();
}

TEST_F(TwoHosts, OfWhichOneHasAnotherBuildOfAnOperatorAreRefused) {
  const fs::path library = "distance.evodevo.so";
  for (const fs::path& folder : {folder_, other_})
    fs::copy_file(fs::path(EVODEVO_PROGRAM).parent_path().parent_path() / "lib/evodevo" / library, folder / library);
  output_of(run());
  fs::remove_all(scratch_ / "run");
  std::ofstream(other_ / library, std::ios::app) << "more";
  expect_refused(run(), "rank 1 on ", "fitness operator \"distance\"", "the same libraries");
  expect_nothing_written();
  output_of(run({"--mixed"}));
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
    const Words here = joined(run_command("run"), more);
    Words there = here;
    there.front() = other.string();
    return started(here, there);
  };
  expect_refused(run({}), "rank 1 on ", file_hash(other), "the same program", "--mixed");
  expect_nothing_written();
  output_of(run({"--mixed"}));
  output_of(run_command("alone"));
  expect_equal("alone", "run");  // both builds compute the same
  const std::vector<Provenance> provenances = Archive::read(scratch_ / "run").provenances();
  ASSERT_EQ(provenances.size(), 2u);
  EXPECT_EQ(provenances[0].program, file_hash(program));
  EXPECT_EQ(provenances[1].program, file_hash(other));
}

TEST_F(Ranks, WithThreadsOfTheirOwnThatThereAreNotAreRefused) {
  const Words run = run_command("run");
  expect_refused(started(run, joined(run, {"--threads", "-3"})), "rank 1 on ", "--threads -3");
}

TEST_F(Ranks, ThatDoNotKnowOfEachOtherOrHaveNoLibraryForMpiAreRefused) {
  setenv("SLURM_STEP_NUM_TASKS", "4", 1);
  EXPECT_THAT(output_of(run_command("run"), 1), naming("4 processes", "srun --mpi=pmix"));
  expect_nothing_written();
  unsetenv("SLURM_STEP_NUM_TASKS");

  fs::create_directories(scratch_ / "bin");
  fs::copy_file(EVODEVO_PROGRAM, scratch_ / "bin" / "evodevo");
  Words command = run_command("run");
  command.front() = (scratch_ / "bin" / "evodevo").string();
  expect_refused(started(2, command), "2 processes", "libevodevo-mpi.so", "libopenmpi-dev");
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
