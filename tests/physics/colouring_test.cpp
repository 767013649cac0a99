// The colouring of springs.
#include "analysis/colouring.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

TEST(Colouring, NoTwoSpringsOfAColourShareAMass) {
  for (const Body& body : {random_body(150, 12, 5, 1), block(3, {5000, 0, 0, 0})}) {
    const std::vector<std::uint32_t> colours = spring_colours(body);
    ASSERT_EQ(colours.size(), body.springs.size());
    std::vector<std::set<std::uint32_t>> at(body.masses.size());
    std::size_t highest_degree = 0;
    for (std::size_t i = 0; i < colours.size(); ++i)
      for (const std::uint32_t mass : {body.springs[i].a, body.springs[i].b}) {
        EXPECT_TRUE(at[mass].insert(colours[i]).second) << "spring " << i;
        highest_degree = std::max(highest_degree, at[mass].size());
      }
    EXPECT_LT(*std::max_element(colours.begin(), colours.end()), 2 * highest_degree - 1);
  }
}

TEST(Colouring, NothingHasNoColours) { EXPECT_TRUE(spring_colours({}).empty()); }

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
