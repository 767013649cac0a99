// Code shared by the kernels that sample bodies: which samples are due, sums and extremes over a block, and the lists
// by mass. Samples go directly to the host's memory; no thread waits for these writes.
#pragma once

#include "cuda/device/check.cuh"

namespace evodevo::cuda {

/// The progress of a body through its samples.
struct Samples {
  std::uint64_t done;  // steps of the piece so far
  unsigned next;       // index of the next mark

  /// Goes to the first mark after step `step` of the piece.
  __device__ __forceinline__ void begin(const Sampling& sampling, std::uint64_t step) {
    done = step;
    next = 0;
    for (unsigned end = sampling.count; next < end;) {
      const unsigned middle = (next + end) / 2;
      if (sampling.marks[middle].step <= step)
        next = middle + 1;
      else
        end = middle;
    }
  }

  __device__ __forceinline__ bool are_due(const Sampling& sampling) const { return sampling.marks[next].step == done; }

  /// The number of steps to the next sample, but at most `most`.
  __device__ __forceinline__ unsigned steps_to_next(const Sampling& sampling, unsigned most) const {
    return static_cast<unsigned>(min(static_cast<std::uint64_t>(most), sampling.marks[next].step - done));
  }
};

struct Add {
  __device__ __forceinline__ double operator()(double a, double b) const { return a + b; }
};

struct Larger {
  __device__ __forceinline__ double operator()(double a, double b) const { return fmax(a, b); }
};

/// Joins each of eight values over a warp, in a fixed order: lanes exchange half of their values at a time, which takes
/// a fifth of the exchanges of eight separate sums. Lane l returns the result for value l / 4.
template <class Join>
__device__ __forceinline__ double across_warp(double (&values)[8], Join join) {
  constexpr unsigned all = 0xffffffff;
#pragma unroll
  for (unsigned distance = 16, count = 4; count > 0; distance /= 2, count /= 2) {
    const bool upper = threadIdx.x & distance;
#pragma unroll
    for (unsigned i = 0; i < count; ++i) {
      const double sent = upper ? values[i] : values[i + count], kept = upper ? values[i + count] : values[i];
      values[i] = join(kept, __shfl_xor_sync(all, sent, distance));
    }
  }
  for (unsigned distance = 2; distance > 0; distance /= 2)
    values[0] = join(values[0], __shfl_xor_sync(all, values[0], distance));
  return values[0];
}

/// Joins each of eight values over the block, in an order that depends only on the block's size, and writes the results
/// to `to`. `nothing` changes no result. Nothing else may use of_warps until the function returns.
template <class Join>
__device__ __forceinline__ void write_joined(double (&values)[8], Join join, double nothing, double* to) {
  const unsigned lane = threadIdx.x % lanes, warp = threadIdx.x / lanes, warps = blockDim.x / lanes;
  const double of_warp = across_warp(values, join);
  for (unsigned first = 0; first < 8; first += 4) {  // there is room for four values at a time
    const unsigned row = lane / 4 - first;
    if (lane % 4 == 0 && row < 4) of_warps[row][warp] = of_warp;
    __syncthreads();
    for (unsigned i = warp; i < 4; i += warps) {
      double all = lane < warps ? of_warps[i][lane] : nothing;
      for (unsigned distance = lanes / 2; distance > 0; distance /= 2)
        all = join(all, __shfl_down_sync(0xffffffff, all, distance));
      if (lane == 0) to[first + i] = all;
    }
    __syncthreads();
  }
}

/// A thread's contribution to the reduced quantities of a sample.
struct Reduction {
  static constexpr double lowest = -1.7976931348623157e308;
  double sums[8] = {};  // as in ReducedSample: centre, work, velocity, contact steps
  double extremes[8] = {lowest, lowest, lowest, lowest, lowest, lowest, lowest, lowest};  // low (negative), high

  __device__ __forceinline__ void add(const SampleMark& mark, double mass_share, const Vector& position,
                                      const Vector& velocity) {
    const double x[3] = {position.x, position.y, position.z}, v[3] = {velocity.x, velocity.y, velocity.z};
#pragma unroll
    for (unsigned i = 0; i < 3; ++i) {
      if (mark.channels & centre_bit) sums[i] += mass_share * x[i], sums[4 + i] += mass_share * v[i];
      if (mark.channels & box_bit)
        extremes[i] = fmax(extremes[i], -x[i]), extremes[4 + i] = fmax(extremes[4 + i], x[i]);
    }
  }
  /// Adds work, J.
  __device__ __forceinline__ void add_work(double joules) { sums[3] += joules; }
  __device__ __forceinline__ void add_contact(std::uint32_t steps) { sums[7] += steps; }

  /// Writes the sums and extremes of all threads of the block into the sample.
  __device__ __forceinline__ void write(const SampleMark& mark) {
    auto* to = reinterpret_cast<ReducedSample*>(mark.to);
    if (mark.channels & (centre_bit | contact_bit | work_bit)) write_joined(sums, Add(), 0, to->centre);
    if (mark.channels & box_bit) write_joined(extremes, Larger(), lowest, to->low);
  }
};

/// The lists of a sample that follow its reduced quantities.
struct SampleLists {
  float *positions, *velocities;
  std::uint32_t* touches;
  float* forces;

  __device__ __forceinline__ SampleLists(const SampleMark& mark, unsigned masses)
      : positions(reinterpret_cast<float*>(mark.to + sizeof(ReducedSample))),
        velocities(positions + (mark.channels & positions_bit ? 3 * masses : 0)),
        touches(reinterpret_cast<std::uint32_t*>(velocities + (mark.channels & velocities_bit ? 3 * masses : 0))),
        forces(reinterpret_cast<float*>(touches + (mark.channels & contacts_bit ? masses : 0))) {}

  static __device__ __forceinline__ void set(float* list, unsigned masses, unsigned mass, const Vector& vector) {
    list[mass] = static_cast<float>(vector.x);
    list[masses + mass] = static_cast<float>(vector.y);
    list[2 * masses + mass] = static_cast<float>(vector.z);
  }
};

/// Adds a mass to the reduced quantities of a sample, and writes its position and velocity into the lists.
__device__ __forceinline__ void sample_mass(const Sampling& sampling, const SampleMark& mark, const SampleLists& lists,
                                            unsigned mass, const Vector& position, const Vector& velocity,
                                            Reduction& reduction) {
  reduction.add(mark, sampling.mass_share[mass], position, velocity);
  if (mark.channels & positions_bit) SampleLists::set(lists.positions, sampling.masses, mass, position);
  if (mark.channels & velocities_bit) SampleLists::set(lists.velocities, sampling.masses, mass, velocity);
}

/// The same for the number of steps after which the mass touched the ground.
__device__ __forceinline__ void sample_contact(const SampleMark& mark, const SampleLists& lists, unsigned mass,
                                               std::uint32_t steps, Reduction& reduction) {
  if (mark.channels & contact_bit) reduction.add_contact(steps);
  if (mark.channels & contacts_bit) lists.touches[mass] = steps;
}

}  // namespace evodevo::cuda
