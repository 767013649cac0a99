// What the host and the device say to each other about nearest neighbours: plain structures that both compilers lay out
// alike.
#pragma once

#include <cstdint>

namespace evodevo::cuda {

inline constexpr unsigned search_threads = 512;  ///< of a block that looks for neighbours; one warp for each point

/// One body's points among those of a launch. Points of all clouds are numbered through; within a cloud from 0.
struct DeviceCloud {
  std::uint32_t first_point;
  std::uint32_t points;
  std::uint32_t neighbours;  ///< of each point, 1 <= neighbours < points
  std::uint32_t unused;
  double largest_square;     ///< no two points are further apart, m^2
  std::uint64_t pairs;       ///< the device counts them
  std::uint64_t first_pair;  ///< where they are wanted, once they are counted
};

/// How far the neighbours of a point reach: up to a squared distance and, at exactly that, up to an index.
struct alignas(16) Reach {
  std::uint64_t square;  ///< the bits of a double, which sort like its value, m^2
  std::uint32_t index;
  std::uint32_t unused;
};

struct alignas(8) DevicePair {
  std::uint32_t a, b;  ///< indices within the cloud, a < b
};

/// All points of a launch.
struct DeviceClouds {
  DeviceCloud* clouds;
  const double *x, *y, *z;    ///< [points] m
  Reach* reach;               ///< [points]
  std::uint64_t* first_pair;  ///< [points] how many pairs (a, b) a point a has; then their place among the cloud's
  std::uint32_t count;        ///< clouds
  std::uint32_t points;
};

}  // namespace evodevo::cuda
