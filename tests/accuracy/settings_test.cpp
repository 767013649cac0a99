// The studies' command line.
#include "settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "studies.hpp"

namespace evodevo::accuracy {
namespace {

using testing::HasSubstr;

std::optional<Settings> parsed(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "evodevo-accuracy");
  return parse(static_cast<int>(arguments.size()), arguments.data());
}

std::string complaint(const std::vector<const char*>& arguments) {
  try {
    parsed(arguments);
    return "";
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

TEST(AccuracySettings, NameTheCommandThatRepeatsThem) {
  const auto settings = parsed({"charts", "--quick", "--study", "orders", "--study", "beam"});
  EXPECT_EQ(settings->command, "tools/accuracy charts --quick --study orders --study beam");
  EXPECT_EQ(settings->folder, "charts");
  EXPECT_THAT(settings->studies, testing::ElementsAre("orders", "beam"));
  EXPECT_EQ(parsed({"charts"})->studies.size(), studies.size());
}

TEST(AccuracySettings, RefuseWhatCannotBeStudied) {
  EXPECT_THAT(complaint({"--quick"}), HasSubstr("name the folder"));
  EXPECT_THAT(complaint({"charts", "--study", "order"}), HasSubstr("\"order\" is none of work-precision, beam"));
  EXPECT_THAT(complaint({"charts", "--device", "gpu"}), HasSubstr("\"gpu\" is none of cpu, cuda"));
  EXPECT_THAT(complaint({"charts", "--robots", "3"}), HasSubstr("at least 20"));
}

}  // namespace
}  // namespace evodevo::accuracy
