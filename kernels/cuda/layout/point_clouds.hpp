// The data that host and device exchange in the search for nearest neighbours: plain structures that both compilers lay
// out in the same way.
#pragma once

#include <cstdint>

namespace evodevo::cuda {

inline constexpr unsigned search_threads = 512;  ///< threads of a block; one warp for each point

/// The points of one body within a launch. Points have a number within the launch, and one within their cloud, from 0.
struct DeviceCloud {
  std::uint32_t first_point;
  std::uint32_t points;
  std::uint32_t neighbours;  ///< of each point, 1 <= neighbours < points
  std::uint32_t unused;
  double largest_square;     ///< upper bound of the squared distances in the cloud, m^2
  std::uint64_t pairs;       ///< number of pairs, counted by the device
  std::uint64_t first_pair;  ///< index at which the cloud's pairs begin; set by the host when the pairs are counted
};

/// The farthest neighbour of a point: other points are neighbours up to this squared distance and, at exactly this
/// distance, up to this index.
struct alignas(16) Reach {
  std::uint64_t square;  ///< squared distance, m^2: the bits of a double, which have the same order as its value
  std::uint32_t index;
  std::uint32_t unused;
};

struct alignas(8) DevicePair {
  std::uint32_t a, b;  ///< indices within the cloud, a < b
};

/// All points of a launch.
struct DeviceClouds {
  DeviceCloud* clouds;
  const double *x, *y, *z;  ///< [points] m
  Reach* reach;             ///< [points]
  std::uint64_t*
      first_pair;       ///< [points] at first the number of pairs (a, b) of point a, later the index of the first pair
  std::uint32_t count;  ///< number of clouds
  std::uint32_t points;
};

}  // namespace evodevo::cuda
