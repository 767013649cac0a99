#include <gtest/gtest.h>

#include "cuda/runtime/cuda_simulator.hpp"

/// Returns 77, by which CTest knows that tests were skipped, if there is no GPU and nothing has failed.
int main(int count, char** words) {
  ::testing::InitGoogleTest(&count, words);
  const int failed = RUN_ALL_TESTS();
  return failed == 0 && !evodevo::why_cuda_is_unusable().empty() ? 77 : failed;
}
