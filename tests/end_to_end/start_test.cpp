// Runs that begin with the population of another run.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "archive/archive.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/program.hpp"
#include "support/runs.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using namespace testing;

class Start : public ::testing::Test {
 protected:
  Start() { output_of(run("home", {})); }

  std::string path(const std::string& folder) const { return (scratch_ / folder).string(); }
  /// Returns the command that runs the small experiment into a folder, with values for keys.
  Words run(const std::string& folder, const Words& values) const {
    return joined(program({"run", file_, "--no-report", "--out", path(folder)}), setting(values));
  }

  /// Returns the individuals of a run that were born in its first generation.
  std::vector<Individual> first_born(const std::string& folder) const {
    const Archive archive = Archive::read(scratch_ / folder);
    std::vector<Individual> born;
    for (std::uint32_t id = 0; archive.individual(id) && archive.individual(id)->born == 0; ++id)
      born.push_back(*archive.individual(id));
    return born;
  }

  Scratch scratch_;
  std::string file_ = scratch_.write("small.toml", small_experiment);
  std::string start_ = "experiment.start=\"home\"";  // relative to the file
};

TEST_F(Start, ThePopulationIsBornAgainInAnotherScene) {
  EXPECT_THAT(said({"check", file_, "--set", start_}), naming("6", (scratch_ / "home").lexically_normal().string()));
  output_of(run("away", {start_, "experiment.seed=8", "scene.friction.coefficient=0.1", "experiment.children=9",
                         "experiment.evaluations=23"}));
  const std::vector<Individual> home = Archive::read(scratch_ / "home").population(), away = first_born("away");
  ASSERT_EQ(away.size(), 9u);
  ASSERT_EQ(home.size(), 6u);
  for (std::size_t i = 0; i < away.size(); ++i) {
    EXPECT_EQ(away[i].origin, 0u);
    EXPECT_TRUE(away[i].parents.empty());
    if (i >= home.size()) {
      EXPECT_EQ(away[i].made_by, "random");
      EXPECT_FALSE(away[i].migrated);
      continue;
    }
    EXPECT_EQ(away[i].made_by, "start");
    EXPECT_EQ(away[i].genome, home[i].genome);
    EXPECT_EQ(away[i].migrated, (Migrated{0, home[i].id}));
  }
  const auto is_same = [](const Individual& a, const Individual& b) {
    return a.result.objectives == b.result.objectives;
  };
  EXPECT_FALSE(std::ranges::equal(home, std::span(away).first(6), is_same)) << "they are measured in the new scene";

  // the seed of development goes with them: in the same scene they live the same lives, whatever the run's seed
  output_of(run("again", {start_, "experiment.seed=8"}));
  EXPECT_TRUE(std::ranges::equal(home, first_born("again"), is_same));
  output_of(run("otherwise", {start_, "experiment.seed=8", "development.seed=9"}));
  EXPECT_FALSE(std::ranges::equal(home, first_born("otherwise"), is_same)) << "unless another one is given";
}

TEST_F(Start, IfThereIsNotRoomForAllTheBestComeAndFoundersAreNoImmigrants) {
  output_of(run("small", {start_, "experiment.population=4", "experiment.children=4"}));
  const Archive home = Archive::read(scratch_ / "home");
  std::vector<std::uint32_t> best = home.best(100), living;
  for (const Individual& one : home.population()) living.push_back(one.id);
  std::erase_if(best, [&](std::uint32_t id) { return std::ranges::find(living, id) == living.end(); });
  ASSERT_GE(best.size(), 4u);
  best.resize(4);
  std::ranges::sort(best);
  std::vector<std::uint32_t> came;
  for (const Individual& one : first_born("small")) came.push_back(one.migrated->individual);
  EXPECT_EQ(came, best);

  output_of(run("islands", {start_, "islands.count=2", "islands.every=1", "islands.migrants=3",
                            "islands.emigrants=\"random\"", "experiment.evaluations=132"}));
  said({"show", path("islands")});
  const std::string island = path("islands/island-2");
  const Archive archive = Archive::read(island);
  const Individual founder = *archive.individual(0);
  EXPECT_EQ(founder.migrated->island, 0);
  for (const Immigrant& one : archive.immigrants()) EXPECT_EQ(one.from.island, 1);
  EXPECT_FALSE(archive.immigrants().empty()) << "children of founders have migrated";
  EXPECT_THAT(said({"show", island, "--individual", "0"}),
              naming("start", std::to_string(founder.migrated->individual)));
}

TEST_F(Start, ARunThatIsInterruptedAfterwardsNeedsTheOtherRunNoMore) {
  const Words values{start_, "experiment.evaluations=600"};
  output_of(run("straight", values));
  Process process(run("killed", values));
  for (int line = 0; line < 3; ++line) process.read_line();  // its folder, and two generations
  process.send(SIGKILL);
  process.wait();
  const std::size_t done = Archive::read(path("killed")).generations().size();
  ASSERT_GE(done, 1u);
  ASSERT_LT(done, Archive::read(path("straight")).generations().size()) << "it was done before it could be killed";
  std::filesystem::remove_all(path("home"));
  said({"resume", "--no-report", path("killed")});
  expect_same_runs(Archive::read(path("straight")), Archive::read(path("killed")));
}

TEST_F(Start, WhatCannotBeBornAgainIsRefusedBeforeAnythingIsWritten) {
  const auto refusal = [&](const Words& values) {
    testing::refusal(joined({"check", file_}, setting(values)));
    const std::string output = output_of(run("refused", values), 2);
    EXPECT_FALSE(std::filesystem::exists(path("refused")));
    return output;
  };
  EXPECT_THAT(refusal({"experiment.start=\"elsewhere\""}),
              naming("experiment.start: " + (scratch_ / "elsewhere").lexically_normal().string()));
  EXPECT_THAT(refusal({start_, "encoding.size=[3, 1, 1]"}), naming("experiment.start", "encoding"));
  std::filesystem::copy(path("home"), path("damaged"));
  SQLite::Database(path("damaged/run.sqlite"), SQLite::OPEN_READWRITE)
      .exec("UPDATE individuals SET genes = substr(genes, 1, length(genes) - 4)");
  EXPECT_THAT(refusal({"experiment.start=\"damaged\""}),
              naming("experiment.start", "damaged", "individual ", "undamaged copy"));

  std::string text = small_experiment;
  const std::size_t begin = text.find("[encoding]"), end = text.find("[scene.gravity]");
  text.replace(begin, end - begin, "[encoding]\nname = \"neural\"\npoints = 9\n");
  file_ = scratch_.write("without-variation.toml", text);
  EXPECT_THAT(refusal({start_, "selection.name=\"cma-es\"", "experiment.random_individuals=0"}),
              naming("experiment.start", "cma-es"));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
