#include "cuda/layout/arrangement/ownership.hpp"

#include <algorithm>
#include <utility>

namespace evodevo::cuda {
namespace {

constexpr int sweeps = 4;    // sweeps over all springs; more would cost more time than they save
constexpr int penalty = 16;  // cost of each spring above a mass's even share

/// Counts the springs that each mass owns, and the springs of each group that lead to each bank.
class Distribution {
 public:
  Distribution(std::uint32_t groups, std::size_t masses, std::size_t springs)
      : lane_(32 * groups), bank_(32 * groups), even_share_(static_cast<int>(springs / masses) + 1) {}

  /// Whether a spring from `owner` to `other` would cost less with its ends swapped. `counted`: 1 if it has been added,
  /// otherwise 0.
  bool cheaper_swapped(std::uint32_t owner, std::uint32_t other, int counted) const {
    const int as_it_is = cost_of_adding(lane_[owner] - counted, bank_[cell(owner, other)] - counted);
    return cost_of_adding(lane_[other], bank_[cell(other, owner)]) < as_it_is;
  }
  void add(std::uint32_t owner, std::uint32_t other, int count) {
    lane_[owner] += count;
    bank_[cell(owner, other)] += count;
  }

 private:
  /// The cost of one more spring that shares its owner's lane with `lane` springs, and the bank of its other end with
  /// `bank` springs of the owner's group.
  int cost_of_adding(int lane, int bank) const { return lane + penalty * std::max(0, lane + 1 - even_share_) + bank; }
  static std::uint32_t cell(std::uint32_t owner, std::uint32_t other) { return owner / 32 * 32 + other % 32; }
  std::vector<int> lane_, bank_;
  int even_share_;
};

}  // namespace

void choose_owners(const Outline& outline, std::span<const std::uint32_t> index_of, std::uint32_t groups,
                   std::span<std::uint32_t> owner) {
  Distribution distribution(groups, outline.rest.size(), outline.ends.size());
  std::vector<std::uint32_t> other(owner.size());
  std::vector<std::size_t> undecided;
  for (std::size_t i = 0; i < owner.size(); ++i) {
    const std::uint32_t a = index_of[outline.ends[i].first], b = index_of[outline.ends[i].second];
    if (owner[i] == open) {
      undecided.push_back(i);
      owner[i] = a;
    } else {
      distribution.add(owner[i], a + b - owner[i], 1);
    }
    other[i] = a + b - owner[i];
  }
  for (const std::size_t i : undecided) {
    if (distribution.cheaper_swapped(owner[i], other[i], 0)) std::swap(owner[i], other[i]);
    distribution.add(owner[i], other[i], 1);
  }
  // a spring changes its owner if that is cheaper
  const int last_sweep = 2 * undecided.size() < owner.size() ? 1 : sweeps;
  bool changed = true;
  for (int sweep = 0; sweep < last_sweep && changed; ++sweep) {
    changed = false;
    for (std::size_t i = 0; i < owner.size(); ++i) {
      if (!distribution.cheaper_swapped(owner[i], other[i], 1)) continue;
      distribution.add(owner[i], other[i], -1);
      std::swap(owner[i], other[i]);
      distribution.add(owner[i], other[i], 1);
      changed = true;
    }
  }
}

}  // namespace evodevo::cuda
