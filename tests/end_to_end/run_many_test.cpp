// Many runs in one process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "evolution/archive/archive.hpp"
#include "support/experiments.hpp"
#include "support/islands.hpp"
#include "support/messages.hpp"
#include "support/process.hpp"
#include "support/runs.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::Finished;
using testing::Process;

class RunMany : public ::testing::Test {
 protected:
  using Words = std::vector<std::string>;

  /// The arguments of a run in a folder.
  Words arguments(const std::string& folder, const Words& more = {}) const {
    Words words{file_, "--no-report", "--out", (scratch_ / folder).string()};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  /// Writes the file of some runs, and returns the command that makes them.
  Words command(const std::vector<Words>& runs, int jobs) const {
    std::string lines;
    for (const Words& words : runs) lines += Json(words).dump() + '\n';
    return {EVODEVO_PROGRAM, "run-many", scratch_.write("runs.jsonl", lines), "--jobs", std::to_string(jobs)};
  }
  /// The exit codes that were printed, by the number of the run.
  static std::map<int, int> codes(const std::string& output) {
    std::map<int, int> codes;
    std::istringstream lines(output);
    for (std::string line; std::getline(lines, line);)
      if (const Json json = Json::parse(line, nullptr, false); json.is_object()) codes[json["run"]] = json["exit_code"];
    return codes;
  }
  std::string log_of(const std::string& folder) const {
    std::ifstream stream(scratch_ / (folder + ".log"));
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  void expect_same(const std::string& folder, const std::string& other) const {
    testing::expect_same_runs(Archive::read(scratch_ / folder), Archive::read(scratch_ / other));
  }

  testing::Scratch scratch_;
  std::string file_ = scratch_.write("small.toml", testing::small_experiment);
};

TEST_F(RunMany, RunsAreTheSameAsAlone) {
  const Words verifying{"--set", "experiment.verify_front=true", "--set", "selection.name=comma"};
  std::vector<Words> runs;
  for (const char* seed : {"1", "2", "3"})
    for (const bool verified : {false, true}) {
      Words words = arguments((verified ? "verified-" : "plain-") + std::string(seed), {"--seed", seed});
      if (verified) words.insert(words.end(), verifying.begin(), verifying.end());
      runs.push_back(words);
    }
  const Finished together = testing::run(command(runs, 4));
  ASSERT_EQ(together.exit_code, 0) << together.output;
  EXPECT_EQ(codes(together.output), (std::map<int, int>{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}}));
  Words alone{EVODEVO_PROGRAM, "run"};
  for (const std::string kind : {"plain", "verified"}) {
    Words words = arguments(kind + "-alone", {"--seed", "3"});
    if (kind == "verified") words.insert(words.end(), verifying.begin(), verifying.end());
    words.insert(words.begin(), alone.begin(), alone.end());
    ASSERT_EQ(testing::run(words).exit_code, 0);
    expect_same(kind + "-alone", kind + "-3");
  }
  EXPECT_THAT(log_of("plain-2"), testing::naming("evaluations 24/24", "best: individual"));
}

TEST_F(RunMany, ARunHasTheThreadsThatItsArgumentsAskFor) {
  const Finished finished =
      testing::run(command({arguments("set", {"--device", "cpu", "--set", "simulation.threads=3"}),
                            arguments("given", {"--device", "cpu", "--threads", "3"})},
                           2));
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  for (const char* name : {"set", "given"}) EXPECT_THAT(log_of(name), testing::naming("3 threads")) << name;
}

TEST_F(RunMany, ARunThatFailsDoesNotEndOthers) {
  const Finished finished = testing::run(command(
      {arguments("wrong", {"--set", "experiment.population=none"}), arguments("right"), arguments("wrong/of/")}, 1));
  EXPECT_EQ(finished.exit_code, 1) << finished.output;
  EXPECT_EQ(codes(finished.output), (std::map<int, int>{{0, 2}, {1, 0}, {2, 0}}));
  EXPECT_THAT(log_of("wrong"), testing::naming("experiment.population", "\"none\"", "expected"));
  EXPECT_THAT(log_of("wrong/of"), testing::naming("best: individual"));
  EXPECT_EQ(Archive::read(scratch_ / "right").generations().back().evaluations, 24);
}

TEST_F(RunMany, AnIslandThatFailsDoesNotEndOtherRuns) {
  std::string islands = testing::small_islands;
  const std::string sound = "name = \"reset-weight\"\nprobability = 0.35";
  islands.replace(islands.find(sound), sound.size(), "name = \"nothing\"\nprobability = 1.0");
  Words failing = arguments("failing", {"--plugin-path", (fs::path(EVODEVO_FAULTY_PLUGINS) / "throws").string()});
  failing.front() = scratch_.write("islands.toml", islands);
  const Finished finished = testing::run(command({failing, arguments("right")}, 1));
  EXPECT_EQ(codes(finished.output), (std::map<int, int>{{0, 1}, {1, 0}})) << finished.output;
  EXPECT_EQ(finished.exit_code, 1);
  EXPECT_THAT(log_of("failing"), testing::naming("nothing to mutate", "island"));
}

TEST_F(RunMany, WrongLinesAreRefusedBeforeAnyRunBegins) {
  const auto expect_refused = [&](const std::string& line, const auto&... parts) {
    const std::string file = scratch_.write("runs.jsonl", Json(arguments("first")).dump() + "\n\n" + line + '\n');
    const Finished finished = testing::run({EVODEVO_PROGRAM, "run-many", file});
    EXPECT_EQ(finished.exit_code, 2) << finished.output;
    EXPECT_THAT(finished.output, testing::naming(file + ":3: ", parts...));
    EXPECT_FALSE(fs::exists(scratch_ / "first"));
  };
  expect_refused("run small.toml", "JSON array", "--seed");
  expect_refused("[\"small.toml\", 3]", "JSON array");
  expect_refused(Json(Words{file_}).dump(), "--out", "folder");
  expect_refused(Json(Words{file_, "--out", ""}).dump(), "--out", "folder");
  expect_refused(Json(arguments("second", {"--until", "2h"})).dump(), "--until", "leave it out");
  expect_refused(Json(arguments("second", {"--sede", "2"})).dump(), "--sede");
  expect_refused(Json(arguments("second/../first/")).dump(), "--out", "runs.jsonl:1", "folder of its own");
  const Finished empty = testing::run({EVODEVO_PROGRAM, "run-many", scratch_.write("empty.jsonl", "\n")});
  EXPECT_EQ(empty.exit_code, 2);
  EXPECT_THAT(empty.output, testing::naming("empty.jsonl", "no runs"));
  const Finished missing = testing::run({EVODEVO_PROGRAM, "run-many", (scratch_ / "none").string()});
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.output, testing::naming((scratch_ / "none").string(), "cannot be read"));
  const Finished none = testing::run({EVODEVO_PROGRAM, "run-many", file_, "--jobs", "0"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.output, testing::naming("--jobs 0", "at least 1"));
}

TEST_F(RunMany, ASignalEndsAllAfterTheirGenerationsAndTheSameFileGoesOn) {
  const Words longer{"--set", "experiment.evaluations=3000", "--resume"};
  const std::vector<Words> runs{arguments("a", longer), arguments("short", {"--resume"}), arguments("b", longer),
                                arguments("c", longer)};
  {
    Process process(command(runs, 2));
    EXPECT_EQ(process.read_line(), R"({"run":1,"exit_code":0})");
    process.send(SIGUSR1);
    EXPECT_EQ(process.wait(), 130) << process.output();
    EXPECT_EQ(codes(process.output())[0], 130);
  }
  EXPECT_FALSE(fs::exists(scratch_ / "c")) << "it began after the signal";
  const Finished finished = testing::run(command(runs, 2));
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  Words alone = arguments("straight", longer);
  alone.insert(alone.begin(), {EVODEVO_PROGRAM, "run"});
  ASSERT_EQ(testing::run(alone).exit_code, 0);
  for (const char* folder : {"a", "b", "c"}) expect_same("straight", folder);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
