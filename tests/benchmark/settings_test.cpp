// The benchmark's command line.
#include "settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace evodevo::benchmark {
namespace {

using testing::HasSubstr;

std::optional<Settings> parsed(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "evodevo-bench");
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

TEST(Settings, NameTheCommandThatRepeatsThem) {
  EXPECT_EQ(parsed({"--json", "--body", "cube10", "--runs=3"})->command, "tools/bench --body cube10 --runs=3");
}

TEST(Settings, NameTheMethod) {
  EXPECT_EQ(parsed({})->stepping().method, Method::paper_euler);
  EXPECT_EQ(parsed({"--method", "implicit"})->stepping().method, Method::implicit);
}

TEST(Settings, RefuseWhatCannotBeMeasured) {
  EXPECT_THAT(complaint({"--study", "speeed"}), HasSubstr("\"speeed\" is none of speed, features"));
  EXPECT_THAT(complaint({"--study", "baselines"}), HasSubstr("--device cuda"));
  EXPECT_THAT(complaint({"--study", "features", "--robots", "some.toml"}), HasSubstr("--robots"));
  EXPECT_THAT(complaint({"--bodies", "0"}), HasSubstr("bodies from 1 to 65535"));
  EXPECT_THAT(complaint({"--method", "rk5"}), HasSubstr("\"rk5\" is none of paper-euler, "));
  EXPECT_THAT(complaint({"--study", "materials"}), HasSubstr("add --device cuda"));
#ifdef EVODEVO_CUDA
  EXPECT_THAT(complaint({"--study", "stress", "--device", "cuda", "--method", "rk4"}), HasSubstr("leave --method out"));
  EXPECT_THAT(complaint({"--study", "materials", "--device", "cuda", "--method", "xpbd"}),
              HasSubstr("another --method"));
  EXPECT_EQ(complaint({"--study", "materials", "--device", "cuda", "--method", "rk4"}), "");
#else
  EXPECT_THAT(complaint({"--study", "stress", "--device", "cuda"}), HasSubstr("-DEVODEVO_CUDA=ON"));
#endif
  EXPECT_EQ(complaint({"--study", "features"}), "");
}

}  // namespace
}  // namespace evodevo::benchmark
