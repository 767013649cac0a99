// Loops over independent items on several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace evodevo {

/// `threads`, or the number of cores if it is 0.
int thread_count(int threads);

/// A pool of threads that work on loops together. Loops of several callers run at the same time; items of the loop with
/// the lowest priority number come first.
class Workers {
 public:
  /// Starts `threads` threads (0: one for each core). If the system grants fewer, the pool keeps half of the granted
  /// threads, so that other parts of the program can start threads too, and prints a warning to stderr once. If the
  /// system grants none, the callers of for_each() do the work themselves.
  explicit Workers(int threads);
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;
  ~Workers();

  /// Calls body(i) for every i < count, in no particular order, and returns when all calls have returned. If a call
  /// throws an exception, no further call begins, and the exception is rethrown here. `body` must not call for_each()
  /// of the same workers.
  void for_each(std::size_t count, const std::function<void(std::size_t)>& body);

  /// The number of threads that do the work, at least 1: the caller's own if the pool has none.
  std::size_t count() const { return std::max<std::size_t>(threads_.size(), 1); }

 private:
  struct Loop {
    const std::function<void(std::size_t)>& body;
    std::size_t count;
    int priority;
    std::size_t next = 0, under_way = 0;
    std::atomic<bool> has_failed = false;
    std::exception_ptr failure;

    bool done() const { return next == count && under_way == 0; }
    /// Calls body(i) for `items` values of i from `first` on; stops if a call of any thread has failed.
    std::exception_ptr call(std::size_t first, std::size_t items);
  };

  /// Starts threads until there are `wanted` or the system refuses.
  void start(std::size_t wanted);
  /// Ends all threads.
  void end();
  void work();
  /// The loop of lowest priority number among those with items left; null if there is none.
  Loop* next_loop();
  /// The number of items of a loop that a thread takes at once: the fewer are left, the fewer.
  std::size_t share_of(const Loop& loop) const;

  std::mutex mutex_;
  std::condition_variable work_comes_, loop_done_;
  std::vector<Loop*> loops_;  ///< loops with items left
  bool ending_ = false;
  std::vector<std::jthread> threads_;
};

/// While this object exists, loops that its thread starts have the given priority number; otherwise they have 0, the
/// highest priority.
class Priority {
 public:
  explicit Priority(int priority);
  Priority(const Priority&) = delete;
  Priority& operator=(const Priority&) = delete;
  ~Priority();
  static int of_this_thread();

 private:
  int before_;
};

/// Calls body(i) for every i < count, each on a thread of its own. If the system grants no more threads, the calling
/// thread makes the remaining calls one after the other. After all calls have ended, the first exception is rethrown
/// here.
void on_own_threads(std::size_t count, const std::function<void(std::size_t)>& body);

}  // namespace evodevo
