// Parallel loops, and the clock that measures overlapping intervals.
#include "threads/parallel.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <functional>
#include <future>
#include <optional>
#include <stdexcept>
#include <vector>

#include "threads/busy_clock.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

TEST(Workers, CallEveryItemOnce) {
  for (const int threads : {1, 2, 5}) {
    Workers workers(threads);
    for (const std::size_t count : {0, 1, 3, 1000}) {
      std::vector<std::atomic<int>> calls(count);
      workers.for_each(count, [&](std::size_t i) { ++calls[i]; });
      for (const std::atomic<int>& n : calls) EXPECT_EQ(n, 1);
    }
  }
}

/// Runs `body` in a child process whose address space is too small for 200 threads. Returns its exit code, or nothing
/// if it did not exit.
std::optional<int> where_threads_are_short(const std::function<bool()>& body) {
  const pid_t child = fork();
  if (child == 0) {
    alarm(60);
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    const rlim_t bytes = pages * static_cast<std::size_t>(getpagesize()) + (rlim_t{400} << 20);  // 8 MiB for each stack
    const rlimit limit{bytes, bytes};
    setrlimit(RLIMIT_AS, &limit);
    _exit(body() ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? std::optional(WEXITSTATUS(status)) : std::nullopt;
}

TEST(Workers, GoOnWithFewerThreadsWhereTheSystemGrantsNoMore) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer needs more address space than the limit leaves";
#endif
  const auto all_work = [] {
    Workers workers(200), more(200);
    std::atomic<int> calls = 0;
    for (Workers* each : {&workers, &more}) each->for_each(1000, [&](std::size_t) { ++calls; });
    return workers.count() > 0 && workers.count() < 200 && more.count() > 0 && calls == 2000;
  };
  EXPECT_EQ(where_threads_are_short(all_work), 0);
}

TEST(OnOwnThreads, MakeTheCallsThatAreLeftWhereTheSystemGrantsNoMoreThreads) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer needs more address space than the limit leaves";
#endif
  const auto all_called = [] {
    std::atomic<int> calls = 0, not_on_this = 0;
    const auto here = std::this_thread::get_id();
    Workers workers(2);
    on_own_threads(300, [&](std::size_t) {
      ++calls;
      not_on_this += std::this_thread::get_id() != here;
      workers.for_each(3, [](std::size_t) {});
    });
    return calls == 300 && not_on_this > 0;
  };
  EXPECT_EQ(where_threads_are_short(all_called), 0);
}

TEST(Workers, ServeSeveralCallersAtOnce) {
  Workers workers(2);
  std::atomic<int> sum = 0;
  on_own_threads(6, [&](std::size_t) { workers.for_each(100, [&](std::size_t) { ++sum; }); });
  EXPECT_EQ(sum, 600);
}

TEST(Workers, PassOnTheFirstExceptionAndStop) {
  Workers workers(1);
  int calls = 0;
  EXPECT_THROW(workers.for_each(10,
                                [&](std::size_t i) {
                                  ++calls;
                                  if (i == 3) throw std::range_error("three");
                                }),
               std::range_error);
  EXPECT_EQ(calls, 4);
  workers.for_each(2, [&](std::size_t) { ++calls; });
  EXPECT_EQ(calls, 6) << "they work on after a failure";
}

TEST(Workers, StopInTheMiddleOfTheirSharesAfterAnException) {
  constexpr std::size_t many = 1'000'000;
  Workers workers(4);
  std::atomic<std::size_t> calls = 0;
  EXPECT_THROW(workers.for_each(many,
                                [&](std::size_t i) {
                                  ++calls;
                                  if (i == 100) throw std::range_error("hundred");
                                }),
               std::range_error);
  EXPECT_LT(calls, many) << "the shares are not finished";
  calls = 0;
  workers.for_each(many, [&](std::size_t) { ++calls; });
  EXPECT_EQ(calls, many);
}

TEST(Workers, DoWhatHasAnEarlierTurnFirst) {
  constexpr std::size_t many = 1'000'000;
  Workers workers(1);
  std::promise<void> begun;
  std::atomic<bool> urgent_done = false;
  std::size_t items = 0, items_before = 0;  // finished items of the less urgent loop, counted by the only worker
  on_own_threads(2, [&](std::size_t caller) {
    const Priority priority(caller == 0 ? 1 : 0);
    if (caller == 0) {
      workers.for_each(many, [&](std::size_t) {
        if (items++ == 0) begun.set_value();
        if (!urgent_done) std::this_thread::yield();
      });
    } else {
      begun.get_future().wait();
      workers.for_each(1, [&](std::size_t) {
        items_before = items;
        urgent_done = true;
      });
    }
  });
  EXPECT_EQ(items, many);
  EXPECT_LT(items_before, many) << "it waited for the other loop's end";
}

TEST(OnOwnThreads, PassOnAnException) {
  std::atomic<int> calls = 0;
  EXPECT_THROW(on_own_threads(4,
                              [&](std::size_t i) {
                                ++calls;
                                if (i == 2) throw std::range_error("two");
                              }),
               std::range_error);
  EXPECT_EQ(calls, 4);
}

TEST(BusyClock, CountsOverlappingSpansOnce) {
  BusyClock clock, outer;
  {
    const BusyClock::Span around(outer);
    const BusyClock::Span first(clock), second(clock);
    while (clock.seconds() < 0.002) std::this_thread::yield();
  }
  const double closed = clock.seconds();
  EXPECT_GE(closed, 0.002);
  EXPECT_LE(closed, outer.seconds()) << "two open spans are one";
  EXPECT_EQ(clock.seconds(), closed) << "it stands while none is open";
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
