// Work of several callers that is done together.
//
//   few batches under way   ─► a caller's items are a batch of their own, at once
//   as many as there may be ─► callers wait; when a batch has ended, all that wait go on as one batch
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <iterator>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

namespace evodevo::cuda {

/// Combines items of several callers that have equal keys into batches. A device does few large batches sooner than many
/// small ones, because it has few queues for launches. Several threads may use a coalescer.
template <class Key, class Item>
class Coalescer {
 public:
  /// `most` is the number of batches of each key that may be under way at the same time.
  explicit Coalescer(std::size_t most) : most_(most) {}

  /// Returns after `work(std::vector<Item>&)` has been called for a batch with these items, by this or by another caller
  /// with the same key. With equal keys, `work` must do the same, whoever calls it. What it throws is thrown to all
  /// callers whose items are in the batch.
  template <class Work>
  void run(const Key& key, std::vector<Item>&& items, const Work& work) {
    if (items.empty()) return;
    Request mine{std::move(items)};
    std::unique_lock lock(mutex_);
    Queue& queue = queues_[key];
    queue.waiting.push_back(&mine);
    queue.ended.wait(lock, [&] { return mine.done || (!mine.taken && queue.under_way < most_); });
    if (!mine.done) lead(lock, queue, work);
    if (mine.error) std::rethrow_exception(mine.error);
  }

 private:
  /// The items of one caller, who waits until they are done.
  struct Request {
    std::vector<Item> items;
    bool taken = false, done = false;
    std::exception_ptr error = nullptr;
  };
  struct Queue {
    std::size_t under_way = 0;  ///< batches
    std::vector<Request*> waiting;
    std::condition_variable ended;
  };

  /// Does the work of all that wait.
  template <class Work>
  void lead(std::unique_lock<std::mutex>& lock, Queue& queue, const Work& work) {
    const std::vector<Request*> together = std::exchange(queue.waiting, {});
    std::vector<Item> batch;
    for (Request* request : together) {
      request->taken = true;
      std::ranges::move(request->items, std::back_inserter(batch));
    }
    ++queue.under_way;
    lock.unlock();
    std::exception_ptr error;
    try {
      work(batch);
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    --queue.under_way;
    for (Request* request : together) {
      request->done = true;
      request->error = error;
    }
    queue.ended.notify_all();
  }

  const std::size_t most_;
  std::mutex mutex_;
  std::map<Key, Queue> queues_;
};

}  // namespace evodevo::cuda
