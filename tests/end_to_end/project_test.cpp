// The projects that `evodevo new` writes. OutsidePlugin builds them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <fstream>
#include <set>
#include <sstream>

#include "support/messages.hpp"
#include "support/program.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using namespace testing;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

class NewProject : public ::testing::Test {
 protected:
  Scratch scratch_;

  /// Calls `evodevo new` in the scratch folder.
  std::string create(const Words& words, int exit_code = 0) const {
    return output_of(joined({"sh", "-c", "cd \"$1\" && shift && exec \"$@\"", "sh", (scratch_ / "").string(),
                             EVODEVO_PROGRAM, "new"},
                            words),
                     exit_code);
  }
  std::set<std::string> files(const fs::path& folder) const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(scratch_ / folder)) names.insert(entry.path().filename().string());
    return names;
  }
  std::string content(const fs::path& file) const {
    std::ifstream stream(scratch_ / file);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
};

/// Returns the names of the operators in a list of tables.
Words names_in(const toml::node_view<const toml::node> tables) {
  Words names;
  for (const toml::node& table : *tables.as_array()) names.push_back(**table.as_table()->get_as<std::string>("name"));
  return names;
}

TEST_F(NewProject, ForOneOperatorOfEachKindHasOneSource) {
  for (const std::string kind : {"encoding", "mutation", "crossover", "devo", "fitness", "selection"}) {
    const std::string name = "lab." + kind;
    create({kind, name});
    EXPECT_THAT(files(name), UnorderedElementsAre("CMakeLists.txt", "README.md", "experiment.toml", kind + ".cpp"));
    for (const std::string& file : files(name))
      EXPECT_THAT(content(fs::path(name) / file), ::testing::Not(::testing::ContainsRegex("@[A-Za-z]"))) << file;
    EXPECT_EQ(toml::parse(content(name + "/experiment.toml")).contains("development"), kind == "devo");
  }
}

TEST_F(NewProject, WithSeveralOperatorsUsesAllInOneExperiment) {
  create({"devo", "lab.growth", "fitness", "lab.height", "devo", "other.late-growth", "mutation", "lab.drift",
          "fitness", "width", "encoding", "lab.cloud", "crossover", "lab.mix", "selection", "lab.best"});
  EXPECT_THAT(files(""), UnorderedElementsAre("lab.growth"));
  EXPECT_THAT(files("lab.growth"),
              UnorderedElementsAre("CMakeLists.txt", "README.md", "experiment.toml", "growth.cpp", "height.cpp",
                                   "late_growth.cpp", "drift.cpp", "width.cpp", "cloud.cpp", "mix.cpp", "best.cpp"));
  const toml::table experiment = toml::parse(content("lab.growth/experiment.toml"));
  const toml::node_view<const toml::node> root(experiment);
  EXPECT_EQ(names_in(root["development"]["operator"]), (Words{"lab.growth", "other.late-growth"}));
  EXPECT_EQ(names_in(root["fitness"]), (Words{"lab.height", "width"}));
  EXPECT_EQ(names_in(root["mutation"]), (Words{"lab.drift"}));
  EXPECT_EQ(names_in(root["crossover"]), (Words{"lab.mix"}));
  EXPECT_EQ(root["encoding"]["name"].value<std::string>(), "lab.cloud");
  EXPECT_EQ(root["selection"]["name"].value<std::string>(), "lab.best");
  EXPECT_THAT(content("lab.growth/README.md"),
              ::testing::HasSubstr("`lab.mix` (crossover) and `lab.best` (selection)"));
}

TEST_F(NewProject, NamesWhatCannotBeInOneProjectAndTouchesNoFolderThatExists) {
  const auto refused = [&](const Words& words, const auto& message) {
    EXPECT_THAT(create(words, 2), message);
    EXPECT_THAT(files(""), IsEmpty()) << "nothing is written";
  };
  refused({"encoding", "lab.a", "devo", "lab.b", "encoding", "lab.c"},
          at_place("evodevo: new encoding lab.c: ", "lab.a", "create lab.c in a project of its own"));
  refused({"selection", "a", "selection", "b"}, at_place("evodevo: new selection b: ", "a project of its own"));
  refused({"devo", "lab.a", "fitness", "lab.a"}, at_place("evodevo: new fitness lab.a: ", "another name"));
  refused({"devo", "lab.a-b", "devo", "other.a-b"},
          at_place("evodevo: new devo other.a-b: ", "a_b.cpp", "AB", "lab.a-b", "give a name"));
  refused({"devo", "lab.a", "fitness"}, at_place("evodevo: new fitness: ", "give a kind and a name"));
  refused({"devo", "lab.a", "fitnes", "b"}, at_place("evodevo: new fitnes: ", "\"fitness\""));
  refused({"devo", "lab.a", "fitness", "B"}, at_place("evodevo: new B: ", "my-lab.growth"));
  refused({"devo"}, naming("NAME is missing", "usage: evodevo new KIND NAME"));
  fs::create_directory(scratch_ / "lab.a");
  EXPECT_THAT(create({"devo", "lab.a", "fitness", "lab.b"}, 2), at_place("evodevo: lab.a: ", "give another name"));
  EXPECT_THAT(files("lab.a"), IsEmpty());
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
