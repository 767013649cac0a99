// What `evodevo show` prints of a run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "commands/commands.hpp"
#include "support/archives.hpp"
#include "support/experiments.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

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

TEST(Show, TellsWhenTheBestWereBornAndHowOldTheyAre) {
  const std::string shown = shown_of(3);
  EXPECT_THAT(shown, ::testing::HasSubstr("born in generation 0, age 2"));
  EXPECT_THAT(shown, ::testing::HasSubstr("born in generation 2, age 0"));
}

TEST(Show, NamesObjectivesIfThereAreSeveral) {
  EXPECT_THAT(shown_of(1), ::testing::HasSubstr("distance (body lengths)"));
  std::string one = testing::small_experiment;
  const std::size_t second = one.rfind("[[fitness]]");
  one.erase(second, one.find("[selection]") - second);
  EXPECT_THAT(shown_of(1, one), ::testing::HasSubstr("\ngeneration  evaluations       best     median  diverged"))
      << "nor is there room for a name";
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
