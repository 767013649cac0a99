// Many runs, or a run with many islands, in one process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "archive/archive.hpp"
#include "support/experiments.hpp"
#include "support/islands.hpp"
#include "support/messages.hpp"
#include "support/program.hpp"
#include "support/runs.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using namespace testing;
using Json = nlohmann::json;

class RunMany : public ::testing::Test {
 protected:
  /// The arguments of a run in a folder.
  Words arguments(const std::string& folder, const Words& more = {}) const {
    return joined({file_, "--no-report", "--out", (scratch_ / folder).string()}, more);
  }
  static Words alone(const Words& run) { return joined({EVODEVO_PROGRAM, "run"}, run); }
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
    expect_same_runs(Archive::read(scratch_ / folder), Archive::read(scratch_ / other));
  }

  Scratch scratch_;
  std::string file_ = scratch_.write("small.toml", small_experiment);
};

TEST_F(RunMany, RunsAreTheSameAsAloneWithTheThreadsThatTheyAskFor) {
  const Words verifying{"--set", "experiment.verify_front=trials", "--set", "selection.name=comma"};
  std::vector<Words> runs{arguments("set", {"--device", "cpu", "--set", "simulation.threads=3"}),
                          arguments("given", {"--device", "cpu", "--threads", "3"})};
  for (const std::string seed : {"1", "2", "3"}) {
    runs.push_back(arguments("plain-" + seed, {"--seed", seed}));
    runs.push_back(arguments("verified-" + seed, joined({"--seed", seed}, verifying)));
  }
  EXPECT_EQ(codes(output_of(command(runs, 4))),
            (std::map<int, int>{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}, {6, 0}, {7, 0}}));
  for (const std::string kind : {"plain", "verified"}) {
    const Words same{"--seed", "3"};
    output_of(alone(arguments(kind + "-alone", kind == "verified" ? joined(same, verifying) : same)));
    expect_same(kind + "-alone", kind + "-3");
  }
  EXPECT_THAT(log_of("plain-2"), naming("evaluations 24/24", "best: individual"));
  for (const char* name : {"set", "given"}) EXPECT_THAT(log_of(name), naming("3 threads")) << name;
}

TEST_F(RunMany, ARunOrAnIslandThatFailsDoesNotEndOthers) {
  std::string islands = small_islands;
  const std::string sound = "name = \"reset-weight\"\nprobability = 0.35";
  islands.replace(islands.find(sound), sound.size(), "name = \"nothing\"\nprobability = 1.0");
  Words failing = arguments("failing", {"--plugin-path", (fs::path(EVODEVO_FAULTY_PLUGINS) / "throws").string()});
  failing.front() = scratch_.write("islands.toml", islands);
  const Words wrong = arguments("wrong", {"--set", "experiment.population=none"});
  Words whole = arguments("islands");
  whole.front() = scratch_.write("whole.toml", small_islands);
  const std::string output =
      output_of(command({wrong, failing, arguments("right"), arguments("wrong/of/"), whole}, 1), 1);
  EXPECT_EQ(codes(output), (std::map<int, int>{{0, 2}, {1, 1}, {2, 0}, {3, 0}, {4, 0}}));
  EXPECT_EQ(std::ranges::count(output, '\n'), 5) << output;
  EXPECT_THAT(log_of("islands"), naming("evaluations 104/104", "best: individual"));
  EXPECT_THAT(log_of("wrong"), naming("experiment.population", "\"none\"", "expected"));
  EXPECT_THAT(log_of("failing"), naming("nothing to mutate", "island"));
  EXPECT_THAT(log_of("wrong/of"), naming("best: individual"));
  EXPECT_EQ(Archive::read(scratch_ / "right").generations().back().evaluations, 24);
}

TEST_F(RunMany, WrongLinesAreRefusedBeforeAnyRunBegins) {
  const auto expect_refused = [&](const std::string& line, const auto&... parts) {
    const std::string file = scratch_.write("runs.jsonl", Json(arguments("first")).dump() + "\n\n" + line + '\n');
    EXPECT_THAT(testing::refusal({"run-many", file}), naming(file + ":3: ", parts...));
    EXPECT_FALSE(fs::exists(scratch_ / "first"));
  };
  expect_refused("run small.toml", "JSON array", "--seed");
  expect_refused("[\"small.toml\", 3]", "JSON array");
  expect_refused(Json(Words{file_}).dump(), "--out", "folder");
  expect_refused(Json(Words{file_, "--out", ""}).dump(), "--out", "folder");
  expect_refused(Json(arguments("second", {"--until", "2h"})).dump(), "--until", "leave it out");
  expect_refused(Json(arguments("second", {"--sede", "2"})).dump(), "--sede");
  expect_refused(Json(arguments("second/../first/")).dump(), "--out", "runs.jsonl:1", "folder of its own");
  const std::string empty = scratch_.write("empty.jsonl", "\n"), none = (scratch_ / "none").string();
  EXPECT_THAT(testing::refusal({"run-many", empty}), naming("empty.jsonl", "no runs"));
  EXPECT_THAT(testing::refusal({"run-many", none}), naming(none, "cannot be read"));
  EXPECT_THAT(testing::refusal({"run-many", file_, "--jobs", "0"}), naming("--jobs 0", "at least 1"));
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
  output_of(command(runs, 2));
  output_of(alone(arguments("straight", longer)));
  for (const char* folder : {"a", "b", "c"}) expect_same("straight", folder);
}

class IslandCommands : public ::testing::Test {
 protected:
  Finished begin(const Words& more = {}) const {
    return evodevo(joined({"run", file_, "--out", run_, "--device", "cpu", "--no-report"}, more));
  }

  /// Signal measures the island with the best robot, and no other.
  void expect_signal_of_the_best_island() const {
    const std::string told = said({"signal", run_, "--robots", "12", "--json", "--quiet"});
    const Json signal = Json::parse(told.substr(told.find('{')));  // after notes: populations are small
    std::vector<double> best;
    for (const fs::path& island : island_folders(run_)) {
      const Json shown = Json::parse(said({"show", island, "--json"}));
      best.push_back(shown.at("best").at("objectives").at("distance"));
      EXPECT_EQ(shown.at("signal").is_null(), shown.at("signal") != signal) << island;
    }
    ASSERT_EQ(best.size(), 3);
    const int best_island = Json::parse(said({"show", run_, "--json"})).at("best_island");
    EXPECT_EQ(best.at(static_cast<std::size_t>(best_island - 1)), *std::ranges::max_element(best));
    for (const Json& one : signal.at("numbers"))
      if (one.at("of") == "record") {
        EXPECT_EQ(one.at("value"), *std::ranges::max_element(best));
      }
  }

  Scratch scratch_;
  const std::string file_ = scratch_.write("islands.toml", small_islands);
  const std::string run_ = (scratch_ / "run").string();
  const std::string second_ = (scratch_ / "run" / "island-2").string();
};

TEST_F(IslandCommands, ReadTheRunOrOneOfItsIslandsAndContinueOnlyTheWholeRun) {
  const Finished finished = begin({"--log", (scratch_ / "log").string()});
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output, naming("evaluations 104/104", "3 islands", run_ + "/island-"));
  EXPECT_THAT(evodevo({"show", run_}).output,
              naming("\n     1           7           35", "\n     3           7           34"));
  EXPECT_THAT(evodevo({"show", run_, "--json"}).output, naming("\"islands\"", "\"topology\": \"ring\""));
  EXPECT_THAT(evodevo({"show", second_}).output, naming("island 2 of 3", "35 evaluations"));
  EXPECT_THAT(refusal({"life", run_}), naming(run_, run_ + "/island-1"));
  said({"life", second_});
  refusal({"show", run_, "--individual", "7"});
  std::ifstream log(scratch_ / "log");
  int lines = 0;
  for (std::string line; std::getline(log, line); ++lines) EXPECT_THAT(line, naming("\"island\":"));
  EXPECT_EQ(lines, 21);

  EXPECT_THAT(refusal({"resume", second_}), naming(second_));
  said({"resume", run_});
  EXPECT_EQ(begin({"--resume"}).exit_code, 0);
  EXPECT_EQ(begin({"--resume", "--set", "islands.count=4"}).exit_code, 2);
  EXPECT_EQ(begin().exit_code, 2) << "the folder is not empty";
  const fs::path straight = scratch_ / "straight";
  fs::copy(run_, straight, fs::copy_options::recursive);
  expect_signal_of_the_best_island();
  fs::remove_all(second_);
  EXPECT_THAT(refusal({"resume", run_}), naming(second_, "3 islands"));
  EXPECT_EQ(begin({"--resume"}).exit_code, 2) << "the other islands have generations";

  // what ended while it was created is begun again
  fs::remove_all(run_);
  { Archive::create(fs::path(run_) / "island-1", testing::read_islands(scratch_, small_islands)[0], "cpu"); }
  fs::create_directory(second_);
  std::ofstream(second_ + "/run.sqlite") << "";
  const Finished again = begin({"--resume"});
  EXPECT_EQ(again.exit_code, 0) << again.output;
  expect_same_islands(straight, run_);
}

TEST_F(IslandCommands, WriteNoLogIntoAnIsland) {
  ASSERT_EQ(begin({"--until", "1s", "--set", "experiment.evaluations=100000"}).exit_code, 130);
  EXPECT_THAT(refusal({"resume", run_, "--log", second_ + "/run.sqlite"}), naming("--log", second_ + "/run.sqlite"));
  said({"show", second_});
}

TEST_F(IslandCommands, CheckShowsWhoSendsToWhom) {
  EXPECT_THAT(said({"check", file_, "--set", "islands.topology=star"}),
              naming("island 1: ", "sends to 2, 3\n", "seed 41", "elitist; sends to 1\n"));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
