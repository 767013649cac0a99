// Values of options that commands refuse.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "commands/commands.hpp"
#include "support/archives.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

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
    std::string said = "nothing";
    try {
      call(command_named(command), words);
    } catch (const InputError& error) {
      said = error.what();
    }
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

TEST_F(OptionValues, EnvironmentsAreForBodiesThatDevelop) {
  expect_refused("environments", {file_, "--set", "development.cycles=0"},
                 file_ + ": development.cycles: ", "1 or more");
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
