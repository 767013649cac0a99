#include "threads/parallel.hpp"

#include <atomic>
#include <iostream>
#include <new>
#include <string>
#include <system_error>
#include <utility>

namespace evodevo {
namespace {

thread_local int priority_of_thread = 0;

/// Prints the warning once per process. Fewer threads change only the speed, never a result.
void warn_of_fewer_threads(std::size_t wanted, std::size_t taken) {
  static std::atomic_flag said;
  if (!said.test_and_set())
    std::cerr << "warning: the system does not grant " + std::to_string(wanted) + " threads; continuing with " +
                     std::to_string(taken) + "; ask for fewer threads, or raise the system's limits (ulimit)\n";
}

/// Starts a thread; returns false if the system refuses.
template <class Call>
bool start_thread(std::vector<std::jthread>& threads, const Call& call) try {
  threads.emplace_back(call);
  return true;
} catch (const std::system_error&) {
  return false;
} catch (const std::bad_alloc&) {
  return false;
}

}  // namespace

int thread_count(int threads) {
  if (threads > 0) return threads;
  const unsigned cores = std::thread::hardware_concurrency();
  return cores > 0 ? static_cast<int>(cores) : 1;
}

Workers::Workers(int threads) {
  const auto asked = static_cast<std::size_t>(thread_count(threads));
  std::size_t wanted = asked;
  for (start(wanted); threads_.size() < wanted; start(wanted)) {
    wanted = (threads_.size() + 1) / 2;
    end();
  }
  if (wanted < asked) warn_of_fewer_threads(asked, count());
}

Workers::~Workers() { end(); }

void Workers::start(std::size_t wanted) {
  ending_ = false;
  threads_.reserve(wanted);
  while (threads_.size() < wanted && start_thread(threads_, [this] { work(); })) {
  }
}

void Workers::end() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    work_comes_.notify_all();
  }
  threads_.clear();
}

void Workers::for_each(std::size_t count, const std::function<void(std::size_t)>& body) {
  if (threads_.empty())
    for (std::size_t i = 0; i < count; ++i) body(i);
  if (count == 0 || threads_.empty()) return;
  Loop loop{body, count, Priority::of_this_thread()};
  std::unique_lock lock(mutex_);
  loops_.push_back(&loop);
  work_comes_.notify_all();
  loop_done_.wait(lock, [&] { return loop.done(); });
  if (loop.failure) std::rethrow_exception(loop.failure);
}

Workers::Loop* Workers::next_loop() {
  const auto earliest = std::min_element(loops_.begin(), loops_.end(),
                                         [](const Loop* a, const Loop* b) { return a->priority < b->priority; });
  return earliest == loops_.end() ? nullptr : *earliest;
}

// Threads take the lock for each share, not for each item, because the items of small bodies take only microseconds.
// The first shares are an eighth of an even division, so that no thread is still busy with its share at the end.
std::size_t Workers::share_of(const Loop& loop) const {
  return std::max<std::size_t>(1, (loop.count - loop.next) / (8 * threads_.size()));
}

std::exception_ptr Workers::Loop::call(std::size_t first, std::size_t items) {
  try {
    for (std::size_t i = first; i < first + items && !has_failed; ++i) body(i);
  } catch (...) {
    has_failed = true;
    return std::current_exception();
  }
  return nullptr;
}

void Workers::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    work_comes_.wait(lock, [this] { return ending_ || !loops_.empty(); });
    Loop* loop = next_loop();
    if (!loop) return;
    const std::size_t first = loop->next, items = share_of(*loop);
    loop->next += items;
    if (loop->next == loop->count) std::erase(loops_, loop);
    ++loop->under_way;
    lock.unlock();
    const std::exception_ptr failure = loop->call(first, items);
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

Priority::Priority(int priority) : before_(std::exchange(priority_of_thread, priority)) {}
Priority::~Priority() { priority_of_thread = before_; }
int Priority::of_this_thread() { return priority_of_thread; }

void on_own_threads(std::size_t count, const std::function<void(std::size_t)>& body) {
  std::vector<std::exception_ptr> failures(count);
  const auto call = [&](std::size_t i) {
    try {
      body(i);
    } catch (...) {
      failures[i] = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> threads;
    threads.reserve(count);
    std::size_t i = 0;
    while (i < count && start_thread(threads, [&call, i] { call(i); })) ++i;
    for (; i < count; ++i) call(i);
  }
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

}  // namespace evodevo
