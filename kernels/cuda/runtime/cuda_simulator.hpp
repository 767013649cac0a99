// The simulator on NVIDIA GPUs. Exists only with the build option EVODEVO_CUDA.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/scene.hpp"
#include "core/simulator.hpp"

namespace evodevo {

/// A simulator on a GPU, with additional information that only it has.
class CudaSimulator : public Simulator {
 public:
  /// The time (s) that the device needed for the steps of the last batch that this simulator has sent to it, without
  /// copies. A run() is a batch of its own unless many others are under way.
  virtual double device_seconds() const = 0;
};

/// The default limit of a portion's memory on the device, bytes.
constexpr std::size_t default_portion = std::size_t{4} << 30;

/// The default limit of the blocks that simulate a body together.
constexpr unsigned default_cluster = 16;

/// A simulator on the current CUDA device. It prepares bodies on `threads` threads (0: one per core). Throws
/// std::runtime_error, with a message that names the cause and a remedy, if there is no usable device; run() throws one
/// if the device fails, and DeviceOutOfMemory if a single body does not fit the device's free memory.
///
/// Bodies that together need more than `memory` bytes, or more than is free on the device, are simulated in portions.
/// The smallest portion is one body; if necessary, it gets the memory of all simulators of this process. A portion's
/// copy on the host cannot be swapped out, which is why `memory` is limited. At most `largest_cluster` blocks simulate
/// a body together; with 1, as on a GPU that knows no clusters, large bodies are in the device's memory.
std::unique_ptr<CudaSimulator> make_cuda_simulator(const Scene& scene, const Stepping& stepping, int threads = 0,
                                                   std::size_t memory = default_portion,
                                                   unsigned largest_cluster = default_cluster);

/// A simulator on the GPUs with the given numbers, as CUDA counts those that this process sees. If no number is given,
/// it uses all GPUs that equal the first one, and leaves out unusable ones with a warning. Batches are dealt out to the
/// GPUs. All GPUs must be of one type, so that results do not depend on which of them simulates a body. Throws like
/// make_cuda_simulator(), and also if a number is not that of a GPU or if the types differ.
std::unique_ptr<Simulator> make_cuda_group(const Scene& scene, const Stepping& stepping, int threads = 0,
                                           std::span<const int> numbers = {});

/// Returns the numbers of the GPUs that make_cuda_group() uses if no number is given; none if CUDA cannot be used.
std::vector<int> equal_gpus();

/// Returns the reason why make_cuda_group() cannot use these GPUs; empty if it can.
std::string why_cuda_is_unusable(std::span<const int> numbers = {});

/// Whether this process sees no GPU, rather than one that it cannot use.
bool sees_no_gpu();

}  // namespace evodevo
