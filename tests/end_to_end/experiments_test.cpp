// Every experiment of the project runs. ReadmeRun tests what the robots of the quickstart learn.
#include "support/experiments.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <tuple>

#include "archive/island_folders.hpp"
#include "support/program.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using namespace testing;

const fs::path experiments = EVODEVO_EXPERIMENTS;

Experiment read(const fs::path& file, std::vector<Override> overrides = {}) {
  return read_experiment({experiments / file, std::move(overrides)});
}

TEST(Experiments, EachRunsForTwoGenerationsWhenShrunk) {
  const Scratch scratch;
  int count = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(experiments)) {
    if (entry.path().extension() != ".toml") continue;
    SCOPED_TRACE(entry.path());
    const std::string folder = (scratch / std::to_string(count++)).string();
    Words settings = testing::shrinking(entry.path());
    settings.push_back("experiment.verify_front=off");  // in so short a life robots only fall, which needs no muscles
    said(joined({"run", entry.path(), "--out", folder}, setting(settings)));
    for (const fs::path& place : archive_folders(folder)) {
      const Archive archive = Archive::read(place);
      EXPECT_EQ(archive.generations().size(), 2u);
      EXPECT_GT(archive.statuses().at("ok"), 0);
    }
  }
  EXPECT_EQ(count, 67);
}

TEST(Experiments, TheEnvironmentsDifferInTheirSceneAlone) {
  const auto without_scene = [](const Experiment& experiment) {
    const std::string& text = experiment.resolved;
    return text.substr(0, text.find("[scene")) + text.substr(text.find("\n[selection"));
  };
  const Experiment flat = read("environments/flat.toml");
  std::set<std::string> scenes;
  for (const fs::directory_entry& entry : fs::directory_iterator(experiments / "environments")) {
    SCOPED_TRACE(entry.path());
    const Experiment experiment = read(entry.path());
    EXPECT_EQ(without_scene(experiment), without_scene(flat));
    EXPECT_TRUE(scenes.insert(experiment.resolved).second) << "as another one";
  }
}

/// Compares all values that the paper gives.
TEST(Experiments, PaperHoldsThePapersValues) {
  const Experiment paper = read("paper.toml");
  EXPECT_EQ(paper.development.cycles, 100);
  EXPECT_EQ(paper.development.cycle_time, 1);
  EXPECT_EQ(paper.step.dt, 0.0005);
  EXPECT_EQ(paper.scene.floor->stiffness, 1e6);
  EXPECT_EQ(paper.scene.friction->coefficient, 0.5);
  EXPECT_EQ(paper.scene.gravity->acceleration, 9.81);
  EXPECT_NEAR(std::exp(-paper.scene.damping->rate * 0.0005), 0.99, 1e-12);
  EXPECT_EQ(paper.evaluations, 10000);
  const Request request = paper.fitness.at(0).op->observes();
  EXPECT_EQ(request.settle, 3);
  EXPECT_EQ(request.window, 10);
  EXPECT_EQ(paper.layout.first_size(), 100u + 650u + 208u) << "a 3-25-25-8 network";
  for (const char* line : {"springs = 125", "neighbours = 25", "threshold = 20", "points = 1000"})
    EXPECT_NE(paper.resolved.find(line), std::string::npos) << line;
}

/// Returns the resolved text of an experiment without [development] and [experiment].
std::string rest_of(const Experiment& experiment) {
  const std::string& text = experiment.resolved;
  const std::size_t encoding = text.find("[encoding]"), own = text.find("[experiment]");  // in alphabetical order
  return text.substr(encoding, own - encoding) + text.substr(text.find("\n[", own));
}

/// Returns the settings that must be the same for all experiments of a study.
std::tuple<std::string, std::int64_t, std::int64_t, double, std::int64_t> terms(const Experiment& experiment) {
  return {rest_of(experiment), experiment.population, experiment.random_individuals, experiment.spring_evaluations,
          experiment.evaluations};
}

TEST(Experiments, TheArmsOfAStudyOfDevelopmentDifferInDevelopmentAlone) {
  int arms = 0;
  for (const auto& [study, size_range] : {std::pair{"study/neural", "0.25"},
                                          {"study/voxel", "0.25"},
                                          {"study/development", "0.6"},
                                          {"study/inheritance", "0.6"}}) {
    const fs::path folder = experiments / study;
    const Experiment evo = read(folder / "evo.toml");
    const Experiment sized = read(folder / "evo.toml", {{"encoding.size_range", size_range, ""}});
    EXPECT_GT(evo.spring_evaluations, 0);
    EXPECT_EQ(evo.development.cycles, 0);
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      if (entry.path().extension() != ".toml") continue;
      SCOPED_TRACE(entry.path());
      Experiment arm = read(entry.path());
      const std::string name = entry.path().stem();
      if (name.starts_with("random-search")) {
        EXPECT_EQ(arm.random_individuals, arm.newborns());
        arm.random_individuals = evo.random_individuals;
      }
      // ballistic growth needs genes for sizes
      EXPECT_EQ(terms(arm), terms(name == "ballistic" || name == "sized" ? sized : evo));
      ++arms;
    }
  }
  EXPECT_EQ(arms, 6 + 2 + 9 + 13);
  const Experiment evo = read("evo.toml"), devo = read("evo-devo.toml");
  EXPECT_EQ(rest_of(evo), rest_of(devo));
  EXPECT_EQ(rest_of(evo), rest_of(read("study/neural/evo.toml")));
  EXPECT_EQ(evo.development.cycles, 0);
  EXPECT_GT(devo.development.cycles, 0);
}

TEST(Experiments, TheArmsOfThePublishedResultDifferInDevelopmentAlone) {
  const fs::path folder = experiments / "published/kriegman-2018";
  const Experiment evo = read(folder / "evo.toml");
  // without development there is one size and one phase, so that there are half as many maps of genes
  const std::vector<Override> still{
      {"encoding.grows", "false", ""}, {"mutation.0.share", "0.5", ""}, {"fitness.0.developing", "false", ""}};
  const Experiment devo = read(folder / "evo-devo.toml");
  EXPECT_EQ(terms(read(folder / "evo-devo.toml", still)), terms(evo));
  EXPECT_EQ(evo.development.cycles, 0);
  const Request request = devo.fitness.at(0).op->observes();
  EXPECT_NEAR(request.settle + request.window,
              static_cast<double>(devo.development.cycles) * devo.development.cycle_time, 1e-9)
      << "robots develop until the way has been measured";
  EXPECT_EQ(devo.layout.first_size(), 48u * 2 + 24 * 3 + 48) << "phases, materials and mirrored sizes, rates";
  EXPECT_EQ(evo.layout.first_size(), 48u + 24 * 2 + 48);
}

/// Returns the tables of an experiment with this name, as text.
std::string table_of(const Experiment& experiment, const std::string& name) {
  const std::string& text = experiment.resolved;
  const std::size_t begin = text.find("[" + name);
  return text.substr(begin, text.find("\n[", text.rfind("[" + name)) - begin);
}

TEST(Experiments, TheStudyOfSelectionHasTheRobotsOfEvoAndOneBudget) {
  const Experiment evo = read("evo.toml");
  std::set<std::string> selections;
  for (const fs::directory_entry& entry : fs::directory_iterator(experiments / "study/selection")) {
    SCOPED_TRACE(entry.path());
    const Experiment experiment = read(entry.path());
    EXPECT_EQ(table_of(experiment, "encoding"), table_of(evo, "encoding"));
    EXPECT_EQ(table_of(experiment, "scene."), table_of(evo, "scene."));
    EXPECT_EQ(std::tuple(experiment.evaluations, experiment.population, experiment.newborns()),
              std::tuple(5000, 100, 100));
    EXPECT_EQ(experiment.objectives.front().name, "distance");
    EXPECT_EQ(experiment.measures.at(0).high, 2);
    EXPECT_EQ(experiment.measures.at(1).high, 0.5);
    const std::string random = experiment.random_individuals > 1 ? "random" : "";
    EXPECT_TRUE(selections.insert(random + table_of(experiment, "selection")).second) << "as another one";
  }
  EXPECT_EQ(selections.size(), 7u);
}

TEST(Experiments, TheControlsOfStudiesDifferInTheControlAlone) {
  for (const auto& [study, developing] : {std::pair{"study/neural/", "evo-devo.toml"},
                                          {"study/development/", "evo-devo.toml"},
                                          {"study/inheritance/", "stress.toml"}}) {
    const Experiment developed = read(std::string(study) + developing);
    for (const std::string control : {"no-change", "random-places", "shuffled-stress"}) {
      std::string text = read(std::string(study) + control + ".toml").resolved;
      const std::string line = "control = '" + control + "'";
      ASSERT_NE(text.find(line), std::string::npos) << text;
      text.replace(text.find(line), line.size(), "control = 'off'");
      EXPECT_EQ(text, developed.resolved);
    }
  }
}

TEST(Experiments, WalkersThatCreepSettleTenSeconds) {
  constexpr double weak_damping = 10;
  int creeping = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(experiments)) {
    if (entry.path().extension() != ".toml" || entry.path().filename() == "paper.toml") continue;
    const Experiment experiment = read(entry.path());
    if (!experiment.scene.floor || !experiment.scene.damping || experiment.scene.damping->rate < weak_damping) continue;
    ++creeping;
    EXPECT_EQ(experiment.fitness.at(0).op->observes().settle, 10) << entry.path();
  }
  EXPECT_GE(creeping, 2);
  const Experiment swimmer = read("swimmer.toml");
  EXPECT_EQ(swimmer.fitness.at(0).op->observes().settle, 0);
  EXPECT_TRUE(swimmer.scene.drag.has_value());
  EXPECT_FALSE(swimmer.scene.floor || swimmer.scene.damping);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
