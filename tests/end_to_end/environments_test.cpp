// evodevo environments: one genome in several scenes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/experiments.hpp"
#include "support/process.hpp"
#include "support/scratch.hpp"

namespace evodevo {
namespace {

using ::testing::HasSubstr;
using testing::small_experiment;

class Environments : public ::testing::Test {
 protected:
  /// The command's answer; individual 4 has a body.
  static testing::Finished environments(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {EVODEVO_PROGRAM, "environments"});
    arguments.insert(arguments.end(), {"--individual", "4", "--set", "encoding.size=[3,2,2]", "--set",
                                       "development.cycles=6", "--set", "development.cycle_time=0.2"});
    return testing::run(arguments);
  }
  static nlohmann::json json(std::vector<std::string> arguments) {
    arguments.emplace_back("--json");
    const testing::Finished finished = environments(std::move(arguments));
    EXPECT_EQ(finished.exit_code, 0) << finished.output;
    return nlohmann::json::parse(finished.output);
  }

  std::string other(const char* name, const std::string& instead_of, const std::string& line) {
    std::string text = small_experiment;
    text.replace(text.find(instead_of), instead_of.size(), line);
    return scratch_.write(name, text);
  }

  testing::Scratch scratch_;
  std::string flat_ = scratch_.write("flat.toml", small_experiment);
};

TEST_F(Environments, TheSameSceneWithoutNoiseGrowsTheSameBody) {
  const auto answer = json({flat_, flat_, "--starts", "1"});
  ASSERT_EQ(answer.at("distances").size(), 1u);
  EXPECT_EQ(answer.at("distances")[0].at("springs"), 0);
  EXPECT_EQ(answer.at("distances")[0].at("mass"), 0);
  EXPECT_EQ(answer.at("scenes")[0].at("starts"), answer.at("scenes")[1].at("starts"));
}

TEST_F(Environments, EveryPairOfLivesHasItsDistances) {
  const std::string slope = other("slope.toml", "[scene.gravity]", "[scene.gravity]\nslope = 30");
  const auto answer = json({flat_, slope, "--starts", "3"});
  ASSERT_EQ(answer.at("scenes").size(), 2u);
  for (const auto& scene : answer.at("scenes")) {
    ASSERT_EQ(scene.at("starts").size(), 3u);
    for (const auto& start : scene.at("starts")) {
      EXPECT_EQ(start.at("status"), "ok");
      EXPECT_FALSE(start.at("body").at("springs").empty());
    }
  }
  EXPECT_EQ(answer.at("scenes")[1].at("slope"), 30);
  EXPECT_EQ(answer.at("distances").size(), 3u + 9u + 3u);
  double largest = 0;
  for (const auto& distance : answer.at("distances")) {
    for (const char* kind : {"springs", "mass"}) {
      EXPECT_GE(distance.at(kind), 0);
      EXPECT_LE(distance.at(kind), 1);
    }
    if (distance.at("scenes")[0] != distance.at("scenes")[1])
      largest = std::max(largest, distance.at("springs").get<double>());
  }
  EXPECT_GT(largest, 0) << "the slope has changed nothing";
}

TEST_F(Environments, TheTableNamesScenesAndNoise) {
  const std::string weak = other("weak.toml", "[scene.gravity]", "[scene.gravity]\nacceleration = 1.62");
  const testing::Finished finished = environments({flat_, weak, "--starts", "2"});
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  for (const char* part : {"flat", "weak", "start noise alone", "springs that only one body has", "mass that lies"})
    EXPECT_THAT(finished.output, HasSubstr(part));
}

TEST_F(Environments, OneGenomeNeedsOneEncoding) {
  const std::string sized = other("sized.toml", "edge = 0.5", "edge = 0.5\nsize_range = 0.2");
  const testing::Finished finished = environments({flat_, sized});
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_THAT(finished.output, HasSubstr("sized.toml: encoding: has other genes than that of " + flat_));
  const std::string wide = other("wide.toml", "edge = 0.5", "edge = 0.6");
  EXPECT_THAT(environments({flat_, wide}).output,
              HasSubstr("wide.toml: encoding: has other parameters than that of " + flat_));
}

TEST_F(Environments, BadNumbersAreRefused) {
  EXPECT_THAT(environments({}).output, HasSubstr("give experiments"));
  EXPECT_THAT(environments({flat_, "--starts", "0"}).output, HasSubstr("--starts 0: expected 1 to 200"));
}

}  // namespace
}  // namespace evodevo
