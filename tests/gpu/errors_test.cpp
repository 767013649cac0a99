// Error messages about the driver and the device say what happened and what to do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <stdexcept>

#include "cuda/runtime/cuda_simulator.hpp"
#include "cuda/runtime/device.hpp"
#include "cuda/runtime/error.hpp"

namespace evodevo::cuda::EVODEVO_FILE {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string message(cudaError_t result) {
  try {
    check(result, "copying bodies to the GPU");
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return {};
}

TEST(Errors, NameWhatWasTriedTheRuntimesWordsAndTheRemedy) {
  const std::pair<cudaError_t, const char*> remedies[] = {
      {cudaErrorInsufficientDriver, "install a newer NVIDIA driver"},
      {cudaErrorNoDevice, "CUDA_VISIBLE_DEVICES"},
      {cudaErrorMemoryAllocation, "compute on the CPU"},
      {cudaErrorNoKernelImageForDevice, "build with a newer toolkit"},
      {cudaErrorDevicesUnavailable, "holds the GPU exclusively"},
      {cudaErrorSystemDriverMismatch, "restart the machine"},
      {cudaErrorSystemNotReady, "nvidia-fabricmanager"},
      {cudaErrorECCUncorrectable, "reset the GPU"},
      {cudaErrorIllegalAddress, "please report it"},
      {cudaErrorLaunchFailure, "please report it"}};
  for (const auto& [error, remedy] : remedies)
    EXPECT_THAT(message(error),
                AllOf(StartsWith("CUDA: copying bodies to the GPU failed: "), HasSubstr(cudaGetErrorString(error)),
                      HasSubstr(cudaGetErrorName(error)), HasSubstr(std::string("; ")), HasSubstr(remedy)));
}

TEST(Errors, ThatMemoryIsShortCanBeTold) {
  EXPECT_THROW(check(cudaErrorMemoryAllocation, "taking memory"), OutOfMemory);
  try {
    check(cudaErrorLaunchFailure, "simulating");
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(dynamic_cast<const OutOfMemory*>(&error), nullptr) << "this is another failure";
  }
}

TEST(Errors, AreNamedEvenWithoutARemedy) {
  EXPECT_THAT(message(cudaErrorInvalidValue), HasSubstr(cudaGetErrorName(cudaErrorInvalidValue)));
  EXPECT_EQ(message(cudaSuccess), "");
}

TEST(Driver, IsAnObstacleIfItIsMissingOrOfAnOlderMajorVersion) {
  EXPECT_EQ(driver_obstacle(13000, 13000), "");
  EXPECT_EQ(driver_obstacle(12040, 12080), "") << "minor versions are compatible";
  EXPECT_EQ(driver_obstacle(13010, 12080), "");
  EXPECT_THAT(driver_obstacle(0, 13000), AllOf(HasSubstr("no NVIDIA driver"), HasSubstr("install one")));
  EXPECT_THAT(driver_obstacle(12080, 13010),
              AllOf(HasSubstr("too old"), HasSubstr("knows CUDA 12.8,"), HasSubstr("needs 13.0;"), HasSubstr("newer")));
}

/// Returns the numbers of the chosen GPUs, or the message that refuses them.
std::string chosen(const std::vector<std::string>& names, const std::vector<int>& numbers) {
  std::vector<Device> visible;
  for (const std::string& name : names) visible.push_back({static_cast<int>(visible.size()), name, "sm_90", 227 << 10});
  std::string text;
  try {
    for (const Device& device : equal_devices(visible, numbers)) text += std::to_string(device.number) + " ";
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return text;
}

TEST(EqualDevices, AreThoseOfTheFirstTypeUnlessNumbersAreGiven) {
  EXPECT_EQ(chosen({"H200", "H200"}, {}), "0 1 ");
  EXPECT_EQ(chosen({"H200", "A100", "H200"}, {}), "0 2 ");
  EXPECT_EQ(chosen({"H200", "A100", "A100"}, {2, 1}), "2 1 ");
  EXPECT_EQ(chosen({"H200", "A100"}, {1}), "1 ");
  EXPECT_THAT(chosen({"H200"}, {1}), AllOf(HasSubstr("no GPU 1"), HasSubstr("sees 1")));
  EXPECT_THAT(chosen({"H200", "A100"}, {0, 1}), AllOf(HasSubstr("GPU 0 (H200"), HasSubstr("GPU 1 (A100")));
}

/// Under CTest, this test runs in a separate process: CUDA reads the visible devices only at its first call.
TEST(Device, ThatIsHiddenIsMissed) {
  ::setenv("CUDA_VISIBLE_DEVICES", "-1", 1);
  EXPECT_THAT(why_cuda_is_unusable(), ::testing::AnyOf(HasSubstr("CUDA_VISIBLE_DEVICES"), HasSubstr("NVIDIA driver")));
  EXPECT_TRUE(sees_no_gpu());
}

}  // namespace
}  // namespace evodevo::cuda::EVODEVO_FILE
