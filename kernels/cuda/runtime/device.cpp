#include "cuda/runtime/device.hpp"

#include <cuda_runtime_api.h>

#include <cstdlib>
#include <iostream>
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

std::vector<Device> visible_devices() {
  // the number of hardware queues; with the default of 8, launches for bodies of different forms wait for each other
  setenv("CUDA_DEVICE_MAX_CONNECTIONS", "32", 0);
  check_driver();
  int count = 0;
  check(cudaGetDeviceCount(&count), "looking for a GPU");
  std::vector<Device> devices;
  for (int number = 0; number < count; ++number) {
    cudaDeviceProp properties{};
    check(cudaGetDeviceProperties(&properties, number), "asking for the GPU's properties");
    devices.push_back({number, properties.name,
                       "sm_" + std::to_string(properties.major) + std::to_string(properties.minor),
                       properties.sharedMemPerBlockOptin, static_cast<unsigned>(properties.multiProcessorCount),
                       properties.clusterLaunch != 0});
  }
  return devices;
}

Device current_device() {
  const std::vector<Device> devices = visible_devices();
  int number = 0;
  check(cudaGetDevice(&number), "choosing a GPU");
  // the first call that needs the device itself: it fails if another program holds the GPU exclusively
  check(cudaFree(nullptr), "starting work on the GPU");
  return devices.at(static_cast<std::size_t>(number));
}

void work_on(const Device& device) {
  check(cudaSetDevice(device.number), "starting work on GPU " + std::to_string(device.number));
}

std::size_t free_memory() {
  std::size_t free = 0, total = 0;
  check(cudaMemGetInfo(&free, &total), "asking for the GPU's free memory");
  return free;
}

namespace {

std::string title(const Device& device) {
  return "GPU " + std::to_string(device.number) + " (" + device.name + ", " + device.architecture + ")";
}

}  // namespace

std::vector<Device> equal_devices(std::span<const Device> visible, std::span<const int> numbers) {
  std::vector<Device> chosen;
  for (const int number : numbers) {
    if (number < 0 || number >= static_cast<int>(visible.size()))
      throw std::runtime_error("CUDA: there is no GPU " + std::to_string(number) + "; this process sees " +
                               std::to_string(visible.size()) + ", numbered from 0");
    chosen.push_back(visible[static_cast<std::size_t>(number)]);
    if (!are_equal(chosen.front(), chosen.back()))
      throw std::runtime_error("CUDA: " + title(chosen.front()) + " and " + title(chosen.back()) +
                               " give results that differ by rounding; choose GPUs of one type");
  }
  if (numbers.empty())
    for (const Device& device : visible)
      if (are_equal(visible.front(), device)) chosen.push_back(device);
  return chosen;
}

std::vector<Device> usable_devices(std::span<const int> numbers) {
  std::vector<Device> usable;
  std::string obstacles;
  for (const Device& device : equal_devices(visible_devices(), numbers)) {
    try {
      work_on(device);
      usable.push_back(device);
    } catch (const std::runtime_error& error) {
      if (!numbers.empty()) throw;
      obstacles += (obstacles.empty() ? "" : "; ") + title(device) + ": " + error.what();
    }
  }
  if (usable.empty()) throw std::runtime_error(obstacles);
  if (!obstacles.empty()) std::cerr << "warning: the run does without a GPU: " + obstacles + '\n';
  return usable;
}

}  // namespace cuda

std::vector<int> equal_gpus() {
  std::vector<int> numbers;
  try {
    for (const cuda::Device& device : cuda::equal_devices(cuda::visible_devices(), {}))
      numbers.push_back(device.number);
  } catch (const std::runtime_error&) {
    numbers.clear();
  }
  return numbers;
}

std::string why_cuda_is_unusable(std::span<const int> numbers) {
  try {
    cuda::usable_devices(numbers);
    return {};
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

bool sees_no_gpu() {
  int driver = 0, count = 0;
  if (cudaDriverGetVersion(&driver) == cudaSuccess && driver == 0) return true;
  const cudaError_t found = cudaGetDeviceCount(&count);
  return found == cudaErrorNoDevice || found == cudaErrorStubLibrary || (found == cudaSuccess && count == 0);
}

}  // namespace evodevo
