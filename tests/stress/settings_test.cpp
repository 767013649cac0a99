// The command line of tools/stress.
#include "stress/settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "../common/help.hpp"

namespace evodevo::tools::stress::EVODEVO_FILE {
namespace {

using ::testing::ElementsAre;

TEST(StressSettings, NameTheCommandThatRepeatsThem) {
  const Settings settings = parse({"charts", "a.toml", "b.toml", "--quick", "--device", "cpu"});
  EXPECT_EQ(settings.command, "tools/stress charts a.toml b.toml --quick --device cpu");
  EXPECT_EQ(settings.folder, "charts");
  EXPECT_THAT(settings.experiments, ElementsAre("a.toml", "b.toml"));
  EXPECT_EQ(settings.robots, 4u);
}

TEST(StressSettings, HaveDefaults) {
  const Settings settings = parse({"charts"});
  EXPECT_THAT(settings.experiments, ElementsAre("experiments/evo-devo.toml", "experiments/swimmer.toml"));
  EXPECT_EQ(settings.robots, 100u);
}

TEST(StressSettings, RefuseWhatCannotBeStudied) {
  EXPECT_THROW(parse({"a.toml"}), std::invalid_argument);
  EXPECT_THROW(parse({"charts", "--robots", "0"}), std::invalid_argument);
  EXPECT_THROW(parse({"charts", "--robots", "-1"}), std::invalid_argument);
}

TEST(StressSettings, AreDescribedByTheHelp) {
  Settings settings;
  expect_page_of_options(program, options(settings), {"folder", "experiment"});
}

}  // namespace
}  // namespace evodevo::tools::stress::EVODEVO_FILE
