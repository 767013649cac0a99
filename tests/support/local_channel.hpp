// Ranks that are threads of one process.
#pragma once

#include <atomic>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "cluster/channel.hpp"

namespace evodevo::testing {

/// Carries messages between ranks that are threads of this process.
class LocalChannel final : public Channel {
 public:
  /// What is on the way to each rank.
  struct Boxes {
    explicit Boxes(int ranks) : of(static_cast<std::size_t>(ranks)) {}
    std::mutex mutex;
    std::vector<std::deque<Received>> of;
  };

  LocalChannel(std::shared_ptr<Boxes> boxes, int rank) : boxes_(std::move(boxes)), rank_(rank) {}

  int rank() const override { return rank_; }
  int size() const override { return static_cast<int>(boxes_->of.size()); }
  int rank_on_host() const override { return rank_; }
  int ranks_on_host() const override { return size(); }
  void send(int to, std::string bytes) override {
    const std::lock_guard lock(boxes_->mutex);
    if (!is_cut) boxes_->of[static_cast<std::size_t>(to)].push_back({rank_, std::move(bytes)});
  }
  std::optional<Received> receive() override {
    const std::lock_guard lock(boxes_->mutex);
    std::deque<Received>& box = boxes_->of[static_cast<std::size_t>(rank_)];
    if (box.empty()) return std::nullopt;
    Received received = std::move(box.front());
    box.pop_front();
    return received;
  }
  void give_up(int rank) override { given_up_.push_back(rank); }
  std::vector<int> given_up() const override { return given_up_; }
  void leave() override {}

  std::atomic<bool> is_cut = false;  ///< whether what this rank sends is lost

 private:
  std::shared_ptr<Boxes> boxes_;
  int rank_;
  std::vector<int> given_up_;
};

}  // namespace evodevo::testing
