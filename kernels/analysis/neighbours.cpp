#include "analysis/neighbours.hpp"

#include <algorithm>
#include <limits>
#include <nanoflann.hpp>

#include "threads/parallel.hpp"

namespace evodevo {
namespace {

/// Points in the form that nanoflann reads.
struct Points {
  std::span<const Vec3> positions;

  std::size_t kdtree_get_point_count() const { return positions.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    const Vec3& p = positions[i];
    return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
  }
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

class CpuNeighbourSearch final : public NeighbourSearch {
 public:
  void find(std::span<const PointCloud> clouds, Workers& workers, const Use& use) override {
    workers.for_each(clouds.size(), [&](std::size_t i) { use(i, nearest_pairs(clouds[i].positions, clouds[i].k)); });
  }
};

}  // namespace

std::vector<IndexPair> nearest_pairs(std::span<const Vec3> positions, std::uint32_t k) {
  std::vector<IndexPair> pairs;
  if (positions.size() < 2 || k == 0) return pairs;
  const Points points{positions};
  const Tree tree(3, points);
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    NearestOthers nearest(i, std::min<std::size_t>(k, positions.size() - 1));
    tree.findNeighbors(nearest, &positions[i].x, nanoflann::SearchParams());
    for (const auto& [squared, j] : nearest.found()) pairs.push_back(std::minmax(i, j));
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

std::unique_ptr<NeighbourSearch> make_cpu_neighbour_search() { return std::make_unique<CpuNeighbourSearch>(); }

}  // namespace evodevo
