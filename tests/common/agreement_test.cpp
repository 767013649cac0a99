// The share of springs that an estimate finds, compared with known results.
#include "common/agreement.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace evodevo::tools::EVODEVO_FILE {
namespace {

const std::vector<double> truth{5, 1, 4, 2, 3, 0};

TEST(ShareFound, IsOneForTheTruthAndAnythingThatGrowsWithIt) {
  EXPECT_EQ(share_found(truth, truth, 3), 1);
  EXPECT_EQ(share_found(truth, std::vector<double>{50, 11, 40, 12, 30, -7}, 3), 1);
}

TEST(ShareFound, IsZeroForTheOpposite) { EXPECT_EQ(share_found(truth, std::vector<double>{0, 4, 1, 3, 2, 5}, 3), 0); }

TEST(ShareFound, IsChanceWhereTheEstimateKnowsNothing) {
  EXPECT_DOUBLE_EQ(share_found(truth, std::vector<double>(6, 1.0), 2), 2.0 / 6);
}

TEST(ShareFound, SharesTheRoomAmongEquals) {
  // the estimate finds 5; its values for 4, 3, 2 and 0 are equal, so these four compete for two places
  EXPECT_DOUBLE_EQ(share_found(truth, std::vector<double>{9, 0, 1, 1, 1, 1}, 3), (1 + 0.5 + 0.5) / 3);
}

}  // namespace
}  // namespace evodevo::tools::EVODEVO_FILE
