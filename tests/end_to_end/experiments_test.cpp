// Every experiment of the project runs. ReadmeRun tests what the robots of the quickstart learn.
#include "support/experiments.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <tuple>

#include "evolution/islands/island_folders.hpp"
#include "support/process.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;

std::string experiment_file(const std::string& name) { return std::string(EVODEVO_EXPERIMENTS) + "/" + name; }

TEST(Experiments, EachRunsForTwoGenerationsWhenShrunk) {
  const testing::Scratch scratch;
  int count = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(EVODEVO_EXPERIMENTS)) {
    if (entry.path().extension() != ".toml") continue;
    SCOPED_TRACE(entry.path());
    const std::string folder = (scratch / std::to_string(count++)).string();
    std::vector<std::string> command = {EVODEVO_PROGRAM, "run", entry.path(), "--out", folder};
    for (const std::string& set : testing::shrinking(entry.path())) command.insert(command.end(), {"--set", set});
    const testing::Finished finished = testing::run(command);
    ASSERT_EQ(finished.exit_code, 0) << finished.output;
    for (const fs::path& place : archive_folders(folder)) {
      const Archive archive = Archive::read(place);
      EXPECT_EQ(archive.generations().size(), 2u);
      EXPECT_GT(archive.statuses().at("ok"), 0);
    }
  }
  EXPECT_EQ(count, 54);
}

TEST(Experiments, TheEnvironmentsDifferInTheirSceneAlone) {
  const auto without_scene = [](const Experiment& experiment) {
    const std::string& text = experiment.resolved;
    return text.substr(0, text.find("[scene")) + text.substr(text.find("\n[selection"));
  };
  const Experiment flat = read_experiment({experiment_file("environments/flat.toml"), {}});
  std::set<std::string> scenes;
  for (const fs::directory_entry& entry : fs::directory_iterator(experiment_file("environments"))) {
    SCOPED_TRACE(entry.path());
    const Experiment experiment = read_experiment({entry.path(), {}});
    EXPECT_EQ(without_scene(experiment), without_scene(flat));
    EXPECT_TRUE(scenes.insert(experiment.resolved).second) << "as another one";
  }
}

/// Compares all values that the paper gives.
TEST(Experiments, PaperHoldsThePapersValues) {
  const Experiment paper = read_experiment({experiment_file("paper.toml"), {}});
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

TEST(Experiments, EvoAndEvoDevoDifferInDevelopmentAlone) {
  EXPECT_EQ(rest_of(read_experiment({experiment_file("evo.toml"), {}})),
            rest_of(read_experiment({experiment_file("evo-devo.toml"), {}})));
  EXPECT_EQ(read_experiment({experiment_file("evo.toml"), {}}).development.cycles, 0);
  EXPECT_GT(read_experiment({experiment_file("evo-devo.toml"), {}}).development.cycles, 0);
}

/// Returns the settings that must be the same for all experiments of a study.
std::tuple<std::string, std::int64_t, std::int64_t, double, std::int64_t> terms(const Experiment& experiment) {
  return {rest_of(experiment), experiment.population, experiment.random_individuals, experiment.spring_evaluations,
          experiment.evaluations};
}

TEST(Experiments, TheStudiesOfDevelopmentDifferInDevelopmentAlone) {
  for (const fs::path study : {experiment_file("study/neural"), experiment_file("study/voxel")}) {
    const Experiment evo = read_experiment({study / "evo.toml", {}});
    EXPECT_GT(evo.spring_evaluations, 0);
    EXPECT_EQ(evo.development.cycles, 0);
    const Experiment sized = read_experiment({study / "evo.toml", {{"encoding.size_range", "0.25", ""}}});
    for (const fs::directory_entry& entry : fs::directory_iterator(study)) {
      const bool ballistic = entry.path().filename() == "ballistic.toml";  // ballistic growth needs genes for sizes
      EXPECT_EQ(terms(read_experiment({entry.path(), {}})), terms(ballistic ? sized : evo)) << entry.path();
    }
  }
  EXPECT_EQ(rest_of(read_experiment({experiment_file("study/neural/evo.toml"), {}})),
            rest_of(read_experiment({experiment_file("evo.toml"), {}})));
}

TEST(Experiments, TheArmsOfThePlannedStudyDifferInDevelopmentAlone) {
  const fs::path study = experiment_file("study/development");
  const Experiment evo = read_experiment({study / "evo.toml", {}});
  const Experiment sized = read_experiment({study / "evo.toml", {{"encoding.size_range", "0.6", ""}}});
  EXPECT_EQ(evo.development.cycles, 0);
  int arms = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(study)) {
    if (entry.path().extension() != ".toml") continue;
    SCOPED_TRACE(entry.path());
    Experiment arm = read_experiment({entry.path(), {}});
    const std::string name = arm.name;
    if (name == "random-search") {
      EXPECT_EQ(arm.random_individuals, arm.newborns());
      arm.random_individuals = evo.random_individuals;
    }
    EXPECT_EQ(terms(arm), terms(name == "ballistic" || name == "sized" ? sized : evo));
    ++arms;
  }
  EXPECT_EQ(arms, 9);
}

TEST(Experiments, TheArmsOfThePublishedResultDifferInDevelopmentAlone) {
  const fs::path folder = experiment_file("published/kriegman-2018");
  const Experiment evo = read_experiment({folder / "evo.toml", {}});
  // without development there is one size and one phase, so that there are half as many maps of genes
  const std::vector<Override> still{
      {"encoding.grows", "false", ""}, {"mutation.0.share", "0.5", ""}, {"fitness.0.developing", "false", ""}};
  const Experiment devo = read_experiment({folder / "evo-devo.toml", {}});
  EXPECT_EQ(terms(read_experiment({folder / "evo-devo.toml", still})), terms(evo));
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
  const Experiment evo = read_experiment({experiment_file("evo.toml"), {}});
  std::set<std::string> selections;
  for (const fs::directory_entry& entry : fs::directory_iterator(experiment_file("study/selection"))) {
    SCOPED_TRACE(entry.path());
    const Experiment experiment = read_experiment({entry.path(), {}});
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
  for (const std::string study : {"study/neural/", "study/development/"}) {
    const Experiment developed = read_experiment({experiment_file(study + "evo-devo.toml"), {}});
    for (const std::string control : {"no-change", "random-places", "shuffled-stress"}) {
      std::string text = read_experiment({experiment_file(study + control + ".toml"), {}}).resolved;
      const std::string line = "control = '" + control + "'";
      ASSERT_NE(text.find(line), std::string::npos) << text;
      text.replace(text.find(line), line.size(), "control = 'off'");
      EXPECT_EQ(text, developed.resolved);
    }
  }
}

TEST(Experiments, TheStudysEndAtTheSameCost) {
  constexpr double cost = 1e7;
  const testing::Scratch scratch;
  for (const fs::directory_entry& entry : fs::directory_iterator(experiment_file("study/neural"))) {
    SCOPED_TRACE(entry.path());
    const std::string folder = (scratch / entry.path().stem().string()).string();
    std::vector<std::string> command = {EVODEVO_PROGRAM, "run", entry.path(), "--out", folder};
    std::vector<std::string> shrunk = {"experiment.spring_evaluations=1e7", "experiment.population=4",
                                       "encoding.points=60", "fitness.0.settle=0.1", "fitness.0.window=0.1"};
    if (entry.path().stem() != "evo")
      shrunk.insert(shrunk.end(), {"development.cycles=2", "development.cycle_time=0.1"});
    for (const std::string& set : shrunk) command.insert(command.end(), {"--set", set});
    const testing::Finished finished = testing::run(command);
    ASSERT_EQ(finished.exit_code, 0) << finished.output;
    double before = 0, spent = 0;
    for (const Summary& generation : Archive::read(folder).generations()) {
      before = spent;
      spent += static_cast<double>(generation.spring_evaluations);
    }
    EXPECT_LT(before, cost) << "one generation more than needed";
    EXPECT_GE(spent, cost);
  }
}

TEST(Experiments, WalkersThatCreepSettleTenSeconds) {
  for (const char* name : {"evo.toml", "evo-devo.toml", "growth.toml"})
    EXPECT_EQ(read_experiment({experiment_file(name), {}}).fitness.at(0).op->observes().settle, 10) << name;
  const Experiment swimmer = read_experiment({experiment_file("swimmer.toml"), {}});
  EXPECT_EQ(swimmer.fitness.at(0).op->observes().settle, 0);
  EXPECT_TRUE(swimmer.scene.drag.has_value());
  EXPECT_FALSE(swimmer.scene.floor || swimmer.scene.damping);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
