// The two simulators of the paper, for comparison with ours: the same physics in float32, without the divergence guard.
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

/// The memory that holds the masses while forces are added.
enum class MassMemory {
  global,  ///< global memory, in the baseline that the paper compares its method with
  shared,  ///< shared memory, in the paper's method
};

struct PaperMethod {
  MassMemory memory = MassMemory::shared;
  SpringOrder order = SpringOrder::as_built;
  unsigned threads = 256;                    ///< threads in a block; with Skip-Shift also the number of spring groups
  StressMethod stress = StressMethod::none;  ///< available only with shared memory
  std::uint32_t skip = 0;                    ///< number of steps between two tallies of Skip-Shift
};

/// The recordings of one body's springs since birth. Quantities that the method does not record are zero.
struct RecordedStress {
  std::vector<double> sum;                 ///< sum of |force| over steps [N]
  std::vector<std::uint32_t> least, most;  ///< number of tallies in which each spring was counted
};

/// The preprocessor definitions with which a method's kernels are compiled.
std::vector<std::string> definitions(const PaperMethod& method, const Scene& scene);

/// Simulates `copies` of each body with one of the paper's methods, from birth on. The bodies must outlive this object.
class PaperSimulator {
 public:
  /// Throws std::runtime_error if there is no GPU, or if a body has too many masses for shared memory.
  PaperSimulator(std::span<const Body> bodies, std::uint32_t copies, const Scene& scene, double dt,
                 const PaperMethod& method);

  /// Resets all bodies to their state at birth, and their recorded stress to zero.
  void restart();

  /// Simulates `steps` steps; returns the time that the device needed for them, s.
  double run(std::uint64_t steps);

  /// The number of springs of all copies of all bodies.
  std::size_t springs() const { return layout_.springs.size(); }

  /// The current state of the first copy of a body. Throws std::runtime_error if it has diverged.
  State state(std::size_t body) const;
  /// The recorded stress of the first copy of a body, in the order of Body::springs.
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
  std::uint64_t steps_ = 0;  // number of steps since birth

  cuda::KernelStore kernels_;
  cudaKernel_t fill_table_ = nullptr;
  cudaKernel_t add_forces_ = nullptr, move_masses_ = nullptr;  // kernels of the global-memory method
  cudaKernel_t step_ = nullptr;                                // kernel of the shared-memory method
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
