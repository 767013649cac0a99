// Shares the device's memory among batches and searches that use it at the same time.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <vector>

#include "cuda/runtime/device.hpp"
#include "cuda/runtime/memory.hpp"

namespace evodevo::cuda {

/// Lends memory and keeps returned memory for the next loan, because allocation makes the device wait. Several threads
/// may use a store; they must work on its device.
class MemoryStore {
 public:
  /// Holds memory until it is destroyed.
  class Loan {
   public:
    /// Takes `mirrored` bytes on device and host, `more` bytes only on the device and `apart` bytes only on the host.
    /// Throws OutOfMemory.
    Loan(MemoryStore& store, std::size_t mirrored, std::size_t more = 0, std::size_t apart = 0)
        : store_(store), memory_(store.take(mirrored, more, apart)) {}
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;
    ~Loan() { store_.give_back(std::move(memory_)); }
    const MirroredMemory& operator*() const { return *memory_; }
    const MirroredMemory* operator->() const { return memory_.get(); }

   private:
    MemoryStore& store_;
    std::unique_ptr<MirroredMemory> memory_;
  };

  /// The memory of the device that is available to a loan, bytes: memory that is free or kept by the store.
  std::size_t available();

  /// Calls attempt(n), which works on the first n of `count` items. Begins with n = count, and halves n as long as the
  /// attempt throws OutOfMemory. The last attempt with n = 1 waits until no other attempt is running and frees all
  /// memory that the store keeps; its exception is not caught. Returns the n that succeeded.
  template <class Attempt>
  std::size_t with_fewer(std::size_t count, const Attempt& attempt) {
    for (;; count /= 2) {
      try {
        const std::shared_lock beside_others(attempts_);
        attempt(count);
        return count;
      } catch (const OutOfMemory&) {
        if (count <= 1) break;
      }
    }
    const std::unique_lock alone(attempts_);
    release_idle();
    attempt(1);
    return 1;
  }

 private:
  std::unique_ptr<MirroredMemory> take(std::size_t mirrored, std::size_t more, std::size_t apart);
  void give_back(std::unique_ptr<MirroredMemory> memory);
  void release_idle();

  std::shared_mutex attempts_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<MirroredMemory>> idle_;
};

}  // namespace evodevo::cuda
