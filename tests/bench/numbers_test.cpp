// The study of the speed for different numbers of bodies.
#include <gtest/gtest.h>

#include <vector>

#include "studies.hpp"

namespace evodevo::tools::bench::EVODEVO_FILE {
namespace {

TEST(Numbers, DoublesTheBodiesFromRowToRow) {
  const Report report = numbers(parse({"--study", "numbers", "--masses", "40", "--bodies", "5", "--steps", "20"}));
  std::vector<int> bodies;
  for (const Report& row : report.at("rows")) {
    bodies.push_back(row.at("bodies"));
    EXPECT_GT(row.at("spring_evaluations_per_second"), 0);
    EXPECT_GT(row.at("with_stress"), 0);
  }
  EXPECT_EQ(bodies, (std::vector{1, 2, 4}));
}

}  // namespace
}  // namespace evodevo::tools::bench::EVODEVO_FILE
