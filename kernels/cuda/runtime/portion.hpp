// As many bodies as the device holds at once, from the host's memory to the device's and back.
#pragma once

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

/// What all bodies of a run have in common.
struct Run {
  Scene scene;
  Stepping stepping;
  Recording recording;
  std::size_t shared_bytes;  ///< of the chip that one block can have
};

/// A task, whose course has begun, and how its body is simulated.
template <class T>
struct Plan {
  Plan(Task& task, const Run& run);

  Sizes sizes() const;

  Task* task;
  std::variant<Streamed<T>, Resident<T>> body;
};

/// Simulates bodies that fit the device together.
template <class T>
class Portion {
 public:
  /// Throws OutOfMemory, as simulate() may.
  Portion(std::span<Plan<T>> plans, const Run& run, MemoryStore& store);

  /// Bytes of the device's memory that bodies of these sizes need.
  static std::size_t bytes_for(const Sizes& sizes, std::size_t bodies);

  /// Makes all steps and fills in the answers; returns the time of the kernels, s. `busy` runs while the device works.
  /// After an exception no answer is filled in, and the streams are at rest.
  double simulate(KernelStore& kernels, std::span<const Stream> streams, Workers& workers, BusyClock& busy);

 private:
  /// Resident bodies that one launch handles.
  struct Launch {
    Features features;
    ResidentForm form;
    unsigned threads;
    auto operator<=>(const Launch&) const = default;
  };
  struct ReadyLaunch {
    Launch launch;
    cudaKernel_t kernel;
    std::span<const std::size_t> members;
    const ResidentBody<T>* bodies;  ///< on the device
  };

  /// Streamed bodies likewise: blocks of as many threads.
  struct StreamedLaunch {
    Features features;
    unsigned threads;
    auto operator<=>(const StreamedLaunch&) const = default;
  };

  Portion(std::span<Plan<T>> plans, const Run& run, MemoryStore& store, const Sizes& sizes);
  void pack(Workers& workers);
  void upload(cudaStream_t stream);
  std::vector<ReadyLaunch> ready_launches(KernelStore& kernels, Workers& workers) const;
  void allow_largest_chip(cudaKernel_t kernel) const;
  void launch_resident(KernelStore& kernels, std::span<const Stream> streams, Workers& workers);
  void launch_streamed(KernelStore& kernels, std::span<const Stream> streams);
  void launch_streamed(KernelStore& kernels, cudaStream_t stream, std::span<const std::size_t> members,
                       const StreamedBody<T>* bodies);
  void download(cudaStream_t stream);

  std::span<Plan<T>> plans_;
  Run run_;
  Sizes sizes_;
  MemoryStore::Loan memory_;
  std::vector<Regions> host_, device_;                   // of each plan
  std::map<Launch, std::vector<std::size_t>> resident_;  ///< the largest bodies first
  std::map<StreamedLaunch, std::vector<std::size_t>> streamed_;
};

extern template class Portion<float>;
extern template class Portion<double>;

}  // namespace evodevo::cuda
