// Runs on a simulated device whose calls take random times, as those of a GPU that others use too. Whichever call ends
// first, the results are those of a calm device. With the preset `tsan`, these runs also show data races.
#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>

#include "core/simulator_group.hpp"
#include "support/experiments.hpp"
#include "support/islands.hpp"
#include "support/lives.hpp"
#include "support/runs.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

/// Lets its callers yield to other threads a random number of times.
class Unrest {
 public:
  explicit Unrest(std::uint64_t seed) : number_(seed << 32) {}

  void yield() {
    // The order of relaxed operations hides no data race, unlike that of a generator behind a mutex.
    std::uint64_t x = number_.fetch_add(1, std::memory_order_relaxed) * 0x9e3779b97f4a7c15;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
    for (std::uint64_t i = std::uint64_t{1} << (x >> 33) % 12; i > 1; --i) std::this_thread::yield();
  }

 private:
  std::atomic<std::uint64_t> number_;
};

class UnsteadySearch final : public NeighbourSearch {
 public:
  UnsteadySearch(NeighbourSearch& search, Unrest& unrest) : search_(search), unrest_(unrest) {}

  void find(std::span<const PointCloud> clouds, Workers& workers, const Use& use) override {
    unrest_.yield();
    search_.find(clouds, workers, use);
    unrest_.yield();
  }

 private:
  NeighbourSearch& search_;
  Unrest& unrest_;
};

/// A device that takes several batches at once. It is lost in the call of run() with the number `lost`.
class UnsteadyDevice final : public testing::AlteredSimulator {
 public:
  UnsteadyDevice(const Experiment& experiment, std::uint64_t seed, int lost = -1)
      : AlteredSimulator(experiment, 3), unrest_(seed), lost_(lost) {}

  void run(std::span<Task> tasks, Recording recording) override {
    unrest_.yield();
    if (runs_++ == lost_) throw std::runtime_error("the device is lost");
    AlteredSimulator::run(tasks, recording);
    unrest_.yield();
  }
  NeighbourSearch& neighbours() override { return search_; }
  int concurrency() const override { return 3; }
  std::shared_ptr<const void> announce(std::size_t) override {
    unrest_.yield();
    return {this, [](UnsteadyDevice* device) { device->unrest_.yield(); }};
  }
  std::optional<DeviceUse> device_use() const override { return DeviceUse{}; }

  int runs() const { return runs_; }

 private:
  Unrest unrest_;
  UnsteadySearch search_{AlteredSimulator::neighbours(), unrest_};
  int lost_;
  std::atomic<int> runs_ = 0;
};

class UnsteadyRuns : public ::testing::Test {
 protected:
  Archive create(const std::string& name) { return Archive::create(scratch_ / name, experiment_, "test"); }
  Archive evolved(Archive archive, Simulator& simulator) {
    evolve(experiment_, simulator, archive, false, Observer{});
    return archive;
  }

  testing::Scratch scratch_;
  // 40 individuals for three cohorts, some of which are refused because their bones are stiff
  Experiment experiment_ =
      testing::small({"encoding={name = 'neural', points = 12, neighbours = 4}", "experiment.evaluations=160",
                      "experiment.population=40", "experiment.verify_front=trials", "materials.bone.stiffness=3e5",
                      "simulation.unstable=run"});
  Archive calm_ = evolved(create("calm"), *make_cpu_simulator(experiment_.scene, experiment_.stepping, 1));
};

TEST_F(UnsteadyRuns, OnOneDeviceAndOnSeveralGiveTheResultsOfACalmOne) {
  std::int64_t refused = 0;
  for (const Summary& summary : calm_.generations()) refused += summary.artefact + summary.passive;
  EXPECT_GT(refused, 0);
  for (const std::uint64_t seed : {1, 2, 3}) {
    UnsteadyDevice device(experiment_, seed);
    testing::expect_same_runs(calm_, evolved(create(std::to_string(seed)), device));
    std::vector<std::unique_ptr<Simulator>> devices;
    for (const std::uint64_t number : {10, 20, 30})
      devices.push_back(std::make_unique<UnsteadyDevice>(experiment_, seed + number));
    const auto group = make_simulator_group(std::move(devices));
    testing::expect_same_runs(calm_, evolved(create("group " + std::to_string(seed)), *group));
  }
}

TEST_F(UnsteadyRuns, ThatLoseTheDeviceGoOnFromTheLastGeneration) {
  UnsteadyDevice whole(experiment_, 0);
  evolved(create("whole"), whole);
  for (int lost = 0; lost < whole.runs(); lost += whole.runs() / 4) {
    const std::string name = std::to_string(lost);
    UnsteadyDevice broken(experiment_, static_cast<std::uint64_t>(lost), lost), other(experiment_, 1);
    EXPECT_THROW(evolved(create(name), broken), std::runtime_error) << lost;
    testing::expect_same_runs(calm_, evolved(Archive::resume(scratch_ / name), other));
  }
}

TEST(UnsteadyIslands, GiveTheResultsOfACalmDevice) {
  const testing::Scratch scratch;
  const auto islands = [&] { return testing::read_islands(scratch, testing::small_islands); };
  testing::evolve_islands(islands(), scratch / "calm", 1);
  for (const std::uint64_t seed : {1, 2, 3}) {
    auto device = std::make_unique<UnsteadyDevice>(islands().front(), seed);
    testing::evolve_islands(islands(), scratch / std::to_string(seed), std::move(device));
    testing::expect_same_islands(scratch / "calm", scratch / std::to_string(seed));
  }
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
