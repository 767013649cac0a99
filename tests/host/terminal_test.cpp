// Commands at the terminal: what they print and write to files, what `evodevo show` prints of a run, values of options
// that they refuse, and the time limit that one of them gives.
#include "commands/shell/output/terminal.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "base/output_file.hpp"
#include "commands/commands.hpp"
#include "commands/run/generation_log.hpp"
#include "commands/run/page.hpp"
#include "commands/run/time_limit.hpp"
#include "commands/shell/command.hpp"
#include "commands/shell/output/excerpt.hpp"
#include "support/archives.hpp"
#include "support/changed.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using ::testing::ElementsAre;

const std::vector<LinePart> parts{{"generation 12", 1}, {"evaluations 500", 0}, {"median 0.3", 3}, {"rate 7", 3}};

TEST(FittingParts, AreAllThatThereIsRoomForAndTheLeastImportantGoFirst) {
  const std::size_t all = std::string("generation 12  evaluations 500  median 0.3  rate 7").size();
  EXPECT_THAT(fitting_parts(parts, all), ElementsAre("generation 12", "evaluations 500", "median 0.3", "rate 7"));
  EXPECT_THAT(fitting_parts(parts, all - 1), ElementsAre("generation 12", "evaluations 500", "median 0.3"));
  EXPECT_THAT(fitting_parts(parts, 30), ElementsAre("generation 12", "evaluations 500"));
  EXPECT_THAT(fitting_parts(parts, 29), ElementsAre("evaluations 500"));
  // what must stay is cut
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
  const std::string windows = scratch.write("b.toml", "a = 1\r\nb = 2\r\n");
  EXPECT_EQ(excerpt_for(windows + ":1:5: small"), "  1 | a = 1\n    |     ^\n");
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
  EXPECT_THAT(testing::refusal<UsageError>([] { GenerationLog("/nowhere/run.log"); }),
              testing::naming("--log", "/nowhere/run.log", "folder"));
}

TEST(GenerationLog, EndsWithoutEndingTheRunWhenItsReaderHasEndedOrTheDiskIsFull) {
  const testing::Scratch scratch;
  const std::string pipe = (scratch / "pipe").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  GenerationLog log(pipe);
  log.add({.generation = 0});
  close(reader);
  EXPECT_THAT(testing::warnings_of([&] { log.add({.generation = 1}); }),
              testing::naming("--log", "pipe", "generation before 1"));
  GenerationLog full("/dev/full");
  const std::string said = testing::warnings_of([&] {
    for (const std::uint32_t generation : {0, 1}) full.add({.generation = generation});
  });
  EXPECT_THAT(said, testing::naming("--log", "/dev/full", "generation before 0"));
  EXPECT_EQ(said.find("warning"), said.rfind("warning")) << "it says so once";
}

/// Returns what `show` prints of a run of `count` generations, in each of which one individual is born.
std::string shown_of(std::uint32_t count, const std::string& experiment = testing::small_experiment) {
  const testing::Scratch scratch;
  const auto folder = scratch / "run";
  Archive archive = Archive::create(folder, testing::read(experiment), "cpu");
  for (std::uint32_t generation = 0; generation < count; ++generation) testing::commit_one(archive, generation);
  ::testing::internal::CaptureStdout();
  call(command_named("show"), {folder.string()});
  std::cout.flush();
  return ::testing::internal::GetCapturedStdout();
}

/// Returns the numbers of the generations that `show` prints of a run of `count` generations.
std::vector<std::uint32_t> generations_shown(std::uint32_t count) {
  std::istringstream shown(shown_of(count));
  std::vector<std::uint32_t> numbers;
  for (std::string line; std::getline(shown, line);) {
    std::uint32_t generation = 0, evaluations = 0;
    std::istringstream row(line);
    if (row >> generation >> evaluations && evaluations == generation + 1) numbers.push_back(generation);
  }
  return numbers;
}

TEST(Show, PrintsSomeTwentyGenerationsAndTheLast) {
  EXPECT_EQ(generations_shown(20).size(), 20u);
  EXPECT_EQ(generations_shown(21), (std::vector<std::uint32_t>{0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20}));
  EXPECT_EQ(generations_shown(40).size(), 21u);
  EXPECT_EQ(generations_shown(40).back(), 39u);
}

TEST(Show, TellsWhenTheBestWereBornAndNamesObjectivesIfThereAreSeveral) {
  EXPECT_THAT(shown_of(3), testing::naming("born in generation 0, age 2", "born in generation 2, age 0"));
  EXPECT_THAT(shown_of(1), ::testing::HasSubstr("distance (body lengths)"));
  const std::string one =
      testing::small_with({{"[[fitness]]\nname = \"actuation-work\"\nsettle = 0.05\nwindow = 0.1\n", ""}});
  EXPECT_THAT(shown_of(1, one), ::testing::HasSubstr("\ngeneration  evaluations       best     median  diverged"))
      << "nor is there room for a name";
}

namespace fs = std::filesystem;

const auto failure = testing::refusal<std::runtime_error>;

class OutputFiles : public ::testing::Test {
 protected:
  testing::Scratch scratch_;

  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(scratch_ / ""), fs::directory_iterator()));
  }
};

TEST_F(OutputFiles, APartNeverTakesTheName) {
  const fs::path file = scratch_.write("päge (1).html", "old");
  {
    OutputFile output(file, "--out");
    output.write("half of the ");
    EXPECT_EQ(testing::content_of(file), "old");
  }
  EXPECT_EQ(testing::content_of(file), "old");
  EXPECT_EQ(files(), 1u) << "what was not finished is gone";
  OutputFile output(file, "--out");
  output.write("new");
  output.finish();
  EXPECT_EQ(testing::content_of(file), "new");
  EXPECT_EQ(files(), 1u);
}

TEST_F(OutputFiles, ALinkAndItsPermissionsStay) {
  fs::create_symlink(scratch_ / "nothing", scratch_ / "link to nothing");
  write_file(scratch_ / "link to nothing", "new");
  EXPECT_TRUE(fs::is_symlink(scratch_ / "link to nothing"));
  EXPECT_EQ(testing::content_of(scratch_ / "nothing"), "new");
  const fs::path file = scratch_.write("there", "old"), link = scratch_ / "link";
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink(file, link);
  write_file(link, "new");
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(testing::content_of(file), "new");
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(OutputFiles, AFullDeviceIsSaidAndStaysADevice) {
  fs::create_symlink("/dev/full", scratch_ / "full.html");
  for (const std::size_t size : {1u, 100'000u})
    for (const fs::path& file : {fs::path("/dev/full"), scratch_ / "full.html"}) {
      const std::string said = failure([&] { write_file(file, std::string(size, 'x')); });
      EXPECT_THAT(said, testing::naming(file.string(), "No space left on device")) << size;
    }
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
  EXPECT_EQ(files(), 1u);
}

TEST_F(OutputFiles, WhereNothingCanBeTheCauseIsNamed) {
  EXPECT_THAT(failure([&] { OutputFile(scratch_ / "no folder" / "x", "--out x"); }),
              testing::naming("--out x: ", "No such file or directory"));
  EXPECT_THAT(failure([&] { OutputFile(scratch_ / "", "--out x"); }), testing::naming("Is a directory"));
}

using Words = std::vector<std::string>;

class OptionValues : public ::testing::Test {
 protected:
  OptionValues() {
    Archive archive = Archive::create(folder_, testing::read(testing::small_experiment), "cpu");
    testing::commit_one(archive, 0);
  }

  /// Expects that a command names the place first, such as an option and its value, and then the remedy.
  void expect_refused(const std::string& command, const Words& words, const std::string& place,
                      const std::string& remedy) const {
    const std::string said = testing::refusal<InputError>([&] { call(command_named(command), words); });
    EXPECT_THAT(said, testing::at_place(place, remedy)) << command;
  }

  testing::Scratch scratch_;
  std::string folder_ = (scratch_ / "run").string();
  std::string file_ = scratch_.write("small.toml", testing::small_experiment);
  std::string page_ = (scratch_ / "page.html").string();
};

TEST_F(OptionValues, NumbersHaveARange) {
  const struct {
    std::string command;
    Words words;
    std::string option, least, beyond, range;
  } cases[] = {
      {"report", {folder_, "--out", page_}, "--best", "-1", "101", "0 to 100"},
      {"report", {folder_, "--out", page_}, "--elites", "-1", "1001", "0 to 1000"},
      {"gallery", {file_, "--out", page_}, "--count", "0", "1001", "1 to 1000"},
      {"environments", {file_}, "--starts", "0", "51", "1 to 50"},
      {"verify", {folder_}, "--best", "0", "1001", "1 to 1000"},
      {"simulate", {file_, file_}, "--duration", "0", "1000001", "more than 0"},
  };
  for (const auto& [command, words, option, least, beyond, range] : cases)
    for (const std::string& value : {least, beyond}) {
      Words all = words;
      all.insert(all.end(), {option, value});
      expect_refused(command, all, option + " " + value + ": ", range);
    }
  expect_refused("environments", {file_, "--individual", "-1"}, "--individual -1: ", "0 or more");
  expect_refused("conform", {file_, "--seed", "-1"}, "--seed -1: ", "0 or more");
  expect_refused("environments", {file_, "--set", "development.cycles=0"},
                 file_ + ": development.cycles: ", "1 or more");
}

TEST_F(OptionValues, MomentsOfAFilmFitTogether) {
  const std::string film = (scratch_ / "film.mp4").string(), picture = (scratch_ / "film.png").string();
  for (const char* option : {"--from", "--to"}) {
    expect_refused("film", {folder_, "--out", film, option, "-0.1"}, option + std::string(" -0.1: "), "0 s or later");
    expect_refused("film", {folder_, "--out", picture, option, "0.1"}, "--from and --to", "--at");
  }
  expect_refused("film", {folder_, "--out", picture, "--at", "-0.1"}, "--at -0.1: ", "0 s or later");
  expect_refused("film", {folder_, "--out", film, "--at", "1"}, "--at 1: ", ".png");
  for (const char* end : {"0.5", "0.7"})
    expect_refused("film", {folder_, "--out", film, "--from", "0.7", "--to", end}, std::string("--to ") + end + ": ",
                   "--from 0.7");
}

using namespace std::chrono_literals;
using Clock = TimeLimit::Clock;

const Clock::time_point begin = Clock::now();

TEST(TimeLimit, IsReachedWhenAnotherGenerationWouldNotLeaveTheReserve) {
  TimeLimit limit(begin, begin + 100s);  // the last generation has to end after 90 s
  limit.generation_done(7, begin + 7s);
  limit.generation_done(11, begin + 78s);
  EXPECT_FALSE(limit.is_reached()) << "89 s";
  limit.generation_done(1, begin + 79500ms);
  EXPECT_TRUE(limit.is_reached()) << "the longest of all counts: 90.5 s";
  limit.generation_done(0.5, begin + 3s);
  EXPECT_TRUE(limit.is_reached()) << "it stays so";
  EXPECT_EQ(limit.end(), begin + 100s);
  TimeLimit late(begin, begin + 10h);
  late.generation_done(60, begin + 9h + 28min);
  EXPECT_FALSE(late.is_reached()) << "half an hour is the longest reserve";
  late.generation_done(60, begin + 9h + 29min + 1s);
  EXPECT_TRUE(late.is_reached());
}

TEST(TimeLimit, IsADurationOrALocalTime) {
  const auto seconds_until = [](const std::string& text) {
    const Clock::time_point before = Clock::now();
    const Clock::time_point end = end_given_by(text);
    const auto seconds = [&](Clock::time_point time) { return std::chrono::duration<double>(time - before).count(); };
    return std::pair(seconds(end), seconds(Clock::now()));
  };
  for (const auto& [text, seconds] : {std::pair("75s", 75.0), {"1.5m", 90.0}, {"0.25h", 900.0}, {"2d", 172800.0}}) {
    const auto [until, elapsed] = seconds_until(text);
    EXPECT_GE(until, seconds - 1e-6) << text;
    EXPECT_LE(until, seconds + elapsed + 1e-6) << text;
  }
  const std::time_t tomorrow = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now() + 24h);
  std::tm local{};
  localtime_r(&tomorrow, &local);
  for (const auto& [format, seconds] : {std::pair("%Y-%m-%dT%H:%M", 60.0), {"%Y-%m-%dT%H:%M:%S", 1.0}}) {
    char text[32];
    ASSERT_GT(std::strftime(text, sizeof text, format, &local), 0u);
    const auto [until, elapsed] = seconds_until(text);
    EXPECT_GT(until, 24 * 3600.0 - 2 * seconds - elapsed) << text;
    EXPECT_LE(until, 24 * 3600.0 + elapsed) << text;
  }
}

TEST(TimeLimit, RefusesWhatIsNoTimeInTheFuture) {
  for (const std::string text :
       {"", "90", "m", "-5m", "0s", "0.9s", "1e-12h", "nanh", "infh", "1e99d", "90 m", "5x", "2001-02-03T04:05",
        "2030-13-01T00:00", "2030-02-30T18:30", "2031-04-31T00:00:00", "tomorrow", "2030-01-31"})
    EXPECT_THAT(testing::refusal<UsageError>([&] { end_given_by(text); }),
                testing::at_place("--until " + text + ": ", "90m", "T18:30"));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
