#include "core/simulator_group.hpp"

#include <algorithm>
#include <utility>

namespace evodevo {
namespace {

/// The spring evaluations that a batch needs. Every body counts as one spring more, so that no batch is for nothing.
std::uint64_t work_of(std::span<const Task> tasks) {
  std::uint64_t work = 0;
  for (const Task& task : tasks)
    if (task.status == Status::ok) work += (task.body->springs.size() + 1) * task.steps;
  return work;
}

/// Searches on the device that has the least searches before it.
class SearchGroup final : public NeighbourSearch {
 public:
  explicit SearchGroup(std::span<const std::unique_ptr<Simulator>> members)
      : members_(members), backlog_(members.size()) {}

  void find(std::span<const PointCloud> clouds, Workers& workers, const Use& use) override {
    std::uint64_t points = 0;
    for (const PointCloud& cloud : clouds) points += cloud.positions.size();
    const Backlog::Claim claim(backlog_, points);
    members_[claim.member()]->neighbours().find(clouds, workers, use);
  }

 private:
  std::span<const std::unique_ptr<Simulator>> members_;
  Backlog backlog_;
};

class SimulatorGroup final : public Simulator {
 public:
  SimulatorGroup(std::vector<std::unique_ptr<Simulator>> members, std::shared_ptr<Backlog> backlog)
      : members_(std::move(members)), backlog_(std::move(backlog)), neighbours_(members_) {}

  void run(std::span<Task> tasks, Recording recording) override {
    const Backlog::Claim claim(*backlog_, work_of(tasks));
    members_[claim.member()]->run(tasks, recording);
  }

  NeighbourSearch& neighbours() override { return neighbours_; }

  Workers& workers() override { return members_.front()->workers(); }

  int concurrency() const override {
    int batches = 0;
    for (const auto& member : members_) batches += member->concurrency();
    return batches;
  }

  std::shared_ptr<const void> announce(std::size_t bodies) override {
    auto announced = std::make_shared<std::vector<std::shared_ptr<const void>>>();
    for (const auto& member : members_)
      announced->push_back(member->announce((bodies + members_.size() - 1) / members_.size()));
    return announced;
  }

  std::optional<DeviceUse> device_use() const override {
    std::optional<DeviceUse> whole;
    for (const auto& member : members_) {
      const std::optional<DeviceUse> use = member->device_use();
      if (!use) continue;
      if (!whole) whole.emplace(DeviceUse{.devices = 0});
      whole->devices += use->devices;
      whole->busy += use->busy;
      whole->portions = std::max(whole->portions, use->portions);
      whole->bodies += use->bodies;
    }
    return whole;
  }

  std::string device() const override { return members_.front()->device(); }

 private:
  std::vector<std::unique_ptr<Simulator>> members_;
  std::shared_ptr<Backlog> backlog_;
  SearchGroup neighbours_;
};

}  // namespace

std::size_t Backlog::add(std::uint64_t work) {
  const std::lock_guard lock(mutex_);
  const auto least = std::min_element(work_.begin(), work_.end());
  *least += work;
  return static_cast<std::size_t>(least - work_.begin());
}

void Backlog::remove(std::size_t member, std::uint64_t work) {
  const std::lock_guard lock(mutex_);
  work_[member] -= work;
}

std::unique_ptr<Simulator> make_simulator_group(std::vector<std::unique_ptr<Simulator>> members,
                                                std::shared_ptr<Backlog> backlog) {
  if (!backlog) backlog = std::make_shared<Backlog>(members.size());
  return std::make_unique<SimulatorGroup>(std::move(members), std::move(backlog));
}

}  // namespace evodevo
