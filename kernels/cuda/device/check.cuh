// How both kernels look for bodies that have diverged.
#pragma once

#include "cuda/device/mass_step.cuh"

namespace evodevo::cuda {

__device__ __forceinline__ double warp_sum(double value) {
  for (unsigned distance = lanes / 2; distance > 0; distance /= 2)
    value += __shfl_down_sync(0xffffffffu, value, distance);
  return value;
}

/// The sum of a value over the block, in an order that depends on nothing but its size; for thread 0. `of_warps` is
/// shared memory that nothing else uses until the block is synchronised again.
__device__ inline double block_sum(double value, double (&of_warps)[lanes]) {
  const unsigned lane = threadIdx.x % lanes, warp = threadIdx.x / lanes;
  const double sum = warp_sum(value);
  if (lane == 0) of_warps[warp] = sum;
  __syncthreads();
  return warp > 0 ? 0 : warp_sum(lane < blockDim.x / lanes ? of_warps[lane] : 0);
}

/// The sum of a value over the block, in such an order; for all threads. Synchronises the block before and after.
__device__ inline double sum_for_all(double value) {
  __shared__ double of_warps[lanes], total;
  const double sum = block_sum(value, of_warps);
  if (threadIdx.x == 0) total = sum;
  __syncthreads();
  return total;
}

/// 0 where a place and a velocity are finite: zero times anything finite is zero, and a sum with one that is not stays
/// so.
__device__ __forceinline__ Number not_finite(const Place& place, const Place& velocity) {
  return Number(0) * ((place.x + place.y + place.z) + (velocity.x + velocity.y + velocity.z));
}

/// A mass's part of the moment, kg m: mass times height.
__device__ __forceinline__ double moment_of(Number mass, const Place& place, const World<Number>& world) {
  double height = place.z;
  if constexpr (slope) height = physics::height<double>(place.x, place.z, world.grade);
  return mass * height;
}

/// Whether a body is checked after `steps` steps of its stretch.
__device__ __forceinline__ bool is_checked(const Stretch& stretch, std::uint64_t steps) {
  return (stretch.since_check + steps) % guard_interval == 0 || (stretch.is_last && steps == stretch.steps);
}

/// Writes down what falling below the origin has set free at most. `moment`: the sum of mass times height, kg m.
__device__ __forceinline__ void note_fall(double moment, const World<Number>& world, Answer& answer) {
  answer.fallen = physics::maximum(answer.fallen, -static_cast<double>(world.acceleration) * moment);
}

/// Whether a checked body, whose energies and steps are in its answer, has gained energy from nothing.
__device__ __forceinline__ bool has_gained(const Stretch& stretch, const World<Number>& world, const Answer& answer) {
  const double elapsed = static_cast<double>(stretch.first_step + answer.steps) * world.exact_dt;
  return !(answer.kinetic + answer.elastic <= stretch.bound.limit(elapsed, answer.fallen));
}

}  // namespace evodevo::cuda
