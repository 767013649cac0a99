// The format of numbers in messages.
#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

#include "base/text.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(Numbers, ReadBackAsTheSame) {
  for (const double value :
       {0.0, 3.0, -17.0, 0.1, 0.1 + 0.2, 0.0007, 1e-9, 1e300, -5e-324, 123456789.125, 1e15, 0x1p63})
    EXPECT_EQ(std::strtod(to_text(value).c_str(), nullptr), value) << to_text(value);
  EXPECT_EQ(to_text(3.0), "3");
  EXPECT_EQ(to_text(0.0007), "0.0007");
  EXPECT_EQ(to_text(-0.0), "0");
}

TEST(Numbers, ThatAreNotFiniteAreTold) {
  for (const double value : {nan, -nan}) {
    EXPECT_EQ(to_text(value), "not a number");
    EXPECT_EQ(short_number(value), "not a number");
  }
  EXPECT_EQ(to_text(infinity), "infinity");
  EXPECT_EQ(short_number(-infinity), "-infinity");
}

TEST(Numbers, InShortHaveFourDigits) {
  EXPECT_EQ(short_number(0.123456), "0.1235");
  EXPECT_EQ(short_number(-0.0), "0");
  EXPECT_EQ(short_number(123456789), "1.235e+08");
}

TEST(Numbers, OfARangeAreItsEnds) {
  EXPECT_EQ(to_text(Range{0, 0.5, "s"}), "0 to 0.5");
  EXPECT_EQ(to_text(Range{-1, infinity}), "at least -1");
  EXPECT_EQ(to_text(Range{-infinity, 1e-9}), "at most 1e-09");
  EXPECT_EQ(to_text(Range{}), "");
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
