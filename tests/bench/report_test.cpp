// Reports of studies, and the bodies that they measure.
#include "report.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "studies.hpp"

namespace evodevo::tools::bench::EVODEVO_FILE {
namespace {

TEST(Report, IsATableWithItsConditionsAndItsCommand) {
  const Report report = {
      {"study", "A study"},
      {"command", "tools/bench --study x"},
      {"device", "a machine"},
      {"dt", 0.0005},
      {"note", "A note."},
      {"rows", {{{"a_name", "first"}, {"rate", 123456789.0}}, {{"a_name", "second"}, {"rate", 0.98765}}}}};
  EXPECT_EQ(markdown(report),
            "## A study\n\ndevice: a machine; dt: 0.0005.\n\nA note.\n\n```sh\ntools/bench --study x\n```\n\n"
            "| a name | rate |\n|---|---|\n| first | 1.23e+08 |\n| second | 0.9877 |\n");
}

TEST(Report, IsToldFromOtherJson) {
  Report report = {{"study", "x"}, {"command", "y"}, {"rows", {{{"rate", 1}}}}};
  EXPECT_TRUE(is_report(report));
  for (const char* rows : {"[]", "[1]", "[{}]", "null", "{}"}) {
    report["rows"] = Report::parse(rows);
    EXPECT_FALSE(is_report(report)) << rows;
  }
  for (const char* other : {"{\"a\": 1}", "5", "[]", "{\"study\": 1, \"command\": \"y\", \"rows\": [{\"a\": 1}]}"})
    EXPECT_FALSE(is_report(Report::parse(other))) << other;
}

TEST(Report, OfNumbersDoublesTheBodiesFromRowToRow) {
  const Report report = numbers(parse({"--study", "numbers", "--masses", "40", "--bodies", "5", "--steps", "20"}));
  std::vector<int> bodies;
  for (const Report& row : report.at("rows")) {
    bodies.push_back(row.at("bodies"));
    EXPECT_GT(row.at("spring_evaluations_per_second"), 0);
    EXPECT_GT(row.at("with_stress"), 0);
  }
  EXPECT_EQ(bodies, (std::vector{1, 2, 4}));
}

TEST(Bodies, CubeIsThePapers) {
  // for 10 x 10 x 10 voxels: a mass at each corner; springs along edges, face diagonals and body diagonals
  const Body cube = body_named("cube10", 0).body;
  EXPECT_EQ(cube.masses.size(), 11u * 11 * 11);
  EXPECT_EQ(cube.springs.size(), 3u * 10 * 11 * 11 + 2u * 3 * 10 * 10 * 11 + 4u * 10 * 10 * 10);
}

}  // namespace
}  // namespace evodevo::tools::bench::EVODEVO_FILE
