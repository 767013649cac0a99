// What commands print on terminals.
#include "commands/shell/output/terminal.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "commands/run/generation_log.hpp"
#include "commands/run/page.hpp"
#include "commands/shell/command.hpp"
#include "commands/shell/output/excerpt.hpp"
#include "support/messages.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using ::testing::ElementsAre;

const std::vector<LinePart> parts{{"generation 12", 1}, {"evaluations 500", 0}, {"median 0.3", 3}, {"rate 7", 3}};

TEST(FittingParts, AllOfThemIfThereIsRoom) {
  const std::size_t all = std::string("generation 12  evaluations 500  median 0.3  rate 7").size();
  EXPECT_THAT(fitting_parts(parts, all), ElementsAre("generation 12", "evaluations 500", "median 0.3", "rate 7"));
  EXPECT_THAT(fitting_parts(parts, all - 1), ElementsAre("generation 12", "evaluations 500", "median 0.3"));
}

TEST(FittingParts, TheLeastImportantGoFirst) {
  EXPECT_THAT(fitting_parts(parts, 30), ElementsAre("generation 12", "evaluations 500"));
  EXPECT_THAT(fitting_parts(parts, 29), ElementsAre("evaluations 500"));
}

TEST(FittingParts, CutWhatMustStay) {
  EXPECT_THAT(fitting_parts(parts, 4), ElementsAre("eval"));
  EXPECT_THAT(fitting_parts({{"one", 0}, {"two", 0}}, 6), ElementsAre("one", "t"));
  EXPECT_THAT(fitting_parts({{"one", 0}, {"two", 0}}, 5), ElementsAre("one"));
  EXPECT_THAT(fitting_parts(parts, 0), ElementsAre());
  EXPECT_THAT(fitting_parts({}, 10), ElementsAre());
}

TEST(Link, EscapesWhatABrowserWouldMisread) {
  EXPECT_EQ(link_to("/runs/walk-1/report.html"), "file:///runs/walk-1/report.html");
  EXPECT_EQ(link_to("/my runs/50 % #1?.html"), "file:///my%20runs/50%20%25%20%231%3F.html");
  EXPECT_EQ(link_to("/a/../b/\xc3\xa9.html"), "file:///b/%C3%A9.html");
}

TEST(Excerpt, ShowsTheLineAndTheColumn) {
  const testing::Scratch scratch;
  const std::string file = scratch.write("a.toml", "[encoding]\n\tname = \"\xc3\xa9\" # x\nlast = 1");
  EXPECT_EQ(excerpt_for(file + ":1:2: unknown table"), "  1 | [encoding]\n    |  ^\n");
  EXPECT_EQ(excerpt_for(file + ":3:8: last = 1: too small"), "  3 | last = 1\n    |        ^\n");
  const std::string second = excerpt_for(file + ":2:13: name");
  EXPECT_EQ(second.substr(second.find('\n')), "\n    | " + std::string(second.find('#') - 7, ' ') + "^\n")
      << "a character of two bytes has one column";
}

TEST(Excerpt, IsEmptyIfThereIsNothingToShow) {
  const testing::Scratch scratch;
  const std::string file = scratch.write("a.toml", "a = 1\n" + std::string(300, 'x'));
  for (const std::string& message :
       {file + ": no place", file + ":9:1: no such line", file + ":2:1: a line that is too long",
        file + ":99999999:1: no number", std::string("nowhere.toml:1:1: no file"), std::string("--set a=1: no file"),
        std::string("/dev/zero:1:1: no file to read"), std::string()})
    EXPECT_EQ(excerpt_for(message), "") << message;
  EXPECT_EQ(excerpt_for(file + ":1:40: behind the end"), "  1 | a = 1\n    |      ^\n");
  const std::string windows = scratch.write("b.toml", "a = 1\r\nb = 2\r\n");
  EXPECT_EQ(excerpt_for(windows + ":1:5: small"), "  1 | a = 1\n    |     ^\n");
}

TEST(GenerationLog, HasALineForEachGenerationBehindThoseThatAreThere) {
  const testing::Scratch scratch;
  const std::filesystem::path file = scratch / "run.log";
  GenerationLog(file).add({.generation = 0, .evaluations = 30, .wall_time = 0.5});
  GenerationLog(file).add({.generation = 1, .evaluations = 60, .best = 2.5, .median = 1, .diverged = 3});
  std::ifstream stream(file);
  std::vector<nlohmann::json> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(nlohmann::json::parse(line));
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_TRUE(lines[0]["best"].is_null());
  EXPECT_EQ(lines[0]["wall_time"], 0.5);
  EXPECT_EQ(lines[1]["generation"], 1);
  EXPECT_EQ(lines[1]["evaluations"], 60);
  EXPECT_EQ(lines[1]["best"], 2.5);
  EXPECT_EQ(lines[1]["diverged"], 3);
}

TEST(GenerationLog, RefusesAFileThatCannotBeOpened) {
  try {
    GenerationLog("/nowhere/run.log");
    FAIL() << "it is opened";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), testing::naming("--log", "/nowhere/run.log", "folder"));
  }
}

TEST(GenerationLog, EndsWithoutEndingTheRunWhenItsReaderHasEnded) {
  const testing::Scratch scratch;
  const std::string pipe = (scratch / "pipe").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  GenerationLog log(pipe);
  log.add({.generation = 0});
  close(reader);
  ::testing::internal::CaptureStderr();
  log.add({.generation = 1});
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), testing::naming("--log", "pipe", "generation before 1"));
}

TEST(GenerationLog, EndsWithoutEndingTheRunWhenTheDiskIsFull) {
  GenerationLog log("/dev/full");
  ::testing::internal::CaptureStderr();
  for (const std::uint32_t generation : {0, 1}) log.add({.generation = generation});
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_THAT(said, testing::naming("--log", "/dev/full", "generation before 0"));
  EXPECT_EQ(said.find("warning"), said.rfind("warning")) << "it says so once";
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
