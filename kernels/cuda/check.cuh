// How both kernels look for bodies that have diverged.
#pragma once

#include "cuda/mass_step.cuh"

namespace evodevo::cuda {

/// The sums of some values over the block, in an order that depends on nothing but its size; for thread 0.
template <unsigned count>
__device__ void block_sum(double (&values)[count]) {
  __shared__ double of_warp[count][lanes];
  const unsigned lane = threadIdx.x % lanes, warp = threadIdx.x / lanes;
  const auto add_lanes = [](double value) {
    for (unsigned distance = lanes / 2; distance > 0; distance /= 2)
      value += __shfl_down_sync(0xffffffffu, value, distance);
    return value;
  };
  for (unsigned i = 0; i < count; ++i) {
    const double sum = add_lanes(values[i]);
    if (lane == 0) of_warp[i][warp] = sum;
  }
  __syncthreads();
  if (warp > 0) return;
  for (unsigned i = 0; i < count; ++i) values[i] = add_lanes(lane < blockDim.x / lanes ? of_warp[i][lane] : 0);
}

/// 0 where a place and a velocity are finite: zero times anything finite is zero, and a sum with one that is not stays
/// so.
__device__ __forceinline__ Number not_finite(const Place& place, const Place& velocity) {
  return Number(0) * ((place.x + place.y + place.z) + (velocity.x + velocity.y + velocity.z));
}

/// EnergyGuard's verdict. `moment`: the sum of mass times z, kg m.
__device__ __forceinline__ bool gained_energy(double energy, double moment, double bound, const World<Number>& world) {
  const double fallen = gravity ? -static_cast<double>(world.acceleration) * moment : 0;
  return !(energy <= bound + physics::maximum(0.0, fallen));
}

}  // namespace evodevo::cuda
