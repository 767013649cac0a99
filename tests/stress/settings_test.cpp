// The command line of tools/stress.
#include "stress/settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "../common/help.hpp"

namespace evodevo::tools::stress::EVODEVO_FILE {
namespace {

using ::testing::ElementsAre;

TEST(StressSettings, AreReadAndNameTheCommandThatRepeatsThem) {
  const Settings settings = parse({"charts", "a.toml", "b.toml", "--quick", "--device", "cpu"});
  EXPECT_EQ(settings.command, "tools/stress charts a.toml b.toml --quick --device cpu");
  EXPECT_EQ(settings.folder, "charts");
  EXPECT_THAT(settings.experiments, ElementsAre("a.toml", "b.toml"));
  EXPECT_EQ(settings.robots, 4u);
  const Settings standard = parse({"charts"});
  EXPECT_THAT(standard.experiments, ElementsAre("experiments/evo-devo.toml", "experiments/swimmer.toml"));
  EXPECT_EQ(standard.robots, 100u);
  for (const CommandLine& line :
       {CommandLine{"a.toml"}, CommandLine{"charts", "--robots", "0"}, CommandLine{"charts", "--robots", "-1"}})
    EXPECT_THROW(parse(line), std::invalid_argument);
}

TEST(StressSettings, AreDescribedByTheHelp) {
  Settings settings;
  expect_page_of_options(program, options(settings), {"folder", "experiment"});
}

}  // namespace
}  // namespace evodevo::tools::stress::EVODEVO_FILE
