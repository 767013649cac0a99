// Several simulators that work as one.
#include "core/simulator_group.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <functional>
#include <mutex>
#include <numeric>
#include <optional>

namespace evodevo::EVODEVO_FILE {
namespace {

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
  Noting(Workers& workers, std::vector<std::size_t>& notes, std::function<void()> wait)
      : workers_(workers), notes_(notes), wait_(std::move(wait)) {}

  void run(std::span<Task> tasks, Recording) override {
    notes_.push_back(tasks.size());
    wait_();
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
  std::function<void()> wait_;
};

TEST(SimulatorGroup, SimulatesBatchesAtTheSameTime) {
  Workers workers(1);
  std::mutex mutex;
  std::condition_variable changed;
  int busy = 0;
  const auto wait_for_the_other = [&] {
    std::unique_lock lock(mutex);
    ++busy;
    changed.notify_all();
    // if only one member were used, the second batch would never come, and the test would not end
    changed.wait(lock, [&] { return busy == 2; });
  };
  std::vector<std::size_t> notes[2];
  std::vector<std::unique_ptr<Simulator>> members;
  for (auto& of_member : notes) members.push_back(std::make_unique<Noting>(workers, of_member, wait_for_the_other));
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
