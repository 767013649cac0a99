// What all simulators and searches of this process on a GPU share.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>
#include <span>
#include <tuple>
#include <vector>

#include "cuda/runtime/coalescer.hpp"
#include "cuda/runtime/device.hpp"
#include "cuda/runtime/memory.hpp"
#include "cuda/runtime/memory_store.hpp"
#include "cuda/runtime/portion.hpp"
#include "threads/busy_clock.hpp"

namespace evodevo::cuda {

/// The streams that a single batch uses exclusively. They are opened when they are first needed.
class BatchResources {
 public:
  /// Returns at least one stream, and one for each of `launches` up to a dozen. Launches in `urgent` streams begin
  /// before those that wait in other streams.
  std::span<const Stream> streams(bool urgent, std::size_t launches) {
    constexpr std::size_t most = 12;
    const std::size_t count = std::clamp<std::size_t>(launches, 1, most);
    std::vector<Stream>& streams = urgent ? urgent_ : patient_;
    while (streams.size() < count) streams.emplace_back(urgent);
    return std::span(streams).first(count);
  }

 private:
  std::vector<Stream> urgent_, patient_;
};

/// The resources of batches that have ended, kept for later batches. New resources are created if none are available.
class BatchResourcePool {
 public:
  /// Holds the resources of one batch until it is destroyed.
  class Loan {
   public:
    explicit Loan(BatchResourcePool& pool) : pool_(pool), resources_(pool.take()) {}
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;
    ~Loan() { pool_.give_back(std::move(resources_)); }
    BatchResources* operator->() const { return resources_.get(); }

   private:
    BatchResourcePool& pool_;
    std::unique_ptr<BatchResources> resources_;
  };

 private:
  std::unique_ptr<BatchResources> take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return std::make_unique<BatchResources>();
    std::unique_ptr<BatchResources> resources = std::move(free_.back());
    free_.pop_back();
    return resources;
  }
  void give_back(std::unique_ptr<BatchResources> resources) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(resources));
  }

  std::mutex mutex_;
  std::vector<std::unique_ptr<BatchResources>> free_;
};

/// A number that several threads add to.
class Count {
 public:
  /// Adds `number` as long as the returned object exists.
  std::shared_ptr<const void> add(std::size_t number) {
    number_ += number;
    return {this, [number](Count* count) { count->number_ -= number; }};
  }
  std::size_t number() const { return number_; }

 private:
  std::atomic<std::size_t> number_ = 0;
};

/// The memory, the streams and the load of a GPU. Several threads may use it; they must work on this GPU.
struct DeviceResources {
  template <class T>
  using Batches = Coalescer<Kind, Plan<T>>;

  /// Those of a GPU, which exist as long as somebody holds them.
  static std::shared_ptr<DeviceResources> of(const Device& device);

  MemoryStore memory;
  BatchResourcePool batches;
  BusyClock busy;            ///< runs while kernels or copies of a batch are under way
  Count present, announced;  ///< bodies: in all runs under way, and of whoever has announced them
  std::tuple<Batches<float>, Batches<double>> coalescers{most_batches, most_batches};

 private:
  /// Of one kind that are under way at the same time.
  static constexpr std::size_t most_batches = 8;
};

}  // namespace evodevo::cuda
