// The device's memory among those who work on it at the same time.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <vector>

#include "cuda/runtime/memory.hpp"

namespace evodevo::cuda {

/// Lends memory out and keeps what comes back for the next, because taking memory makes the device wait. May be used
/// from several threads.
class MemoryStore {
 public:
  /// The store of all simulators and searches of the process, so that what one keeps is there for the others; it is
  /// there as long as any of them holds it.
  static std::shared_ptr<MemoryStore> of_process();

  /// Memory until its end.
  class Loan {
   public:
    /// Memory for `mirrored` bytes on device and host and `more` on the device. Throws OutOfMemory.
    Loan(MemoryStore& store, std::size_t mirrored, std::size_t more = 0)
        : store_(store), memory_(store.take(mirrored, more)) {}
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;
    ~Loan() { store_.give_back(std::move(memory_)); }
    const MirroredMemory& operator*() const { return *memory_; }
    const MirroredMemory* operator->() const { return memory_.get(); }

   private:
    MemoryStore& store_;
    std::unique_ptr<MirroredMemory> memory_;
  };

  /// Bytes of the device's memory that a loan can have.
  std::size_t available();

  /// Calls attempt(n), which works on the first n of `count` items, until it is not out of memory: with half as many
  /// again and again; with one at last, while no other attempt is under way and nothing is kept. Returns n; what the
  /// last attempt throws is thrown again.
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
  std::unique_ptr<MirroredMemory> take(std::size_t mirrored, std::size_t more);
  void give_back(std::unique_ptr<MirroredMemory> memory);
  void release_idle();

  std::shared_mutex attempts_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<MirroredMemory>> idle_;
};

}  // namespace evodevo::cuda
