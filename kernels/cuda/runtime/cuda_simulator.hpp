// The simulator on an NVIDIA GPU. Exists only with the build option EVODEVO_CUDA.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "core/scene.hpp"
#include "core/simulator.hpp"

namespace evodevo {

/// A simulator on a GPU, with additional information that only it has.
class CudaSimulator : public Simulator {
 public:
  /// The time (s) that the device needed for the steps of the last run() that has ended, without copies.
  virtual double device_seconds() const = 0;
};

/// A simulator on the current CUDA device. It prepares bodies on `threads` threads (0: one per core). Throws
/// std::runtime_error, with a message that names the cause and a remedy, if there is no usable device; run() throws one
/// if the device fails, and DeviceOutOfMemory if a single body does not fit the device's free memory.
///
/// Bodies that together need more than `memory` bytes, or more than is free on the device, are simulated in portions.
/// The smallest portion is one body; if necessary, it gets the memory of all simulators of this process. A portion's
/// copy on the host cannot be swapped out, which is why `memory` is limited.
std::unique_ptr<CudaSimulator> make_cuda_simulator(const Scene& scene, const Stepping& stepping, int threads = 0,
                                                   std::size_t memory = std::size_t{4} << 30);

/// Returns the reason why make_cuda_simulator() would find no usable device; empty if it would find one.
std::string why_cuda_is_unusable();

}  // namespace evodevo
