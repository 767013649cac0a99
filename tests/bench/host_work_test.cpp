// What the benchmark counts of the host's work for robots on a GPU. It needs no GPU.
#include <gtest/gtest.h>

#include <map>

#include "studies.hpp"
#include "support/experiments.hpp"
#include "support/scratch.hpp"

namespace evodevo::tools::bench::EVODEVO_FILE {
namespace {

TEST(HostWork, IsCountedByStage) {
  const evodevo::testing::Scratch scratch;
  Settings settings;
  settings.robots = scratch.write("small.toml", evodevo::testing::small_experiment);  // two cycles of development
  settings.bodies = 4;
  std::map<std::string, double> times, seconds;
  const Report report = host_work(settings);
  for (const Report& row : report.at("rows")) {
    times[row.at("stage")] = row.at("times_per_robot");
    seconds[row.at("stage")] = row.at("milliseconds_per_robot").get<double>() / 1000;
  }
  EXPECT_EQ(times.at("making a body from a genome"), 1);
  EXPECT_EQ(times.at("arranging a body"), 1);
  EXPECT_EQ(times.at("arranging a changed body"), 1);
  EXPECT_EQ(times.at("splitting materials"), 2);
  EXPECT_EQ(times.at("packing"), 2);
  EXPECT_EQ(times.at("unpacking"), 2);
  EXPECT_EQ(times.at("developing a body"), 2);
  double sum = 0;
  for (const auto& [stage, time] : seconds) {
    EXPECT_GT(time, 0) << stage;
    sum += time;
  }
  EXPECT_LE(sum, 2 * seconds.at("everything")) << "the stages are parts of everything";
}

}  // namespace
}  // namespace evodevo::tools::bench::EVODEVO_FILE
