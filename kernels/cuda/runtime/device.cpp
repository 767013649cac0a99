#include "cuda/runtime/device.hpp"

#include <cuda_runtime_api.h>

#include <cstdlib>
#include <stdexcept>

#include "cuda/runtime/cuda_simulator.hpp"
#include "cuda/runtime/error.hpp"

namespace evodevo {
namespace cuda {
namespace {

std::string version(int number) { return std::to_string(number / 1000) + "." + std::to_string(number % 1000 / 10); }

/// Throws if the driver is missing or too old. The runtime would notice only at the first real call, with a less clear
/// error.
void check_driver() {
  int driver = 0, runtime = 0;
  check(cudaDriverGetVersion(&driver), "asking for the driver's version");
  check(cudaRuntimeGetVersion(&runtime), "asking for the runtime's version");
  if (const std::string obstacle = driver_obstacle(driver, runtime); !obstacle.empty())
    throw std::runtime_error(obstacle);
}

}  // namespace

std::string driver_obstacle(int driver, int runtime) {
  if (driver == 0) return "CUDA: no NVIDIA driver is installed; install one";
  if (driver / 1000 >= runtime / 1000) return {};
  return "CUDA: the NVIDIA driver is too old: it knows CUDA " + version(driver) + ", this program needs " +
         version(runtime / 1000 * 1000) + "; install a newer driver";
}

Device current_device() {
  // the number of hardware queues; with the default of 8, launches for bodies of different forms wait for each other
  setenv("CUDA_DEVICE_MAX_CONNECTIONS", "32", 0);
  check_driver();
  int count = 0, device = 0;
  check(cudaGetDeviceCount(&count), "looking for a GPU");
  check(cudaGetDevice(&device), "choosing a GPU");
  cudaDeviceProp properties{};
  check(cudaGetDeviceProperties(&properties, device), "asking for the GPU's properties");
  // the first call that needs the device itself: it fails if another program holds the GPU exclusively
  check(cudaFree(nullptr), "starting work on the GPU");
  return {properties.name, "sm_" + std::to_string(properties.major) + std::to_string(properties.minor),
          properties.sharedMemPerBlockOptin};
}

std::size_t free_memory() {
  std::size_t free = 0, total = 0;
  check(cudaMemGetInfo(&free, &total), "asking for the GPU's free memory");
  return free;
}

}  // namespace cuda

std::string why_cuda_is_unusable() {
  try {
    cuda::current_device();
    return {};
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

}  // namespace evodevo
