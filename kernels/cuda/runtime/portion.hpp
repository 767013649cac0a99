// A portion: bodies of a batch that fit in the device's memory together. Its steps are:
//
//   Plan       task ─► layout of the body: Resident (on the chip) or Streamed (in the device's memory)
//   arrange    sizes of all plans ─► memory on host and device, regions of each body, launches of bodies of equal form
//   pack       bodies ─► descriptions, inputs and states on the host
//   upload     host ─► device; the sums are set to zero
//   for each range of check spans (layout/sampling.hpp; only one if nothing is sampled):
//     launch_resident, launch_streamed   kernels compute the steps and write samples to the host
//     unpack_samples   samples of the range ─► tasks, while the device computes the next range
//   download   states and sums: device ─► host
//   unpack     states, sums and answers on the host ─► tasks
#pragma once

#include <algorithm>
#include <bit>
#include <deque>
#include <map>
#include <span>
#include <tuple>
#include <variant>
#include <vector>

#include "cuda/layout/features.hpp"
#include "cuda/layout/resident.hpp"
#include "cuda/layout/streamed.hpp"
#include "cuda/runtime/kernels.hpp"
#include "cuda/runtime/memory_store.hpp"
#include "threads/busy_clock.hpp"
#include "threads/parallel.hpp"

namespace evodevo::cuda {

/// Properties that all bodies of a run have in common.
struct Run {
  Scene scene;
  Stepping stepping;
  Recording recording;
  Device device;
  std::uint64_t spans_per_range;                     ///< check spans in a range of samples
  unsigned largest_cluster, wanted_blocks, at_once;  ///< as in Room
};

/// What bodies of different runs must have in common to be simulated together. They all wait for the one with the most
/// steps, so the number of steps, to a factor of two, is part of it.
struct Kind {
  /// `steps`: the largest number of any body.
  Kind(const Run& run, std::uint64_t steps)
      : method(run.stepping.method),
        recording(run.recording),
        spans_per_range(run.spans_per_range),
        length(std::bit_width(steps)) {}
  auto operator<=>(const Kind&) const = default;

  Method method;
  Recording recording;
  std::uint64_t spans_per_range;
  int length;
};

/// A task, whose course has begun, and the layout in which its body is simulated. The scene of the run must outlive it.
template <class T>
struct Plan {
  Plan(Task& task, const Run& run);

  Sizes sizes() const;
  const SampleLayout& samples() const;
  /// The number of ranges in which the body is simulated; 1 if it is not sampled.
  std::uint64_t ranges() const;

  Task* task;
  const Scene* scene;
  std::variant<Streamed<T>, Resident<T>> body;
};

/// Simulates bodies that fit in the device's memory together.
template <class T>
class Portion {
 public:
  /// The plans may be those of several runs of the same kind on the same device, of which `run` is any one. Throws
  /// OutOfMemory. simulate() may throw it as well.
  Portion(std::span<Plan<T>> plans, const Run& run, MemoryStore& store);

  /// The number of launches that can proceed at the same time, each in a stream.
  std::size_t launches() const { return std::max(resident_.size(), streamed_.size()); }

  /// Simulates all steps, fills in the results and returns the time of the kernels, s. `busy` runs while the device
  /// works. If this function throws, no result is filled in and the streams are idle.
  double simulate(KernelStore& kernels, std::span<const Stream> streams, Workers& workers, BusyClock& busy);

 private:
  /// Properties that resident bodies of the same launch have in common.
  struct Launch {
    Features features;
    ResidentForm form;
    unsigned threads, blocks;  // blocks: of each body
    auto operator<=>(const Launch&) const = default;
  };
  /// A launch with its kernel and its bodies.
  struct ReadyLaunch {
    Launch launch;
    cudaKernel_t kernel;
    std::span<const std::size_t> members;
    const ResidentBody<T>* bodies;  ///< on the device
  };

  /// Properties that streamed bodies of the same launches have in common.
  struct StreamedLaunch {
    Features features;
    unsigned threads;
    auto operator<=>(const StreamedLaunch&) const = default;
  };

  void pack(Workers& workers);
  void upload(cudaStream_t stream);
  std::vector<ReadyLaunch> ready_launches(KernelStore& kernels, Workers& workers) const;
  const StreamedBody<T>* streamed_bodies(const std::byte* descriptions) const;
  std::uint64_t ranges() const;
  bool has_range(std::span<const std::size_t> members, std::uint64_t range) const;
  void launch_range(KernelStore& kernels, std::span<const ReadyLaunch> resident, std::span<const Stream> streams,
                    std::uint64_t range);
  void launch_resident(std::span<const ReadyLaunch> launches, std::span<const Stream> streams, std::uint64_t range);
  void launch_streamed(KernelStore& kernels, std::span<const Stream> streams, std::uint64_t range);
  void launch_streamed(KernelStore& kernels, cudaStream_t stream, std::span<const std::size_t> members,
                       const StreamedBody<T>* bodies, std::uint64_t range);
  void unpack_samples(Workers& workers, std::uint64_t range);
  void download(cudaStream_t stream);

  std::span<Plan<T>> plans_;
  Run run_;
  Sizes sizes_;
  MemoryStore::Loan memory_;
  std::vector<Regions> host_, device_;                   // regions of each plan
  std::map<Launch, std::vector<std::size_t>> resident_;  ///< indices of plans, the largest bodies first
  std::map<StreamedLaunch, std::vector<std::size_t>> streamed_;
};

extern template class Portion<float>;
extern template class Portion<double>;

}  // namespace evodevo::cuda
