// The numbers of a run with several objectives: the progress in each, the best of each, and the scores of the living.
#include "report/run_json.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "evolution/evolution.hpp"
#include "report/diversity.hpp"
#include "report/report.hpp"
#include "support/experiments.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using ::testing::ElementsAre;
using Json = nlohmann::ordered_json;

/// A finished run with the objectives distance and actuation-work, of which the second is minimised, a descriptor, and
/// two scenarios.
class RunJson : public ::testing::Test {
 protected:
  static inline const std::string text = testing::small_experiment + R"(
[[fitness]]
name = "descriptor"
what = "height"
label = "stature"
range = [0.0, 1.0]
bins = 1000
settle = 0.05
window = 0.1

[[scenario]]
name = "flat"

[[scenario]]
name = "hurt"
damage = 0.1
repeat = 2
)";

  void SetUp() override {
    std::atomic<bool> stop = false;
    const Observer observer{.generation_done = [&](const Summary&) { stop = true; }};
    for (; !is_finished(experiment_, archive_.generations()); stop = false) {
      evolve(experiment_, *simulator_, archive_, stop, observer);
      population_.push_back(archive_.population());
    }
  }

  /// The scores in an objective of the individuals alive after a generation.
  std::vector<double> living(std::size_t generation, std::size_t objective) const {
    std::vector<double> scores;
    for (const Individual& individual : population_.at(generation))
      if (individual.result.status == Status::ok) scores.push_back(individual.result.objectives.at(objective));
    std::sort(scores.begin(), scores.end());
    return scores;
  }

  testing::Scratch scratch_;
  Experiment experiment_ = testing::read(text);
  std::unique_ptr<Simulator> simulator_ = make_cpu_simulator(experiment_.scene, experiment_.stepping, 1);
  Archive archive_ = Archive::create(scratch_ / "run", experiment_, simulator_->device());
  std::vector<std::vector<Individual>> population_;  ///< after each generation
};

double median(const std::vector<double>& sorted) {
  const std::size_t n = sorted.size();
  return n % 2 == 1 ? sorted[n / 2] : (sorted[n / 2 - 1] + sorted[n / 2]) / 2;
}

TEST_F(RunJson, HasTheProgressOfTheLivingInEachObjective) {
  const Json generations = run_json(archive_, experiment_)["generations"];
  ASSERT_EQ(generations.size(), population_.size());
  ASSERT_GT(generations.size(), 2u);
  for (std::size_t g = 0; g < generations.size(); ++g) {
    const auto &distance = generations[g]["objectives"]["distance"],
               &work = generations[g]["objectives"]["actuation-work"];
    EXPECT_EQ(distance["best"], generations[g]["best"]);
    EXPECT_EQ(distance["best"], living(g, 0).back());
    EXPECT_EQ(distance["median"], median(living(g, 0)));
    EXPECT_EQ(work["best"], living(g, 1).front()) << "the least";
    EXPECT_EQ(work["median"], median(living(g, 1)));
  }
}

TEST_F(RunJson, HasTheBestOfEachObjective) {
  const Json objectives = run_json(archive_, experiment_)["objectives"];
  std::vector<double> distances, works;
  for (std::uint32_t id = 0; id < 24; ++id)
    if (const auto individual = archive_.known_individual(id); individual.result.status == Status::ok) {
      distances.push_back(individual.result.objectives[0]);
      works.push_back(individual.result.objectives[1]);
    }
  EXPECT_EQ(objectives[0]["best"]["value"], *std::max_element(distances.begin(), distances.end()));
  EXPECT_EQ(objectives[1]["best"]["value"], *std::min_element(works.begin(), works.end()));
  const auto best = objectives[1]["best"]["individual"].get<std::uint32_t>();
  EXPECT_EQ(archive_.known_individual(best).result.objectives[1], objectives[1]["best"]["value"]);
}

TEST_F(RunJson, HasTheBestSoFarOfEachGenerationInWhichItChanged) {
  std::vector<std::uint32_t> ids;
  double best = -std::numeric_limits<double>::infinity();
  for (std::uint32_t g = 0; g < population_.size(); ++g) {
    std::optional<std::uint32_t> better;
    for (std::uint32_t id = 0; id < 24; ++id)
      if (const auto one = archive_.known_individual(id);
          one.born == g && one.result.status == Status::ok && one.result.objectives[0] > best) {
        best = one.result.objectives[0];
        better = id;
      }
    if (better) ids.push_back(*better);
  }
  ASSERT_GT(ids.size(), 1u);
  std::vector<std::uint32_t> found;
  for (const BestSoFar& one : best_over_generations(archive_)) {
    found.push_back(one.individual);
    EXPECT_EQ(one.born, archive_.known_individual(one.individual).born);
    EXPECT_EQ(one.value, archive_.known_individual(one.individual).result.objectives[0]);
  }
  EXPECT_EQ(found, ids);
}

TEST_F(RunJson, NamesTheScoresThatAreNotObjectives) {
  const Json measures = run_json(archive_, experiment_)["measures"];
  ASSERT_EQ(measures.size(), 1u);
  EXPECT_EQ(measures[0].dump(), R"({"name":"stature","unit":"m","role":"descriptor"})");
}

TEST_F(RunJson, AReportShowsTheBestElites) {
  const auto ids = best_elites(niche_map(archive_), 2);
  ASSERT_EQ(ids.size(), 2u);
  const Json run = reported_run(archive_, experiment_, *simulator_,
                                {.best = 1, .best_of_others = 0, .ancestors = 0, .elites = 2}, 1'000'000);
  ASSERT_EQ(run["robots"].size(), 2u) << "the best is an elite, too";
  EXPECT_EQ(run["robots"][0]["role"], "best in distance");
  EXPECT_EQ(run["robots"][0]["individual"], ids[0]);
  EXPECT_EQ(run["robots"][1]["role"], "elite");
  EXPECT_EQ(run["robots"][1]["individual"], ids[1]);
  EXPECT_FALSE(run["robots"][1]["film"]["shots"].empty());
}

TEST_F(RunJson, AReportShowsTheLineOfTheBestFromItsFounder) {
  Individual child = archive_.known_individual(archive_.best(1).at(0));
  const std::uint32_t founder = child.id;
  std::vector<std::uint32_t> line;
  for (std::uint32_t generation = archive_.generations().back().generation + 1; line.size() < 4; ++generation) {
    child.parents = {child.id};
    child.id = 24 + static_cast<std::uint32_t>(line.size());
    child.born = generation;
    child.result.objectives[0] += 1;  // better than all before
    archive_.commit({child}, {}, {}, {.generation = generation, .evaluations = child.id + 1});
    line.push_back(child.id);
  }
  const auto shown = [&](std::size_t ancestors) {
    std::vector<std::pair<std::uint32_t, std::string>> robots;
    const Json run = reported_run(archive_, experiment_, *simulator_,
                                  {.best = 1, .best_of_others = 0, .ancestors = ancestors, .elites = 0}, 1'000'000);
    for (const Json& robot : run["robots"]) robots.emplace_back(robot["individual"], robot["role"]);
    return robots;
  };
  using ::testing::Pair;
  EXPECT_THAT(shown(4), ElementsAre(Pair(line[3], "best in distance"), Pair(founder, "founder"),
                                    Pair(line[0], "ancestor"), Pair(line[1], "ancestor"), Pair(line[2], "ancestor")));
  EXPECT_THAT(shown(2),
              ElementsAre(Pair(line[3], "best in distance"), Pair(founder, "founder"), Pair(line[1], "ancestor")));
}

TEST_F(RunJson, AReportHasTheScoresOfTheLivingAndTheBestInEachObjective) {
  const Json run = reported_run(archive_, experiment_, *simulator_, {.best = 1, .ancestors = 0}, 1'000'000, 1);
  EXPECT_EQ(run["filmed_scenario"], "hurt");
  ASSERT_EQ(run["population"].size(), living(population_.size() - 1, 0).size());
  for (const Json& one : run["population"]) {
    const auto id = one["id"].get<std::uint32_t>();
    EXPECT_EQ(one["objectives"]["actuation-work"], archive_.known_individual(id).result.objectives[1]);
    EXPECT_EQ(one["measures"]["stature"], archive_.measures(id)[0].value);
  }
  std::vector<std::string> roles;
  std::vector<Json> shown;
  for (const Json& robot : run["robots"]) {
    roles.push_back(robot["role"]);
    shown.push_back(robot["individual"]);
  }
  EXPECT_THAT(roles, ElementsAre("best in distance", "best in actuation-work"));
  EXPECT_THAT(shown, ElementsAre(archive_.best(1).at(0), run["objectives"][1]["best"]["individual"]));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
