// The command line of the benchmark.
#include "bench/settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "../common/help.hpp"

namespace evodevo::tools::bench::EVODEVO_FILE {
namespace {

using ::testing::HasSubstr;

std::string complaint(const CommandLine& line) { return complaint_about(parse, line); }

TEST(Settings, NameTheirMethodAndTheCommandThatRepeatsThem) {
  EXPECT_EQ(parse({"--json", "--body", "cube10", "--runs=3"}).command, "tools/bench --body cube10 --runs=3");
  EXPECT_EQ(parse({}).stepping().method, Method::paper_euler);
  EXPECT_EQ(parse({"--method", "implicit"}).stepping().method, Method::implicit);
}

TEST(Settings, RefuseWhatCannotBeMeasured) {
  EXPECT_THAT(complaint({"--study", "speeed"}), AllOf(HasSubstr("\"speeed\""), HasSubstr("speed, sizes, numbers, ")));
  EXPECT_THAT(complaint({"--study", "baselines"}), HasSubstr("--device cuda"));
  EXPECT_THAT(complaint({"--study", "features", "--robots", "some.toml"}), HasSubstr("--robots"));
  EXPECT_THAT(complaint({"--bodies", "0"}), HasSubstr("bodies from 1 to 65535"));
  EXPECT_THAT(complaint({"--steps=-1"}), HasSubstr("--steps -1"));
  EXPECT_THAT(complaint({"--method", "rk5"}), AllOf(HasSubstr("\"rk5\""), HasSubstr("paper-euler, ")));
  EXPECT_THAT(complaint({"--study", "materials"}), HasSubstr("add --device cuda"));
#ifdef EVODEVO_CUDA
  EXPECT_THAT(complaint({"--study", "host"}), HasSubstr("--robots"));
  EXPECT_EQ(complaint({"--study", "host", "--robots", "some.toml"}), "");
  EXPECT_THAT(complaint({"--study", "stress", "--device", "cuda", "--method", "rk4"}), HasSubstr("leave --method out"));
  EXPECT_THAT(complaint({"--study", "materials", "--device", "cuda", "--method", "xpbd"}),
              HasSubstr("another --method"));
  EXPECT_EQ(complaint({"--study", "materials", "--device", "cuda", "--method", "rk4"}), "");
#else
  EXPECT_THAT(complaint({"--study", "stress", "--device", "cuda"}), HasSubstr("-DEVODEVO_CUDA=ON"));
  EXPECT_THAT(complaint({"--study", "host", "--robots", "some.toml"}), HasSubstr("-DEVODEVO_CUDA=ON"));
#endif
  EXPECT_THAT(complaint({"--study", "sizes", "--body", "cube10"}), HasSubstr("leave --body out"));
  EXPECT_EQ(complaint({"--study", "features"}), "");
  EXPECT_EQ(complaint({"--study", "samples", "--method", "rk4"}), "");
  EXPECT_THAT(complaint({"--study", "samples", "--robots", "some.toml"}), HasSubstr("--robots"));
}

TEST(Settings, AreDescribedByTheHelp) {
  Settings settings;
  expect_page_of_options(program, options(settings));
}

}  // namespace
}  // namespace evodevo::tools::bench::EVODEVO_FILE
