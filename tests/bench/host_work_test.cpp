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
  double sum = 0;
  const Report report = host_work(settings);
  for (const Report& row : report.at("rows")) {
    const std::string stage = row.at("stage");
    times[stage] = row.at("times_per_robot");
    seconds[stage] = row.at("milliseconds_per_robot").get<double>() / 1000;
    EXPECT_GT(seconds[stage], 0) << stage;
    sum += seconds[stage];
  }
  for (const char* once : {"making a body from a genome", "arranging a body", "arranging a changed body"})
    EXPECT_EQ(times.at(once), 1) << once;
  for (const char* twice : {"splitting materials", "packing", "unpacking", "developing a body"})
    EXPECT_EQ(times.at(twice), 2) << twice;
  EXPECT_LE(sum, 2 * seconds.at("everything")) << "the stages are parts of everything";
}

}  // namespace
}  // namespace evodevo::tools::bench::EVODEVO_FILE
