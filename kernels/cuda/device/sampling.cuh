// Code shared by the kernels that sample bodies: which samples are due, sums and extremes over a block, and the lists
// by mass. Samples go directly to the host's memory; no thread waits for these writes.
#pragma once

#include "cuda/device/check.cuh"

namespace evodevo::cuda {

/// The next sample of a body. After the last, it is one that is never reached.
struct NextSample {
  std::uint64_t step;  // of the piece
  unsigned index;      // of its mark

  /// Goes to the first mark after step `done` of the piece.
  __device__ __forceinline__ void seek(const Sampling& sampling, std::uint64_t done) {
    index = 0;
    for (unsigned end = sampling.count; index < end;) {
      const unsigned middle = (index + end) / 2;
      if (sampling.marks[middle].step <= done)
        index = middle + 1;
      else
        end = middle;
    }
    step = sampling.marks[index].step;
  }

  /// Returns the mark, and goes to the one that follows it. Both are read at once.
  __device__ __forceinline__ SampleMark take(const Sampling& sampling) {
    const SampleMark mark = sampling.marks[index];
    step = sampling.marks[++index].step;
    return mark;
  }

  /// The number of steps to the sample, but at most `most`.
  __device__ __forceinline__ unsigned steps_from(std::uint64_t done, unsigned most) const {
    return static_cast<unsigned>(min(static_cast<std::uint64_t>(most), step - done));
  }
};

/// Waits for all warps of the block, which may come from different places in the code. __syncthreads() does not allow
/// that, and costs about 1 % of the time less.
__device__ __forceinline__ void synchronise_warps() { asm volatile("barrier.cta.sync 0;" ::: "memory"); }

struct Add {
  template <class T>
  __device__ __forceinline__ T operator()(T a, T b) const {
    return a + b;
  }
};

struct Larger {
  template <class T>
  __device__ __forceinline__ T operator()(T a, T b) const {
    return fmax(a, b);
  }
};

/// Joins each of eight values over a warp, in a fixed order: lanes exchange half of their values at a time, which takes
/// a fifth of the exchanges of eight separate sums. Lane l returns the result for value l / 4.
template <class T, class Join>
__device__ __forceinline__ T across_warp(T (&values)[8], Join join) {
  constexpr unsigned all = 0xffffffff;
#pragma unroll
  for (unsigned distance = 16, count = 4; count > 0; distance /= 2, count /= 2) {
    const bool upper = threadIdx.x & distance;
#pragma unroll
    for (unsigned i = 0; i < count; ++i) {
      const T sent = upper ? values[i] : values[i + count], kept = upper ? values[i + count] : values[i];
      values[i] = join(kept, __shfl_xor_sync(all, sent, distance));
    }
  }
#pragma unroll
  for (unsigned distance = 2; distance > 0; distance /= 2)
    values[0] = join(values[0], __shfl_xor_sync(all, values[0], distance));
  return values[0];
}

/// Joins each of eight values over the block, in an order that depends only on the block's size, and writes the results
/// to `to`. `nothing` changes no result. One warp joins the results of the warps, while the others go on. Nothing else
/// may use of_warps until the block is synchronised again.
template <class T, class Join>
__device__ __forceinline__ void write_joined(T (&values)[8], Join join, T nothing, unsigned writer, double* to) {
  constexpr unsigned room = sizeof of_warps / (lanes * sizeof(T));  // for so many values of each warp at a time
  T* const shared = reinterpret_cast<T*>(of_warps);
  const unsigned lane = threadIdx.x % lanes, warp = threadIdx.x / lanes, warps = blockDim.x / lanes;
  const bool writes = warp == writer % warps;
  const T of_warp = across_warp(values, join);
#pragma unroll
  for (unsigned first = 0; first < 8; first += room) {
    if (first > 0) synchronise_warps();
    const unsigned i = lane / 4 - first;
    if (lane % 4 == 0 && i < room) shared[warp * room + i] = of_warp;
    synchronise_warps();
    if (!writes) continue;
#pragma unroll
    for (unsigned k = 0; k < room; ++k) values[first + k] = lane < warps ? shared[lane * room + k] : nothing;
  }
  if (!writes) return;
  const T result = across_warp(values, join);
  if (lane % 4 == 0) to[lane / 4] = result;
}

/// A term of a sum, in single precision rounded to a multiple of 2^-36, which is far below the rounding of positions.
/// Sums of such terms of up to 2^15 are exact up to 2^17, so they depend neither on the order of the terms nor on the
/// number of blocks.
__device__ __forceinline__ double exact_term(double term) {
  constexpr double magic = 0x1.8p16;  // its last bit is worth 2^-36
  return sizeof(Number) == sizeof(float) ? (term + magic) - magic : term;
}

/// A thread's contribution to the reduced quantities of a sample.
struct Reduction {
  static constexpr Number lowest = sizeof(Number) == sizeof(float) ? -3.402823466e38 : -1.7976931348623157e308;
  double sums[8] = {};  // as in ReducedSample: centre, work, velocity, contact steps
  Number extremes[8] = {lowest, lowest, lowest, lowest, lowest, lowest, lowest, lowest};  // low (negative), high

  __device__ __forceinline__ void add(const SampleMark& mark, double mass_share, const Vector& position,
                                      const Vector& velocity) {
    const Number x[3] = {position.x, position.y, position.z}, v[3] = {velocity.x, velocity.y, velocity.z};
#pragma unroll
    for (unsigned i = 0; i < 3; ++i) {
      if (mark.channels & centre_bit)
        sums[i] += exact_term(mass_share * x[i]), sums[4 + i] += exact_term(mass_share * v[i]);
      if (mark.channels & box_bit)
        extremes[i] = fmax(extremes[i], -x[i]), extremes[4 + i] = fmax(extremes[4 + i], x[i]);
    }
  }
  /// Adds work, J.
  __device__ __forceinline__ void add_work(double joules) { sums[3] += joules; }
  __device__ __forceinline__ void add_contact(std::uint32_t steps) { sums[7] += steps; }

  static __device__ __forceinline__ bool has_sums(const SampleMark& mark) {
    return mark.channels & (centre_bit | contact_bit | work_bit);
  }
  static __device__ __forceinline__ bool has_extremes(const SampleMark& mark) { return mark.channels & box_bit; }

  /// Writes the sums, or extremes, of all threads of the block. Nothing else may use of_warps until the block is
  /// synchronised again.
  __device__ __forceinline__ void write_sums(double* to) { write_joined(sums, Add(), 0.0, 0, to); }
  __device__ __forceinline__ void write_extremes(double* to) { write_joined(extremes, Larger(), lowest, 1, to); }

  /// Writes the sums and extremes of all threads of the block into the sample, likewise.
  __device__ __forceinline__ void write(const SampleMark& mark) {
    auto* to = reinterpret_cast<ReducedSample*>(mark.to);
    if (has_sums(mark)) write_sums(to->centre);
    if (has_sums(mark) && has_extremes(mark)) synchronise_warps();
    if (has_extremes(mark)) write_extremes(to->low);
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

/// Adds a mass to the reduced quantities of a sample, and writes its position and velocity into the lists. `mass` is
/// its index in the part of the body that a block simulates, `of_body` that in the lists.
__device__ __forceinline__ void sample_mass(const Sampling& sampling, const SampleMark& mark, const SampleLists& lists,
                                            unsigned mass, unsigned of_body, const Vector& position,
                                            const Vector& velocity, Reduction& reduction) {
  reduction.add(mark, sampling.mass_share[mass], position, velocity);
  if (mark.channels & positions_bit) SampleLists::set(lists.positions, sampling.masses, of_body, position);
  if (mark.channels & velocities_bit) SampleLists::set(lists.velocities, sampling.masses, of_body, velocity);
}

/// The same for the number of steps after which the mass touched the ground.
__device__ __forceinline__ void sample_contact(const SampleMark& mark, const SampleLists& lists, unsigned mass,
                                               std::uint32_t steps, Reduction& reduction) {
  if (mark.channels & contact_bit) reduction.add_contact(steps);
  if (mark.channels & contacts_bit) lists.touches[mass] = steps;
}

}  // namespace evodevo::cuda
