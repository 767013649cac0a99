// The interface of a search for the nearest neighbours in many bodies.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>

#include "evodevo/body.hpp"
#include "threads/parallel.hpp"

namespace evodevo {

/// The indices of two places, the lower first.
using IndexPair = std::pair<std::uint32_t, std::uint32_t>;

/// The places of one body and how many nearest ones each of them is joined to.
struct PointCloud {
  std::span<const Vec3> places;
  std::uint32_t k = 0;
};

/// Finds the neighbours in all bodies of a population. Several threads may search at once.
class NeighbourSearch {
 public:
  virtual ~NeighbourSearch() = default;

  /// Takes a cloud's index and its pairs, which are there only during the call.
  using Use = std::function<void(std::size_t, std::span<const IndexPair>)>;

  /// Calls use(i, nearest_pairs of clouds[i]) once for every cloud, in no particular order and on the threads of
  /// `workers`. The first exception that it throws is thrown again here.
  virtual void find(std::span<const PointCloud> clouds, Workers& workers, const Use& use) = 0;
};

}  // namespace evodevo
