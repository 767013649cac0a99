// The command `evodevo environments`, which develops one genome in several scenes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "archive/archive.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/program.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using namespace testing;
using ::testing::HasSubstr;
using Json = nlohmann::json;

class Environments : public ::testing::Test {
 protected:
  /// Runs the command for individual 4, which has a valid body.
  static std::string environments(const Words& words, int exit_code = 0) {
    const Words values{"encoding.size=[3,2,2]", "development.cycles=6", "development.cycle_time=0.2"};
    const Words command = joined({EVODEVO_PROGRAM, "environments"}, words);
    return output_of(joined(joined(command, {"--individual", "4"}), setting(values)), exit_code);
  }
  static Json json(const Words& words) { return Json::parse(environments(joined(words, {"--json"}))); }

  std::string other(const char* name, const std::string& instead_of, const std::string& line) {
    std::string text = small_experiment;
    text.replace(text.find(instead_of), instead_of.size(), line);
    return scratch_.write(name, text);
  }

  Scratch scratch_;
  std::string flat_ = scratch_.write("flat.toml", small_experiment);
  std::string slope_ = other("slope.toml", "[scene.gravity]", "[scene.gravity]\nslope = 30");
};

TEST_F(Environments, TheSameSceneWithoutNoiseGrowsTheSameBody) {
  const Json answer = json({flat_, flat_, "--starts", "1"})[0];
  ASSERT_EQ(answer.at("pairs").size(), 1u);
  const auto& pair = answer.at("pairs")[0];
  ASSERT_EQ(pair.at("springs").size(), 6u) << "one for each cycle";
  for (const char* kind : {"springs", "mass"})
    for (const auto& effect : pair.at(kind)) {
      EXPECT_EQ(effect.at("between"), 0);
      EXPECT_TRUE(effect.at("within").is_null());
      EXPECT_TRUE(effect.at("p").is_null());
    }
  EXPECT_EQ(answer.at("scenes")[0].at("starts"), answer.at("scenes")[1].at("starts"));
}

TEST_F(Environments, EveryGenomeHasItsBodiesAndDistances) {
  const Json answers = json({flat_, slope_, flat_, "--starts", "3", "--individual", "5"});
  ASSERT_EQ(answers.size(), 2u);
  EXPECT_EQ(answers[0].at("individual"), 5);
  EXPECT_EQ(answers[1].at("individual"), 4);
  const auto& answer = answers[1];
  ASSERT_EQ(answer.at("scenes").size(), 3u);
  for (const auto& scene : answer.at("scenes")) {
    ASSERT_EQ(scene.at("starts").size(), 3u);
    for (const auto& start : scene.at("starts")) {
      EXPECT_EQ(start.at("status"), "ok");
      EXPECT_FALSE(start.at("body").at("springs").empty());
    }
  }
  EXPECT_EQ(answer.at("scenes")[1].at("slope"), 30);
  ASSERT_EQ(answer.at("pairs").size(), 3u);
  EXPECT_EQ(answer.at("pairs")[1].at("scenes"), Json({0, 2}));
  EXPECT_EQ(answer.at("pairs")[1].at("springs")[5].at("p"), 1) << "a scene differs from itself";
  EXPECT_GT(answer.at("pairs")[0].at("springs")[5].at("between"), 0) << "the slope has changed nothing";
}

TEST_F(Environments, ScenesOfScenariosAreThereOnce) {
  const std::string tested = scratch_.write("tested.toml", small_experiment + R"(
[[scenario]]
name = "as it is"
[[scenario]]
name = "hurt"
damage = 0.1
[[scenario]]
name = "uphill"
[scenario.gravity]
slope = -30
[[scenario]]
name = "uphill again"
repeat = 2
start_noise = 0.01
[scenario.gravity]
slope = -30
[[scenario]]
name = "laden"
[scenario.payload]
share = 0.5
)");
  const auto names = [](const Json& answer) {
    std::vector<std::string> found;
    for (const auto& scene : answer.at("scenes")) found.push_back(scene.at("name"));
    return found;
  };
  const auto alone = json({tested, "--starts", "1"})[0];
  EXPECT_EQ(names(alone), (std::vector<std::string>{"tested", "uphill", "laden"}));
  EXPECT_EQ(alone.at("scenes")[1].at("slope"), -30);
  const auto heaviest = [&](std::size_t scene) {
    double most = 0;
    for (const auto& mass : alone.at("scenes")[scene].at("starts")[0].at("body").at("masses"))
      most = std::max(most, mass.at("mass").get<double>());
    return most;
  };
  EXPECT_GT(heaviest(2), heaviest(0)) << "the scenario's payload";

  const std::string slope = other("slope.toml", "[scene.gravity]", "[scene.gravity]\nslope = -30");
  const auto both = json({slope, tested, "--starts", "1"})[0];
  EXPECT_EQ(names(both), (std::vector<std::string>{"slope", "tested", "tested: laden"}));
  EXPECT_EQ(both.at("scenes")[0].at("starts"), alone.at("scenes")[1].at("starts")) << "the same scene, the same body";
}

TEST_F(Environments, WhereNothingDevelopsTheBodyStaysTheSameHoweverItLies) {
  const auto with = [&](const std::string& other, const std::string& control) {
    return json({flat_, other, "--starts", "1", "--set", "development.control=" + control})[0];
  };
  const Json still = with(slope_, "no-change"), random = with(flat_, "random-places");
  for (const char* kind : {"springs", "mass"}) EXPECT_EQ(still.at("pairs")[0].at(kind)[5].at("between"), 0);
  const auto body = [](const Json& answer) { return answer.at("scenes")[0].at("starts")[0].at("body").at("springs"); };
  EXPECT_NE(body(random), body(still)) << "bodies at random places are the ones that have grown";
}

TEST_F(Environments, TheTableNamesScenesAndCycles) {
  const std::string weak = other("weak.toml", "[scene.gravity]", "[scene.gravity]\nacceleration = 1.62");
  const std::string table = environments({flat_, weak, "--starts", "2"});
  EXPECT_THAT(table, naming("individual 4", "flat", "weak", "after cycle  6", "springs that only one",
                            "body lengths at birth"));
  EXPECT_THAT(table, ::testing::Not(HasSubstr("after cycle  5")));
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);)
    if (line.find("weak") != std::string::npos) {
      EXPECT_LE(line.size(), 80u) << "a row fits a page";
    }
  EXPECT_THAT(environments({flat_, weak, "--starts", "2", "--all"}),
              naming("after cycle  1", "after cycle  5", "after cycle  6"));
}

TEST_F(Environments, OfARunTakesTheBestIndividualUnlessOthersAreNamed) {
  const std::string folder = (scratch_ / "run").string();
  said({"run", flat_, "--out", folder, "--set", "experiment.verify=0"});
  const std::uint32_t best = Archive::read(folder).best(1).at(0);
  const Words command{"environments", flat_, "--run", folder, "--starts", "1", "--json"};
  const auto grown = [](const Json& answer) { return answer.at("scenes").at(0).at("starts").at(0).at("body"); };
  const Json chosen = Json::parse(said(command));
  ASSERT_EQ(chosen.size(), 1u);
  EXPECT_EQ(chosen.at(0).at("individual"), best);
  EXPECT_EQ(grown(chosen.at(0)).at("springs").size(),
            Json::parse(said({"body", folder, "--matured"})).at("springs").size());
  const std::string other = std::to_string(best == 0 ? 1 : 0);
  EXPECT_EQ(Json::parse(said(joined(command, {"--individual", other}))).at(0).at("individual").dump(), other);
}

TEST_F(Environments, OneGenomeNeedsOneMeaningAndADevelopment) {
  EXPECT_THAT(environments({flat_, other("sized.toml", "edge = 0.5", "edge = 0.6")}, 2),
              naming("sized.toml: encoding.edge ", "0.6", "0.5"));
  const std::string soft = other("soft.toml", "[development]", "[materials.bone]\nstiffness = 100\n\n[development]");
  EXPECT_THAT(environments({flat_, soft}, 2), naming("soft.toml: materials.bone.stiffness ", "100"));
  const std::string ruled =
      scratch_.write("ruled.toml", small_experiment + "\n[[development.operator]]\nname = 'regulated-growth'\n");
  for (const auto& [one, two] : {std::pair{flat_, ruled}, {ruled, flat_}})
    EXPECT_THAT(environments({one, two}, 2), naming(two, "genes", "same operators"));
  EXPECT_THAT(testing::refusal({"environments", flat_, "--set", "development.cycles=0"}),
              HasSubstr("flat.toml: development.cycles: "));
  EXPECT_THAT(environments({}, 2), naming("EXPERIMENT.toml", "missing"));
}

TEST_F(Environments, WarnsOfWhatElseDiffers) {
  const std::string eager = other("eager.toml", "springs = 2", "springs = 3");
  EXPECT_THAT(environments({flat_, eager, "--starts", "1"}),
              naming("warning: " + eager + ": development.operator.0.springs ", "3", "2"));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
