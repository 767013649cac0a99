// The projects that `evodevo new` writes. OutsidePlugin builds them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <fstream>
#include <set>
#include <sstream>

#include "support/messages.hpp"
#include "support/process.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using testing::Finished;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;
using Words = std::vector<std::string>;

class NewProject : public ::testing::Test {
 protected:
  testing::Scratch scratch_;

  /// Calls `evodevo new` in the scratch folder.
  Finished create(const Words& words) const {
    Words command = {"sh", "-c", "cd \"$1\" && shift && exec \"$@\"", "sh", (scratch_ / "").string(), EVODEVO_PROGRAM,
                     "new"};
    command.insert(command.end(), words.begin(), words.end());
    return testing::run(command);
  }
  std::set<std::string> files(const fs::path& folder) const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(scratch_ / folder)) names.insert(entry.path().filename().string());
    return names;
  }
  std::string content(const fs::path& file) const {
    std::ostringstream text;
    text << std::ifstream(scratch_ / file).rdbuf();
    return text.str();
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
    ASSERT_EQ(create({kind, name}).exit_code, 0);
    EXPECT_THAT(files(name), UnorderedElementsAre("CMakeLists.txt", "README.md", "experiment.toml", kind + ".cpp"));
    for (const std::string& file : files(name))
      EXPECT_THAT(content(fs::path(name) / file), ::testing::Not(::testing::ContainsRegex("@[A-Za-z]"))) << file;
    EXPECT_EQ(toml::parse(content(name + "/experiment.toml")).contains("development"), kind == "devo");
  }
}

TEST_F(NewProject, WithSeveralOperatorsUsesAllInOneExperiment) {
  const Finished created =
      create({"devo", "lab.growth", "fitness", "lab.height", "devo", "other.late-growth", "mutation", "lab.drift",
              "fitness", "width", "encoding", "lab.cloud", "crossover", "lab.mix", "selection", "lab.best"});
  ASSERT_EQ(created.exit_code, 0) << created.output;
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

TEST_F(NewProject, NamesWhatCannotBeInOneProject) {
  const auto refused = [&](const Words& words, const auto& message) {
    const Finished created = create(words);
    EXPECT_EQ(created.exit_code, 2);
    EXPECT_THAT(created.output, message);
    EXPECT_THAT(files(""), IsEmpty()) << "nothing is written";
  };
  refused({"encoding", "lab.a", "devo", "lab.b", "encoding", "lab.c"},
          testing::at_place("evodevo: new encoding lab.c: ", "lab.a", "create lab.c in a project of its own"));
  refused({"selection", "a", "selection", "b"},
          testing::at_place("evodevo: new selection b: ", "a project of its own"));
  refused({"devo", "lab.a", "fitness", "lab.a"}, testing::at_place("evodevo: new fitness lab.a: ", "another name"));
  refused({"devo", "lab.a-b", "devo", "other.a-b"},
          testing::at_place("evodevo: new devo other.a-b: ", "a_b.cpp", "AB", "lab.a-b", "give a name"));
  refused({"devo", "lab.a", "fitness"}, testing::at_place("evodevo: new fitness: ", "give a kind and a name"));
  refused({"devo", "lab.a", "fitnes", "b"}, testing::at_place("evodevo: new fitnes: ", "\"fitness\""));
  refused({"devo", "lab.a", "fitness", "B"}, testing::at_place("evodevo: new B: ", "my-lab.growth"));
  refused({"devo"}, testing::naming("NAME is missing", "usage: evodevo new KIND NAME"));
}

TEST_F(NewProject, DoesNotTouchAFolderThatExists) {
  fs::create_directory(scratch_ / "lab.a");
  const Finished created = create({"devo", "lab.a", "fitness", "lab.b"});
  EXPECT_EQ(created.exit_code, 2);
  EXPECT_THAT(created.output, testing::at_place("evodevo: lab.a: ", "give another name"));
  EXPECT_THAT(files("lab.a"), IsEmpty());
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
