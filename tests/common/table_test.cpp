// Tables as CSV.
#include "common/table.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace evodevo::tools::EVODEVO_FILE {
namespace {

TEST(Table, IsCsvWithAHeader) {
  Table table("results", {"method", "dt (s)"});
  table.add({"rk4", 0.00025});
  table.add({"one, \"quoted\"", 1e-12});
  table.add({"", std::numeric_limits<double>::quiet_NaN()});
  EXPECT_EQ(table.csv(), "method,dt (s)\nrk4,0.00025\n\"one, \"\"quoted\"\"\",1e-12\n,\n");
  EXPECT_EQ(table.number(0, "dt (s)"), 0.00025);
  EXPECT_EQ(table.text(0, "method"), "rk4");
}

TEST(Table, RefusesWhatDoesNotFitItsColumns) {
  Table table("results", {"method", "dt (s)"});
  EXPECT_THROW(table.add({"rk4"}), std::logic_error);
  table.add({"rk4", 1.0});
  EXPECT_THROW(table.number(0, "dt"), std::logic_error);
}

TEST(Table, SaysWhereItCannotBeWritten) {
  EXPECT_THROW(write(Table("results", {"a"}), "/nowhere/at/all"), std::runtime_error);
}

}  // namespace
}  // namespace evodevo::tools::EVODEVO_FILE
