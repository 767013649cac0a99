// Loops over independent items on several threads.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace evodevo {

/// The number of threads that `threads` stands for: itself, or all cores where it is 0.
int thread_count(int threads);

/// Threads that wait for loops to share out. Loops of several callers run at the same time; the items of a caller whose
/// turn is earlier come first.
class Workers {
 public:
  /// `threads` threads; 0: one for each core. Where the system grants only some of them, it takes half as many as it
  /// got, so that room is left for the rest of the work, and says so once on stderr. Where it grants none, callers of
  /// for_each() do the work themselves.
  explicit Workers(int threads);
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;
  ~Workers();

  /// Calls body(i) for every i < count, in no particular order, and returns when all calls have. After an exception no
  /// further call begins, and it is thrown again here. `body` must not call for_each() of the same workers.
  void for_each(std::size_t count, const std::function<void(std::size_t)>& body);

  /// How many threads do the work, a caller's own included.
  std::size_t count() const { return std::max<std::size_t>(threads_.size(), 1); }

 private:
  struct Loop {
    const std::function<void(std::size_t)>& body;
    std::size_t count;
    int turn;
    std::size_t next = 0, under_way = 0;
    std::exception_ptr failure;

    bool done() const { return next == count && under_way == 0; }
  };

  /// Starts as many threads as can be, `wanted` at most.
  void start(std::size_t wanted);
  /// Ends all threads.
  void end();
  void work();
  /// The loop of the earliest turn that has items left; none if no loop has.
  Loop* next_loop();

  std::mutex mutex_;
  std::condition_variable work_comes_, loop_done_;
  std::vector<Loop*> loops_;  ///< with items left
  bool ending_ = false;
  std::vector<std::jthread> threads_;
};

/// Until its end, the loops of this thread have the turn `turn`; without one they have turn 0, the earliest.
class Turn {
 public:
  explicit Turn(int turn);
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;
  ~Turn();
  static int of_this_thread();

 private:
  int before_;
};

/// Calls body(i) for every i < count, each on a thread of its own; where the system grants no more threads, this one
/// makes the calls that are left, one after the other. The first exception is thrown again here after all calls have
/// ended.
void on_own_threads(std::size_t count, const std::function<void(std::size_t)>& body);

}  // namespace evodevo
