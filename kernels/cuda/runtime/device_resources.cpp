#include "cuda/runtime/device_resources.hpp"

#include "cuda/runtime/shared.hpp"

namespace evodevo::cuda {

std::shared_ptr<DeviceResources> DeviceResources::of(const Device& device) {
  static Shared<int, DeviceResources> resources;
  return resources.get(device.number, [] { return std::make_shared<DeviceResources>(); });
}

}  // namespace evodevo::cuda
