#include "analysis/neighbours.hpp"

#include <algorithm>
#include <limits>
#include <nanoflann.hpp>
#include <numeric>

#include "threads/parallel.hpp"

namespace evodevo {
namespace {

/// Points in the form that nanoflann reads.
struct Points {
  std::span<const Vec3> positions;

  std::size_t kdtree_get_point_count() const { return positions.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const { return positions[i][axis]; }
  template <class Bounds>
  bool kdtree_get_bbox(Bounds&) const {
    return false;  // nanoflann computes the bounding box itself
  }
};

/// The nearest other points found so far, at most `capacity`. Of equally near points, those with lower indices are
/// kept.
class NearestOthers {
 public:
  using DistanceType = double;

  NearestOthers(std::uint32_t self, std::size_t capacity) : self_(self), capacity_(capacity) {
    found_.reserve(capacity);
  }

  std::size_t size() const { return found_.size(); }
  bool full() const { return found_.size() == capacity_; }

  bool addPoint(double squared, std::uint32_t index) {
    const std::pair candidate(squared, index);
    if (index == self_ || (full() && candidate > found_.back())) return true;
    if (full()) found_.pop_back();
    found_.insert(std::upper_bound(found_.begin(), found_.end(), candidate), candidate);
    return true;
  }

  /// The squared distance (m^2) beyond which the tree need not search. It is a little larger than that of the farthest
  /// point found, so that the tree visits equally near points in spite of rounding in its distances to cells.
  double worstDist() const {
    if (!full()) return std::numeric_limits<double>::max();
    return found_.back().first * (1 + 1e-9) + std::numeric_limits<double>::min();
  }

  const std::vector<std::pair<double, std::uint32_t>>& found() const { return found_; }

 private:
  std::uint32_t self_;
  std::size_t capacity_;
  std::vector<std::pair<double, std::uint32_t>> found_;  ///< (squared distance, index), ascending
};

using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Points>, Points, 3, std::uint32_t>;

/// Returns the pairs of each point and its neighbours, sorted and unique. `neighbours` has `k` for each point. Groups
/// the pairs by their lower index; sorting all of them would take several times as long.
std::vector<IndexPair> unique_pairs(const std::vector<std::uint32_t>& neighbours, std::size_t k) {
  const std::size_t points = neighbours.size() / k;
  const auto for_each_pair = [&](const auto& use) {
    for (std::size_t i = 0; i < neighbours.size(); ++i) {
      const auto point = static_cast<std::uint32_t>(i / k);
      use(std::min(point, neighbours[i]), std::max(point, neighbours[i]));
    }
  };
  std::vector<std::size_t> end(points + 1, 0);  // of the pairs with a lower index, in `uppers`
  for_each_pair([&](std::uint32_t lower, std::uint32_t) { ++end[lower + 1]; });
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<std::uint32_t> uppers(neighbours.size());
  for_each_pair([&](std::uint32_t lower, std::uint32_t upper) { uppers[end[lower]++] = upper; });
  std::vector<IndexPair> pairs;
  pairs.reserve(neighbours.size());
  auto begin = uppers.begin();
  for (std::uint32_t lower = 0; lower < points; ++lower) {
    const auto behind = uppers.begin() + static_cast<std::ptrdiff_t>(end[lower]);
    std::sort(begin, behind);
    std::for_each(begin, std::unique(begin, behind), [&](std::uint32_t upper) { pairs.emplace_back(lower, upper); });
    begin = behind;
  }
  return pairs;
}

class CpuNeighbourSearch final : public NeighbourSearch {
 public:
  void find(std::span<const PointCloud> clouds, Workers& workers, const Use& use) override {
    workers.for_each(clouds.size(), [&](std::size_t i) { use(i, nearest_pairs(clouds[i].positions, clouds[i].k)); });
  }
};

}  // namespace

std::vector<IndexPair> nearest_pairs(std::span<const Vec3> positions, std::uint32_t k) {
  if (positions.size() < 2 || k == 0) return {};
  const std::size_t count = std::min<std::size_t>(k, positions.size() - 1);
  std::vector<std::uint32_t> neighbours;
  neighbours.reserve(count * positions.size());
  const Points points{positions};
  const Tree tree(3, points);
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    NearestOthers nearest(i, count);
    tree.findNeighbors(nearest, &positions[i].x, nanoflann::SearchParams());
    for (const auto& [squared, j] : nearest.found()) neighbours.push_back(j);
  }
  return unique_pairs(neighbours, count);
}

std::unique_ptr<NeighbourSearch> make_cpu_neighbour_search() { return std::make_unique<CpuNeighbourSearch>(); }

}  // namespace evodevo
