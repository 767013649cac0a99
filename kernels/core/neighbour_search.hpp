// The interface of the search for nearest neighbours in many point clouds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>

#include "evodevo/body.hpp"
#include "threads/parallel.hpp"

namespace evodevo {

/// The indices of two points, the lower index first.
using IndexPair = std::pair<std::uint32_t, std::uint32_t>;

/// The points of one body, each of which is joined to its `k` nearest other points.
struct PointCloud {
  std::span<const Vec3> positions;  ///< m
  std::uint32_t k = 0;
};

/// Finds the pairs of neighbours in all clouds of a population. Several threads may search at once.
class NeighbourSearch {
 public:
  virtual ~NeighbourSearch() = default;

  /// Receives a cloud's index and its pairs. The pairs are valid only during the call.
  using Use = std::function<void(std::size_t, std::span<const IndexPair>)>;

  /// Calls use(i, pairs) once for every cloud i, on the threads of `workers` and in no particular order. `pairs` equals
  /// the result of nearest_pairs() (analysis/neighbours.hpp) for clouds[i]. Rethrows the first exception that `use`
  /// throws.
  virtual void find(std::span<const PointCloud> clouds, Workers& workers, const Use& use) = 0;
};

}  // namespace evodevo
