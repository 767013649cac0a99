// The search for nearest neighbours: one warp for each point, which compares the distances to all other points.
//
//   find_reach        points ─► Reach of each point: the k-th smallest distance, found digit by digit
//   count_pairs       points, reaches ─► number of pairs of each point
//   find_first_pairs  numbers ─► index of each point's first pair, number of pairs of each cloud
//   write_pairs       points, reaches, indices ─► pairs
//
// Two points are a pair if one is within the reach of the other. The search digit by digit takes the same time for any
// k and any number of equally distant points. Distances are the same, to the bit, as in analysis/neighbours.cpp.
#include "cuda/layout/point_clouds.hpp"

namespace evodevo::cuda {

constexpr unsigned lanes = 32, every_lane = 0xffffffffu, no_limit = 0xffffffffu;
constexpr unsigned bins = 256, bins_per_lane = bins / lanes;

// the first digit has 16 bins for each doubling of the squared distance, over 16 doublings below the largest; the bin
// of the smallest distances holds everything below as well
constexpr unsigned first_shift = 48;

/// The points of one cloud.
struct Points {
  const double *x, *y, *z;
  const Reach* reach;
  unsigned count;

  __device__ std::uint64_t square(unsigned a, unsigned b) const {
    const double dx = x[a] - x[b], dy = y[a] - y[b], dz = z[a] - z[b];
    return static_cast<std::uint64_t>(__double_as_longlong(dx * dx + dy * dy + dz * dz));
  }
};

__device__ __forceinline__ unsigned this_lane() { return threadIdx.x % lanes; }

__device__ Points points_of(const DeviceClouds& all, const DeviceCloud& cloud) {
  const unsigned first = cloud.first_point;
  return {all.x + first, all.y + first, all.z + first, all.reach + first, cloud.points};
}

/// The cloud of a point of the launch.
__device__ DeviceCloud& cloud_of(const DeviceClouds& all, unsigned point) {
  unsigned low = 0;
  for (unsigned high = all.count; high - low > 1;) {
    const unsigned middle = (low + high) / 2;
    (all.clouds[middle].first_point <= point ? low : high) = middle;
  }
  return all.clouds[low];
}

/// The sum of the values of this lane and of all lanes before it.
template <class T>
__device__ T sum_up_to_lane(T value) {
  for (unsigned distance = 1; distance < lanes; distance *= 2) {
    const T before = __shfl_up_sync(every_lane, value, distance);
    if (this_lane() >= distance) value += before;
  }
  return value;
}

/// The squared distances (as bits of doubles) from `low` to `high`, both included, divided into bins of 2^shift. The
/// first bin also takes everything below it.
struct Interval {
  std::uint64_t low, high;
  unsigned shift;

  __device__ bool contains(std::uint64_t square) const { return low <= square && square <= high; }

  __device__ unsigned bin(std::uint64_t square) const {
    const std::uint64_t below = (high - square) >> shift;
    return below < bins ? static_cast<unsigned>(bins - 1 - below) : 0;
  }

  /// The interval of a bin, divided again as finely as possible.
  __device__ Interval within(unsigned bin) const {
    Interval part = *this;
    part.high -= static_cast<std::uint64_t>(bins - 1 - bin) << shift;
    const std::uint64_t width = (1ull << shift) - 1;
    if (bin > 0 && part.high - low > width) part.low = part.high - width;
    const unsigned bits = 64 - static_cast<unsigned>(__clzll(static_cast<long long>(part.high - part.low)));
    part.shift = bits > 8 ? bits - 8 : 0;
    return part;
  }
};

/// Counts the other points in each of the interval's bins.
__device__ void count_bins(const Points& points, unsigned self, const Interval& interval, unsigned* histogram) {
  for (unsigned i = this_lane(); i < bins; i += lanes) histogram[i] = 0;
  __syncwarp();
  for (unsigned other = this_lane(); other < points.count; other += lanes) {
    const std::uint64_t square = points.square(self, other);
    if (other != self && interval.contains(square)) atomicAdd(&histogram[interval.bin(square)], 1u);
  }
  __syncwarp();
}

struct Bin {
  unsigned index, before, size;  ///< before: number of points in the bins below
};

/// The bin that holds the `wanted`-th point, counted from 1.
__device__ Bin find_bin(const unsigned* histogram, unsigned wanted) {
  const unsigned first = this_lane() * bins_per_lane;
  unsigned own = 0;
  for (unsigned i = 0; i < bins_per_lane; ++i) own += histogram[first + i];
  const unsigned up_to_here = sum_up_to_lane(own);
  const int owner = __ffs(static_cast<int>(__ballot_sync(every_lane, up_to_here >= wanted))) - 1;
  Bin bin{first, up_to_here - own, histogram[first]};
  if (this_lane() == owner)
    while (bin.before + bin.size < wanted) {
      bin.before += bin.size;
      bin.size = histogram[++bin.index];
    }
  return {__shfl_sync(every_lane, bin.index, owner), __shfl_sync(every_lane, bin.before, owner),
          __shfl_sync(every_lane, bin.size, owner)};
}

/// The `wanted`-th index, counted from 1, of the other points at exactly this distance.
__device__ unsigned index_among_equals(const Points& points, unsigned self, std::uint64_t square, unsigned wanted) {
  for (unsigned first = 0;; first += lanes) {
    const unsigned other = first + this_lane();
    const bool equal = other < points.count && other != self && points.square(self, other) == square;
    unsigned equals = __ballot_sync(every_lane, equal);
    const auto found = static_cast<unsigned>(__popc(equals));
    if (found < wanted) {
      wanted -= found;
      continue;
    }
    for (; wanted > 1; --wanted) equals &= equals - 1;
    return first + static_cast<unsigned>(__ffs(static_cast<int>(equals))) - 1;
  }
}

/// The reach of the `wanted` nearest other points.
__device__ Reach reach_of(const Points& points, unsigned self, unsigned wanted, double largest_square,
                          unsigned* histogram) {
  Interval interval{0, static_cast<std::uint64_t>(__double_as_longlong(largest_square)), first_shift};
  while (interval.low < interval.high) {
    count_bins(points, self, interval, histogram);
    const Bin bin = find_bin(histogram, wanted);
    __syncwarp();
    interval = interval.within(bin.index);
    wanted -= bin.before;
    if (bin.size == wanted) return {interval.high, no_limit, 0};
  }
  return {interval.low, index_among_equals(points, self, interval.low, wanted), 0};
}

__device__ bool reaches(const Reach& reach, std::uint64_t square, unsigned index) {
  return square < reach.square || (square == reach.square && index <= reach.index);
}

/// Calls emit(rank, b) for every pair (a, b) with a < b, in which rank counts from 0 in ascending order of b. Returns
/// the number of pairs.
template <class Emit>
__device__ unsigned for_each_pair(const Points& points, unsigned a, const Emit& emit) {
  const Reach reach = points.reach[a];
  unsigned found = 0;
  for (unsigned first = a / lanes * lanes; first < points.count; first += lanes) {
    const unsigned b = first + this_lane();
    bool joined = false;
    if (a < b && b < points.count) {
      const std::uint64_t square = points.square(a, b);
      joined = reaches(reach, square, b) || reaches(points.reach[b], square, a);
    }
    const unsigned mask = __ballot_sync(every_lane, joined);
    if (joined) emit(found + __popc(mask & ((1u << this_lane()) - 1)), b);
    found += __popc(mask);
  }
  return found;
}

/// The number of this warp's point; it may be beyond the last point.
__device__ __forceinline__ unsigned this_point() { return blockIdx.x * (search_threads / lanes) + threadIdx.x / lanes; }

/// Finds the reach of every point. One warp for each point.
extern "C" __global__ void __launch_bounds__(search_threads) evodevo_find_reach(const DeviceClouds all) {
  __shared__ unsigned histograms[search_threads / lanes][bins];
  const unsigned point = this_point();
  if (point >= all.points) return;
  const DeviceCloud& cloud = cloud_of(all, point);
  const Reach reach = reach_of(points_of(all, cloud), point - cloud.first_point, cloud.neighbours, cloud.largest_square,
                               histograms[threadIdx.x / lanes]);
  if (this_lane() == 0) all.reach[point] = reach;
}

/// Counts the pairs (a, b), a < b, of every point a. One warp for each point.
extern "C" __global__ void __launch_bounds__(search_threads) evodevo_count_pairs(const DeviceClouds all) {
  const unsigned point = this_point();
  if (point >= all.points) return;
  const DeviceCloud& cloud = cloud_of(all, point);
  const unsigned pairs = for_each_pair(points_of(all, cloud), point - cloud.first_point, [](unsigned, unsigned) {});
  if (this_lane() == 0) all.first_pair[point] = pairs;
}

/// Turns the numbers of pairs into the index of each point's first pair. One warp for each cloud.
extern "C" __global__ void __launch_bounds__(search_threads) evodevo_find_first_pairs(const DeviceClouds all) {
  const unsigned index = this_point();
  if (index >= all.count) return;
  DeviceCloud& cloud = all.clouds[index];
  std::uint64_t* first_pair = all.first_pair + cloud.first_point;
  std::uint64_t before = 0;
  for (unsigned first = 0; first < cloud.points; first += lanes) {
    const unsigned point = first + this_lane();
    const std::uint64_t own = point < cloud.points ? first_pair[point] : 0;
    const std::uint64_t up_to_here = before + sum_up_to_lane(own);
    if (point < cloud.points) first_pair[point] = up_to_here - own;
    before = __shfl_sync(every_lane, up_to_here, lanes - 1);
  }
  if (this_lane() == 0) cloud.pairs = before;
}

/// Writes all pairs. One warp for each point.
extern "C" __global__ void __launch_bounds__(search_threads)
    evodevo_write_pairs(const DeviceClouds all, DevicePair* pairs) {
  const unsigned point = this_point();
  if (point >= all.points) return;
  const DeviceCloud& cloud = cloud_of(all, point);
  const unsigned a = point - cloud.first_point;
  DevicePair* own = pairs + cloud.first_pair + all.first_pair[point];
  for_each_pair(points_of(all, cloud), a, [&](unsigned rank, unsigned b) { own[rank] = {a, b}; });
}

}  // namespace evodevo::cuda
