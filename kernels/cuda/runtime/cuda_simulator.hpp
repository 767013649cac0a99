// The simulator on an NVIDIA GPU; only where the build option EVODEVO_CUDA is on.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "core/scene.hpp"
#include "core/simulator.hpp"

namespace evodevo {

/// A simulator on a GPU, and what only a GPU's can tell.
class CudaSimulator : public Simulator {
 public:
  /// The time that the device spent on the steps of the run() that ended last, copies left out, s.
  virtual double device_seconds() const = 0;
};

/// A simulator on the current CUDA device that prepares bodies on `threads` threads (0: all cores). Throws
/// std::runtime_error, which says what is missing and what to do, where there is none, and in run() where the device
/// fails. Bodies that need more than `memory` bytes together, or more than is free on the device, are simulated in
/// portions, down to single bodies, one of which has the memory of all simulators of this process to itself if need be;
/// run() throws where that is too little. A portion's image on the host cannot be swapped out, hence the limit.
std::unique_ptr<CudaSimulator> make_cuda_simulator(const Scene& scene, const Stepping& stepping, int threads = 0,
                                                   std::size_t memory = std::size_t{4} << 30);

/// Why make_cuda_simulator() would find no usable device; empty where it would find one.
std::string why_cuda_is_unusable();

}  // namespace evodevo
