// The command line of the studies.
#include "accuracy/settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "../common/help.hpp"
#include "studies.hpp"

namespace evodevo::tools::accuracy::EVODEVO_FILE {
namespace {

using ::testing::HasSubstr;

std::string complaint(const CommandLine& line) { return complaint_about(parse, line); }

TEST(AccuracySettings, NameTheCommandThatRepeatsThem) {
  const Settings settings = parse({"charts", "--quick", "--study", "orders", "--study", "beam"});
  EXPECT_EQ(settings.command, "tools/accuracy charts --quick --study orders --study beam");
  EXPECT_EQ(settings.folder, "charts");
  EXPECT_THAT(settings.studies, ::testing::ElementsAre("orders", "beam"));
  EXPECT_EQ(parse({"charts"}).studies.size(), studies.size());
}

TEST(AccuracySettings, RefuseWhatCannotBeStudied) {
  EXPECT_THAT(complaint({"--quick"}), HasSubstr("name the folder"));
  EXPECT_THAT(complaint({"charts", "--study", "order"}),
              AllOf(HasSubstr("\"order\""), HasSubstr("work-precision, beam")));
  EXPECT_THAT(complaint({"charts", "--device", "gpu"}), AllOf(HasSubstr("\"gpu\""), HasSubstr("cpu, cuda")));
  EXPECT_THAT(complaint({"charts", "--robots", "3"}), HasSubstr("at least 20"));
  EXPECT_THAT(complaint({"charts", "--robots", "-1"}), HasSubstr("--robots -1"));
  EXPECT_THAT(complaint({"charts", "--threads=-2"}), HasSubstr("--threads -2"));
}

TEST(AccuracySettings, AreDescribedByTheHelp) {
  Settings settings;
  expect_page_of_options(program, options(settings), {"folder"});
}

}  // namespace
}  // namespace evodevo::tools::accuracy::EVODEVO_FILE
