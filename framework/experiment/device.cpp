#include "experiment/device.hpp"

#include <atomic>
#include <iostream>

#include "cpu/simulator.hpp"
#include "experiment/toml_reader.hpp"
#ifdef EVODEVO_CUDA
#include "cuda/runtime/cuda_simulator.hpp"
#endif

namespace evodevo {
namespace {

#ifdef EVODEVO_CUDA
/// Says once that there is a GPU that is not used, which otherwise only the speed of a run would show.
void warn_of_unused_gpu(const std::string& obstacle) {
  static std::atomic_flag said;
  if (!sees_no_gpu() && !said.test_and_set())
    std::cerr << "warning: simulating on the CPU, because the GPU cannot be used: " + obstacle + '\n';
}
#endif

}  // namespace

std::unique_ptr<Simulator> make_simulator(const Experiment& experiment) {
  return make_simulator(experiment, experiment.stepping, experiment.device);
}

std::unique_ptr<Simulator> make_simulator(const Experiment& experiment, const Stepping& stepping, Device device) {
  if (device != Device::cpu) {
#ifdef EVODEVO_CUDA
    const std::string obstacle = why_cuda_is_unusable(experiment.gpus);
    if (obstacle.empty())
      return make_cuda_group(experiment.scene, stepping, static_cast<int>(experiment.threads), experiment.gpus);
    if (device != Device::cuda) warn_of_unused_gpu(obstacle);
#else
    const std::string obstacle = "this evodevo was built without CUDA; build it where the CUDA toolkit is installed";
#endif
    if (device == Device::cuda)
      throw ConfigError(experiment.device_location + ": simulation.device = \"cuda\": " + obstacle +
                        ", or set simulation.device to \"cpu\"");
  }
  return make_cpu_simulator(experiment.scene, stepping, static_cast<int>(experiment.threads));
}

std::vector<int> usable_gpus() {
#ifdef EVODEVO_CUDA
  return equal_gpus();
#else
  return {};
#endif
}

std::string remedy_for(const std::exception& failure) {
  if (dynamic_cast<const DeviceOutOfMemory*>(&failure) == nullptr) return {};
  return "; simulation.device = \"cpu\" (--device cpu) simulates on the CPU";
}

}  // namespace evodevo
