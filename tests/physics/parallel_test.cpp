// Parallel loops, the clock that measures overlapping intervals, and several simulators that work as one.
#include "threads/parallel.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <functional>
#include <future>
#include <latch>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <vector>

#include "core/simulator_group.hpp"
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

/// Expects that `body` succeeds in a child process whose address space is too small for 200 threads.
void expect_success_where_threads_are_short(const std::function<bool()>& body) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer needs more address space than the limit leaves";
#endif
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
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
}

TEST(Workers, GoOnWithFewerThreadsWhereTheSystemGrantsNoMore) {
  expect_success_where_threads_are_short([] {
    Workers workers(200), more(200);
    std::atomic<int> calls = 0;
    for (Workers* each : {&workers, &more}) each->for_each(1000, [&](std::size_t) { ++calls; });
    return workers.count() > 0 && workers.count() < 200 && more.count() > 0 && calls == 2000;
  });
}

TEST(OnOwnThreads, MakeTheCallsThatAreLeftWhereTheSystemGrantsNoMoreThreads) {
  expect_success_where_threads_are_short([] {
    std::atomic<int> calls = 0, not_on_this = 0;
    const auto here = std::this_thread::get_id();
    Workers workers(2);
    on_own_threads(300, [&](std::size_t) {
      ++calls;
      not_on_this += std::this_thread::get_id() != here;
      workers.for_each(3, [](std::size_t) {});
    });
    return calls == 300 && not_on_this > 0;
  });
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
  const auto fail_at_3 = [&](std::size_t i) {
    ++calls;
    if (i == 3) throw std::range_error("three");
  };
  EXPECT_THROW(workers.for_each(10, fail_at_3), std::range_error);
  EXPECT_EQ(calls, 4);
  workers.for_each(2, [&](std::size_t) { ++calls; });
  EXPECT_EQ(calls, 6) << "they work on after a failure";
}

TEST(Workers, StopInTheMiddleOfTheirSharesAfterAnException) {
  constexpr std::size_t many = 1'000'000;
  Workers workers(4);
  std::atomic<std::size_t> calls = 0;
  const auto fail_at_100 = [&](std::size_t i) {
    ++calls;
    if (i == 100) throw std::range_error("hundred");
  };
  EXPECT_THROW(workers.for_each(many, fail_at_100), std::range_error);
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
  const auto fail_at_2 = [&](std::size_t i) {
    ++calls;
    if (i == 2) throw std::range_error("two");
  };
  EXPECT_THROW(on_own_threads(4, fail_at_2), std::range_error);
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

TEST(Backlog, GivesWorkToTheMemberWithTheLeast) {
  Backlog backlog(2);
  std::optional<Backlog::Claim> large(std::in_place, backlog, 10u);
  const Backlog::Claim small(backlog, 3u), next(backlog, 3u), third(backlog, 3u);
  EXPECT_EQ(large->member(), 0u);
  EXPECT_EQ(small.member(), 1u);
  EXPECT_EQ(next.member(), 1u);
  EXPECT_EQ(third.member(), 1u) << "6 are less than 10";
  large.reset();
  EXPECT_EQ(Backlog::Claim(backlog, 1u).member(), 0u) << "whoever has finished gets more";
}

/// A simulator that notes how many tasks it has been given, and waits until all members are busy.
class Noting final : public Simulator {
 public:
  Noting(Workers& workers, std::vector<std::size_t>& notes, std::latch& all)
      : workers_(workers), notes_(notes), all_(all) {}

  void run(std::span<Task> tasks, Recording) override {
    notes_.push_back(tasks.size());
    all_.arrive_and_wait();
  }
  NeighbourSearch& neighbours() override { throw std::logic_error("not used"); }
  Workers& workers() override { return workers_; }
  int concurrency() const override { return 3; }
  std::optional<DeviceUse> device_use() const override {
    return DeviceUse{
        .busy = 2, .portions = notes_.size(), .bodies = std::accumulate(notes_.begin(), notes_.end(), std::size_t{0})};
  }
  std::string device() const override { return "device"; }

 private:
  Workers& workers_;
  std::vector<std::size_t>& notes_;
  std::latch& all_;
};

TEST(SimulatorGroup, SimulatesBatchesAtTheSameTime) {
  Workers workers(1);
  std::latch both(2);  // if only one member were used, the second batch would never come, and the test would not end
  std::vector<std::size_t> notes[2];
  std::vector<std::unique_ptr<Simulator>> members;
  for (auto& of_member : notes) members.push_back(std::make_unique<Noting>(workers, of_member, both));
  const auto group = make_simulator_group(std::move(members));
  Body body;
  State state;
  on_own_threads(2, [&](std::size_t i) {
    std::vector<Task> tasks(i + 1);
    for (Task& task : tasks) task.body = &body, task.state = &state, task.steps = 5;
    group->run(tasks, {});
  });
  EXPECT_EQ(notes[0].size(), 1u);
  EXPECT_EQ(notes[1].size(), 1u);
  EXPECT_EQ(notes[0][0] + notes[1][0], 3u);
  EXPECT_EQ(group->concurrency(), 6);
  EXPECT_EQ(&group->workers(), &workers);
  EXPECT_EQ(group->device(), "device");
  const DeviceUse use = group->device_use().value();
  EXPECT_EQ(use.devices, 2u);
  EXPECT_EQ(use.busy, 4);
  EXPECT_EQ(use.portions, 1u);
  EXPECT_EQ(use.bodies, 3u);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
