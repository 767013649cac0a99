// The simulators of the paper, to compare ours with: the same physics, in float32, without guards.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/scene.hpp"
#include "cuda/runtime/kernels.hpp"
#include "cuda/runtime/memory.hpp"
#include "evodevo/body.hpp"
#include "paper/device_array.hpp"
#include "paper/paper_layout.hpp"

namespace evodevo::tools::bench {

/// Where masses lie while forces are added.
enum class MassMemory {
  global,  ///< of the simulator that the paper compares itself with
  shared,  ///< of the paper's own
};

struct PaperMethod {
  MassMemory memory = MassMemory::shared;
  SpringOrder order = SpringOrder::as_built;
  unsigned threads = 256;                    ///< of a block; with Skip-Shift, the groups that springs are dealt out to
  StressMethod stress = StressMethod::none;  ///< with shared memory alone
  std::uint32_t skip = 0;                    ///< steps between two tallies of Skip-Shift
};

/// What a method has recorded of one body's springs since birth; zeros where it records something else.
struct RecordedStress {
  std::vector<double> sum;                 ///< of |force|, N
  std::vector<std::uint32_t> least, most;  ///< tallies
};

/// The definitions that a method's kernels are compiled with.
std::vector<std::string> definitions(const PaperMethod& method, const Scene& scene);

/// `copies` of each of some bodies, which must outlive it, from birth on.
class PaperSimulator {
 public:
  /// Throws std::runtime_error where there is no GPU, or a body's masses are too many for shared memory.
  PaperSimulator(std::span<const Body> bodies, std::uint32_t copies, const Scene& scene, double dt,
                 const PaperMethod& method);

  /// Puts all bodies back to birth and forgets their stress.
  void restart();

  /// Makes `steps` steps; returns the device's time for them, s.
  double run(std::uint64_t steps);

  /// Of all bodies.
  std::size_t springs() const { return layout_.springs.size(); }

  /// How the first copy of a body moves. Throws std::runtime_error where it has diverged.
  State state(std::size_t body) const;
  /// What is recorded of it, in the order of Body::springs.
  RecordedStress stress(std::size_t body) const;

 private:
  void load_kernels(const Scene& scene);
  void launch_table(unsigned count);
  void launch_step(unsigned row);

  std::span<const Body> bodies_;
  std::uint32_t copies_;
  PaperMethod method_;
  PaperLayout layout_;
  cuda::StepConstants<float> constants_;
  std::uint64_t steps_ = 0;  // since birth

  cuda::KernelStore kernels_;
  cudaKernel_t fill_table_ = nullptr;
  cudaKernel_t add_forces_ = nullptr, move_masses_ = nullptr;  // of global memory's method
  cudaKernel_t step_ = nullptr;                                // of shared memory's
  cuda::Stream stream_;
  DeviceArray<PaperBody> body_table_;
  DeviceArray<PaperSpring> springs_;
  DeviceArray<float> mass_, inverse_mass_;
  DeviceArray<cuda::Point<float>> positions_, velocities_, forces_;
  DeviceArray<cuda::Actuator> actuators_;
  DeviceArray<cuda::Entry<float>> table_;
  DeviceArray<float> stress_;
  DeviceArray<std::uint32_t> least_, most_;
  PaperBatch batch_;
};

}  // namespace evodevo::tools::bench
