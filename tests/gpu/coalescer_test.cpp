#include "cuda/runtime/coalescer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <latch>
#include <stdexcept>
#include <thread>

#include "cuda/runtime/portion.hpp"

namespace evodevo::cuda::EVODEVO_FILE {
namespace {

/// A key that tells when it has been looked up. The coalescer then holds its lock, until the caller waits or is the
/// next to begin.
struct Key {
  int number = 0;
  std::atomic<bool>* looked_up = nullptr;

  bool operator<(const Key& other) const {
    for (const Key* key : {this, &other}) {
      if (key->looked_up == nullptr) continue;
      *key->looked_up = true;
      key->looked_up->notify_all();
    }
    return number < other.number;
  }
};

using Items = std::vector<int>;

TEST(Coalescer, BeginsAsManyBatchesAtOnceAsItMay) {
  Coalescer<Key, int> coalescer(2);
  std::latch both(2);
  const auto work = [&](Items&) { both.arrive_and_wait(); };
  std::jthread other([&] { coalescer.run({}, {1}, work); });
  coalescer.run({}, {2}, work);
}

/// Lets three callers wait behind a batch, of which two have the key of that batch, and calls `work` for their items.
template <class Work>
void let_callers_wait(const Work& work) {
  Coalescer<Key, int> coalescer(1);
  std::atomic<bool> looked_up[2]{};
  std::latch begun(1);
  std::jthread first([&] {
    coalescer.run({}, {1}, [&](Items&) {
      begun.count_down();
      for (const std::atomic<bool>& each : looked_up) each.wait(false);
    });
  });
  begun.wait();
  const auto call = [&](Key key, Items items) {
    return std::jthread([&, key, items]() mutable { work(coalescer, key, items); });
  };
  std::vector<std::jthread> callers;
  callers.push_back(call({.number = 0, .looked_up = &looked_up[0]}, {2, 3}));
  callers.push_back(call({.number = 1}, {4}));
  callers.push_back(call({.number = 0, .looked_up = &looked_up[1]}, {5}));
}

TEST(Coalescer, CombinesThoseThatWaitWithTheSameKey) {
  std::mutex mutex;
  std::vector<Items> batches;
  let_callers_wait([&](auto& coalescer, const Key& key, Items& items) {
    coalescer.run(key, std::move(items), [&](Items& batch) {
      const std::lock_guard lock(mutex);
      std::ranges::sort(batch);
      batches.push_back(batch);
    });
  });
  std::ranges::sort(batches);
  EXPECT_EQ(batches, (std::vector<Items>{{2, 3, 5}, {4}}));
}

TEST(Coalescer, ThrowsToAllWhoseItemsAreInTheBatch) {
  std::atomic<int> thrown = 0, not_thrown = 0;
  let_callers_wait([&](auto& coalescer, const Key& key, Items& items) {
    try {
      coalescer.run(key, std::move(items), [&](const Items& batch) {
        if (batch.size() == 3) throw std::runtime_error("the device fails");
      });
      ++not_thrown;
    } catch (const std::runtime_error&) {
      ++thrown;
    }
  });
  EXPECT_EQ(thrown, 2);
  EXPECT_EQ(not_thrown, 1);
}

TEST(Coalescer, HasNoBatchesWithoutItems) {
  Coalescer<int, int> coalescer(1);
  coalescer.run(0, {}, [](const Items&) { FAIL(); });
}

TEST(Coalescer, DoesTheWorkOfManyCallersOnce) {
  constexpr int callers = 12, rounds = 200;
  constexpr std::size_t most = 3;
  Coalescer<int, int> coalescer(most);
  std::vector<std::atomic<int>> done(callers * rounds);
  std::atomic<std::size_t> under_way = 0, largest = 0;
  {
    std::vector<std::jthread> threads;
    for (int caller = 0; caller < callers; ++caller)
      threads.emplace_back([&, caller] {
        for (int round = 0; round < rounds; ++round) {
          const int item = caller * rounds + round;
          coalescer.run(0, {item}, [&](const Items& batch) {
            const std::size_t now = ++under_way;
            for (std::size_t before = largest; before < now && !largest.compare_exchange_weak(before, now);) {
            }
            for (const int each : batch) ++done[each];
            --under_way;
          });
          EXPECT_EQ(done[item], 1);
        }
      });
  }
  EXPECT_LE(largest, most);
}

TEST(Kind, HasBodiesOfSimilarNumbersOfSteps) {
  const cuda::Run run{};
  EXPECT_TRUE(Kind(run, 600) == Kind(run, 1000));
  EXPECT_FALSE(Kind(run, 1000) == Kind(run, 42'000)) << "the one would wait for the other";
}

}  // namespace
}  // namespace evodevo::cuda::EVODEVO_FILE
