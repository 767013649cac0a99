// Runs with scenarios and scores of several roles: what commands say of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "evolution/archive/archive.hpp"
#include "support/experiments.hpp"
#include "support/process.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using testing::Finished;
using ::testing::HasSubstr;

Finished evodevo(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), EVODEVO_PROGRAM);
  return testing::run(arguments);
}

/// Provides a finished run with scenarios.
class ScenarioRun : public ::testing::Test {
 protected:
  static inline const std::string text = testing::small_experiment + R"(
[[fitness]]
name = "descriptor"
what = "contact"
label = "touching"
settle = 0.05
window = 0.1

[[scenario]]
name = "flat"

[[scenario]]
name = "hurt"
damage = 0.1
repeat = 2
[scenario.gravity]
slope = 5
)";

  void SetUp() override {
    const Finished finished =
        evodevo({"run", file_, "--out", folder_, "--device", "cpu", "--set", "fitness.0.over=worst"});
    ASSERT_EQ(finished.exit_code, 0) << finished.output;
  }

  testing::Scratch scratch_;
  std::string file_ = scratch_.write("small.toml", text);
  std::string folder_ = (scratch_ / "run").string();
};

TEST_F(ScenarioRun, KeepsTheScoresOfEveryTest) {
  const Archive archive = Archive::read(folder_);
  const std::uint32_t best = archive.best(1).at(0);
  const std::vector<ArchivedTest> tests = archive.tests(best);
  ASSERT_EQ(tests.size(), 3u * 2) << "two objectives in each of three tests";
  double worst = tests[0].value, work = 0;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    EXPECT_EQ(tests[i].scenario, i < 2 ? "flat" : "hurt");
    EXPECT_EQ(tests[i].repeat, i / 2 == 2 ? 1 : 0);
    EXPECT_EQ(tests[i].objective, i % 2 == 0 ? "distance" : "actuation-work");
    if (i % 2 == 0)
      worst = std::min(worst, tests[i].value);
    else
      work += tests[i].value / 3;
  }
  const ArchivedIndividual individual = archive.known_individual(best);
  EXPECT_EQ(individual.result.objectives.at(0), worst);
  EXPECT_NEAR(individual.result.objectives.at(1), work, 1e-12 * work) << "the mean by default";
  const std::vector<ArchivedMeasure> measures = archive.measures(best);
  ASSERT_EQ(measures.size(), 1u);
  EXPECT_EQ(measures[0].name, "touching");
  EXPECT_EQ(measures[0].role, "descriptor");
}

TEST_F(ScenarioRun, IsShown) {
  EXPECT_THAT(evodevo({"show", folder_}).output,
              AllOf(HasSubstr("distance by scenario: flat "), HasSubstr(", hurt "),
                    HasSubstr("actuation-work by scenario: flat "), HasSubstr("actuation-work (J), lower is better"),
                    HasSubstr("best individuals in actuation-work"),
                    ContainsRegex("touching [0-9.e-]+\n")));  // no unit "1"
  const auto best = nlohmann::json::parse(evodevo({"show", folder_, "--json"}).output).at("best");
  ASSERT_EQ(best.at("scenarios").size(), 3u);
  EXPECT_EQ(best.at("scenarios")[2].at("scenario"), "hurt");
  EXPECT_EQ(best.at("scenarios")[2].at("repeat"), 2);
  EXPECT_EQ(best.at("scenarios")[2].at("objectives").size(), 2u);
  EXPECT_GT(best.at("measures").at("touching"), 0);
}

TEST_F(ScenarioRun, IsVerifiedInAllScenarios) {
  const Finished finished = evodevo({"verify", folder_, "--best", "1", "--json"});
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  const auto verification = nlohmann::json::parse(finished.output).at(0);
  EXPECT_EQ(verification.at("trials")[0].at("trial"), "again");
  EXPECT_EQ(verification.at("trials")[0].at("value"), verification.at("fitness")) << "the worst of all tests, again";
}

TEST_F(ScenarioRun, ABodyIsSimulatedInAScenarioByName) {
  const std::string body = scratch_.write("body.json", evodevo({"body", folder_}).output);
  const auto simulate = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"simulate", body, file_, "--duration", "0.2", "--device", "cpu"});
    return evodevo(more);
  };
  const Finished usual = simulate({}), flat = simulate({"--scenario", "flat"}), hurt = simulate({"--scenario", "hurt"});
  ASSERT_EQ(hurt.exit_code, 0) << hurt.output;
  const auto end = [](const Finished& finished) {
    return finished.output.substr(finished.output.find("after"),
                                  finished.output.find("speed") - finished.output.find("after"));
  };
  EXPECT_EQ(end(usual), end(flat));
  EXPECT_NE(end(usual), end(hurt));
  const Finished unknown = simulate({"--scenario", "flatt"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.output, AllOf(HasSubstr("--scenario flatt"), HasSubstr("flat, hurt")));
}

TEST_F(ScenarioRun, TellsALifeInAScenarioThatDevelops) {
  const std::string mud = scratch_.write(
      "mud.toml", text + "\n[[scenario]]\nname = 'mud'\ndevelops = true\n[scenario.drag]\ncoefficient = 3\n");
  const std::string folder = (scratch_ / "mud").string();
  ASSERT_EQ(evodevo({"run", mud, "--out", folder, "--device", "cpu"}).exit_code, 0);
  const auto life = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"life", folder, "--json"});
    return nlohmann::json::parse(evodevo(more).output);
  };
  const auto here = life({}), there = life({"--scenario", "mud"});
  EXPECT_TRUE(here.at("scenario").is_null());
  EXPECT_EQ(there.at("scenario"), "mud");
  EXPECT_EQ(there.at("born"), here.at("born"));
  EXPECT_EQ(there.at("edits").size(), here.at("edits").size()) << "the operators do as much";
  EXPECT_NE(there.at("edits"), here.at("edits")) << "but for other causes";
  const auto body = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"body", folder, "--matured"});
    return evodevo(more).output;
  };
  EXPECT_NE(body({}), body({"--scenario", "mud"}));

  const Finished other = evodevo({"life", folder, "--scenario", "hurt"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.output, AllOf(HasSubstr("--scenario hurt"), HasSubstr("develop")));
  const Finished newborn = evodevo({"body", folder, "--scenario", "mud"});
  EXPECT_EQ(newborn.exit_code, 2);
  EXPECT_THAT(newborn.output, AllOf(HasSubstr("--scenario mud"), HasSubstr("--matured")));
}

TEST_F(ScenarioRun, GivesTheSameScoresAgain) {
  const std::string again = (scratch_ / "again").string();
  ASSERT_EQ(evodevo({"run", file_, "--out", again, "--device", "cpu", "--set", "fitness.0.over=worst", "--set",
                     "experiment.evaluations=12"})
                .exit_code,
            0);
  const Archive whole = Archive::read(folder_), half = Archive::read(again);
  for (std::uint32_t id = 0; id < 12; ++id) {
    const auto a = whole.tests(id), b = half.tests(id);
    ASSERT_EQ(a.size(), b.size()) << id;
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].value, b[i].value);
  }
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
