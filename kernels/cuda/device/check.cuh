// Code shared by the checks for divergence: sums over a block, and the energy guard (analysis/guard.hpp).
#pragma once

#include "cuda/device/mass_step.cuh"

namespace evodevo::cuda {

__device__ __forceinline__ double warp_sum(double value) {
  for (unsigned distance = lanes / 2; distance > 0; distance /= 2)
    value += __shfl_down_sync(0xffffffffu, value, distance);
  return value;
}

/// Values of up to 32 warps, for sums over the block.
__shared__ double of_warps[4][lanes];

/// The sum of a value over the block, in an order that depends only on the block's size; thread 0 gets the result.
/// `values` is shared memory that nothing else may use until the block is synchronised again.
__device__ inline double block_sum(double value, double (&values)[lanes]) {
  const unsigned lane = threadIdx.x % lanes, warp = threadIdx.x / lanes;
  const double sum = warp_sum(value);
  if (lane == 0) values[warp] = sum;
  __syncthreads();
  return warp > 0 ? 0 : warp_sum(lane < blockDim.x / lanes ? values[lane] : 0);
}

/// The sum of a value over the block, in the same order; all threads get the result. Synchronises the block before and
/// after.
__device__ inline double sum_for_all(double value) {
  double& total = of_warps[1][0];
  const double sum = block_sum(value, of_warps[0]);
  if (threadIdx.x == 0) total = sum;
  __syncthreads();
  return total;
}

/// 0 if a position and a velocity are finite, otherwise NaN: zero times a finite number is 0, and zero times infinity
/// or NaN is NaN.
__device__ __forceinline__ Number not_finite(const Vector& position, const Vector& velocity) {
  return Number(0) * ((position.x + position.y + position.z) + (velocity.x + velocity.y + velocity.z));
}

/// A mass's contribution to the sum of mass times height, kg m. In single precision it is rounded to a multiple of
/// 2^-26, so that sums up to 2^27 do not depend on the order of their terms.
template <class T>
__device__ __forceinline__ double height_moment_of(T mass, const Vector& position, const StepConstants<T>& constants) {
  static_assert(only_for<gravity, T>);
  double height = position.z;
  if constexpr (slope) height = physics::height<double>(position.x, position.z, constants.grade);
  constexpr double magic = 0x1.8p26;  // its last bit is worth 2^-26
  return sizeof(Number) == sizeof(float) ? (mass * height + magic) - magic : mass * height;
}

/// Whether a body is checked after `steps` steps of its piece.
__device__ __forceinline__ bool is_checked(const RunPiece& piece, std::uint64_t steps) {
  return (piece.since_check + steps) % guard_interval == 0 || (piece.is_last && steps == piece.steps);
}

/// The number of steps of a piece before check span `index` (streamed.cuh).
__device__ __forceinline__ std::uint64_t steps_before_span(const RunPiece& piece, std::uint64_t index) {
  return index == 0 ? 0 : min(index * guard_interval - piece.since_check, piece.steps);
}

/// Updates the largest energy that the body has lost by falling below the origin. `height_moment` is the sum of mass
/// times height, kg m.
template <class T>
__device__ __forceinline__ void record_fall(double height_moment, const StepConstants<T>& constants, Answer& answer) {
  static_assert(only_for<gravity, T>);
  answer.fallen = physics::maximum(answer.fallen, -static_cast<double>(constants.acceleration) * height_moment);
}

/// Whether a body exceeds the energy limit. The answer has its energies and its number of steps.
__device__ __forceinline__ bool has_gained(const RunPiece& piece, const StepConstants<Number>& constants,
                                           const Answer& answer) {
  const double elapsed = static_cast<double>(piece.first_step + answer.steps) * constants.exact_dt;
  return !(answer.kinetic + answer.elastic <= piece.bound.limit(elapsed, answer.fallen));
}

}  // namespace evodevo::cuda
