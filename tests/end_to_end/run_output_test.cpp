// What a run shows: its progress on a terminal, its log, and its page.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>

#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/process.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using testing::Finished;
using ::testing::HasSubstr;
using ::testing::Not;

class RunOutput : public ::testing::Test {
 protected:
  Finished run(std::vector<std::string> more) const {
    more.insert(more.begin(), {EVODEVO_PROGRAM, "run", file_, "--out", folder_.string()});
    return testing::run(more);
  }
  /// Runs on a terminal of so many columns.
  std::string run_on_terminal(const std::string& variables, int columns) const {
    const std::string command = "stty cols " + std::to_string(columns) + "; " + variables + " " + EVODEVO_PROGRAM +
                                " run " + file_ + " --no-report --out " + folder_.string();
    const Finished finished = testing::run({"script", "-qec", command, "/dev/null"});
    EXPECT_EQ(finished.exit_code, 0) << finished.output;
    return finished.output;
  }
  /// The lines that were kept up to date, without escape sequences.
  static std::vector<std::string> live_lines(const std::string& output) {
    const std::string begin = "\r\x1b[K";
    std::vector<std::string> lines;
    for (std::size_t at = output.find(begin); at != std::string::npos; at = output.find(begin, at + 1)) {
      const std::size_t first = at + begin.size();
      lines.push_back(std::regex_replace(output.substr(first, output.find_first_of("\r\n", first) - first),
                                         std::regex("\x1b\\[[0-9;]*m"), ""));
    }
    return lines;
  }

  testing::Scratch scratch_;
  std::string file_ = scratch_.write("small.toml", testing::small_experiment);
  fs::path folder_ = scratch_ / "run";
};

TEST_F(RunOutput, FitsTheTerminal) {
  for (const int columns : {30, 36, 57, 250}) {
    const std::vector<std::string> lines = live_lines(run_on_terminal("TERM=xterm", columns));
    ASSERT_FALSE(lines.empty());
    for (const std::string& line : lines) EXPECT_LT(line.size(), static_cast<std::size_t>(columns)) << line;
    EXPECT_THAT(lines.back(), HasSubstr("evaluations 24/24")) << "the last line is always shown";
    EXPECT_TRUE(columns < 36 || lines.back().find("best") != std::string::npos) << lines.back();
    EXPECT_EQ(lines.back().find("generation") != std::string::npos, columns > 36) << lines.back();
    EXPECT_EQ(lines.back().find("diverged") != std::string::npos, columns == 250) << lines.back();
    fs::remove_all(folder_);
  }
}

TEST_F(RunOutput, HasColoursUnlessTheUserWantsNone) {
  EXPECT_THAT(run_on_terminal("TERM=xterm NO_COLOR=", 80), HasSubstr("\x1b[1m"));
  for (const std::string none : {"TERM=xterm NO_COLOR=1", "TERM=dumb"}) {
    fs::remove_all(folder_);
    EXPECT_THAT(run_on_terminal(none, 80), Not(HasSubstr("\x1b[1m"))) << none;
  }
  fs::remove_all(folder_);
  EXPECT_THAT(run({"--no-report"}).output, Not(HasSubstr("\x1b"))) << "it is no terminal";
}

TEST_F(RunOutput, IsLoggedForOtherPrograms) {
  const fs::path log = scratch_ / "run.log";
  const Finished finished = run({"--log", log.string(), "--no-report"});
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  std::ifstream stream(log);
  std::vector<nlohmann::json> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(nlohmann::json::parse(line));
  ASSERT_EQ(lines.size(), 4u) << "one for each generation";
  EXPECT_EQ(lines.back()["evaluations"], 24);
  const auto shown =
      nlohmann::json::parse(testing::run({EVODEVO_PROGRAM, "show", folder_.string(), "--json"}).output)["generations"];
  for (std::size_t i = 0; i < lines.size(); ++i)
    for (const auto& [name, value] : lines[i].items()) EXPECT_EQ(value, shown[i].at(name)) << name;
}

TEST_F(RunOutput, NeverGoesIntoAFileThatTheCommandReads) {
  const auto refused = [](const Finished& finished, const std::string& file) {
    EXPECT_EQ(finished.exit_code, 2);
    EXPECT_THAT(finished.output, testing::naming("--log", file));
  };
  refused(run({"--log", file_}), file_);
  refused(run({"--log", (folder_ / "run.log").string()}), "run.log");
  EXPECT_FALSE(fs::exists(folder_)) << "a fault costs no folder";
  ASSERT_EQ(run({"--no-report", "--set", "experiment.evaluations=1000000", "--until", "1s"}).exit_code, 130);
  const std::string database = (folder_ / "run.sqlite").string();
  refused(testing::run({EVODEVO_PROGRAM, "resume", folder_.string(), "--log", database}), database);
  EXPECT_EQ(testing::run({EVODEVO_PROGRAM, "resume", folder_.string(), "--no-report", "--until", "1s"}).exit_code, 130);
}

TEST_F(RunOutput, EndsWithAPageOrTheCommandThatMakesIt) {
  const fs::path viewer = fs::path(EVODEVO_PROGRAM).parent_path().parent_path() / "share/evodevo/viewer/page.html";
  const Finished finished = run({});
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output, testing::naming(" film " + folder_.string(), " verify " + folder_.string()));
  const fs::path page = folder_ / "report.html";
  ASSERT_EQ(fs::exists(page), fs::exists(viewer));
  if (!fs::exists(viewer)) {
    EXPECT_THAT(finished.output, HasSubstr(" report " + folder_.string() + " --out " + page.string()));
    return;
  }
  EXPECT_THAT(finished.output, HasSubstr("file://" + page.lexically_normal().string()));
  std::ifstream stream(page);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_THAT(text, HasSubstr("\"kind\":\"report\""));
  fs::remove_all(folder_);
  EXPECT_THAT(run({"--no-report"}).output, Not(HasSubstr("report.html")));
  EXPECT_FALSE(fs::exists(page));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
