#include "cuda/ownership.hpp"

#include <algorithm>
#include <utility>

namespace evodevo::cuda {
namespace {

constexpr int passes = 4;    // more take longer than they gain
constexpr int penalty = 16;  // for each spring above a mass's even share, in springs of a bank

/// How many springs each mass owns, and how many of each group's lead to each bank.
class Loads {
 public:
  Loads(std::uint32_t groups, std::size_t masses, std::size_t springs)
      : lane_(32 * groups), bank_(32 * groups), even_share_(static_cast<int>(springs / masses) + 1) {}

  /// What one more spring of `owner` costs: it competes with others in the owner's lane and in the bank of `other`.
  int cost_of_adding(std::uint32_t owner, std::uint32_t other) const {
    const int lane = lane_[owner];
    return lane + penalty * std::max(0, lane + 1 - even_share_) + bank_[cell(owner, other)];
  }
  void add(std::uint32_t owner, std::uint32_t other, int count) {
    lane_[owner] += count;
    bank_[cell(owner, other)] += count;
  }

 private:
  static std::uint32_t cell(std::uint32_t owner, std::uint32_t other) { return owner / 32 * 32 + other % 32; }
  std::vector<int> lane_, bank_;
  int even_share_;
};

}  // namespace

std::vector<std::uint8_t> choose_owners(const Body& body, std::span<const std::uint32_t> place_of,
                                        std::uint32_t groups) {
  struct Ends {
    std::uint32_t owner, other;
  };
  Loads loads(groups, body.masses.size(), body.springs.size());
  std::vector<Ends> ends(body.springs.size());
  for (std::size_t i = 0; i < ends.size(); ++i) {
    Ends& e = ends[i] = {place_of[body.springs[i].a], place_of[body.springs[i].b]};
    if (loads.cost_of_adding(e.other, e.owner) < loads.cost_of_adding(e.owner, e.other)) std::swap(e.owner, e.other);
    loads.add(e.owner, e.other, 1);
  }
  // a spring changes hands where that is cheaper
  bool changed = true;
  for (int pass = 0; pass < passes && changed; ++pass) {
    changed = false;
    for (Ends& e : ends) {
      loads.add(e.owner, e.other, -1);
      if (loads.cost_of_adding(e.other, e.owner) < loads.cost_of_adding(e.owner, e.other)) {
        std::swap(e.owner, e.other);
        changed = true;
      }
      loads.add(e.owner, e.other, 1);
    }
  }
  std::vector<std::uint8_t> owned_by_b(ends.size());
  for (std::size_t i = 0; i < ends.size(); ++i) owned_by_b[i] = ends[i].owner != place_of[body.springs[i].a];
  return owned_by_b;
}

}  // namespace evodevo::cuda
