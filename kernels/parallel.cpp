#include "parallel.hpp"

#include <utility>

namespace evodevo {
namespace {

thread_local int turn_of_thread = 0;

}  // namespace

int thread_count(int threads) {
  if (threads > 0) return threads;
  const unsigned cores = std::thread::hardware_concurrency();
  return cores > 0 ? static_cast<int>(cores) : 1;
}

Workers::Workers(int threads) {
  for (int i = 0; i < thread_count(threads); ++i) threads_.emplace_back([this] { work(); });
}

Workers::~Workers() {
  const std::lock_guard lock(mutex_);
  ending_ = true;
  work_comes_.notify_all();
}

void Workers::for_each(std::size_t count, const std::function<void(std::size_t)>& body) {
  if (count == 0) return;
  Loop loop{body, count, Turn::of_this_thread()};
  std::unique_lock lock(mutex_);
  loops_.push_back(&loop);
  work_comes_.notify_all();
  loop_done_.wait(lock, [&] { return loop.done(); });
  if (loop.failure) std::rethrow_exception(loop.failure);
}

Workers::Loop* Workers::next_loop() {
  const auto earliest =
      std::min_element(loops_.begin(), loops_.end(), [](const Loop* a, const Loop* b) { return a->turn < b->turn; });
  return earliest == loops_.end() ? nullptr : *earliest;
}

void Workers::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    work_comes_.wait(lock, [this] { return ending_ || !loops_.empty(); });
    Loop* loop = next_loop();
    if (!loop) return;
    const std::size_t item = loop->next++;
    if (loop->next == loop->count) std::erase(loops_, loop);
    ++loop->under_way;
    lock.unlock();
    std::exception_ptr failure;
    try {
      loop->body(item);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (failure && !loop->failure) {
      loop->failure = failure;
      loop->next = loop->count;
      std::erase(loops_, loop);
    }
    --loop->under_way;
    if (loop->done()) loop_done_.notify_all();
  }
}

Turn::Turn(int turn) : before_(std::exchange(turn_of_thread, turn)) {}
Turn::~Turn() { turn_of_thread = before_; }
int Turn::of_this_thread() { return turn_of_thread; }

void on_own_threads(std::size_t count, const std::function<void(std::size_t)>& body) {
  std::vector<std::exception_ptr> failures(count);
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < count; ++i)
      threads.emplace_back([&, i] {
        try {
          body(i);
        } catch (...) {
          failures[i] = std::current_exception();
        }
      });
  }
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

}  // namespace evodevo
