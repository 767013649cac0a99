// What the methods share that move a whole body in one thread block, its state in the device's memory.
#pragma once

#include "cuda/streamed.cuh"

namespace evodevo::cuda {

/// a - b
__device__ __forceinline__ Place difference(const Place& a, const Place& b) { return sum(a, Number(-1), b); }

/// Calls function(mass) for the masses of a thread.
template <class Function>
__device__ __forceinline__ void for_each_mass(const Body& body, const Function& function) {
  for (unsigned mass = threadIdx.x; mass < body.masses; mass += blockDim.x) function(mass);
}

__device__ __forceinline__ Moving moving(const Body& body, unsigned mass) {
  return {
      triple(body.places[mass]), triple(body.velocities[mass]), {0, 0, 0}, body.mass[mass], body.inverse_mass[mass]};
}

__device__ __forceinline__ void store(const Body& body, unsigned mass, const Moving& m) {
  body.places[mass] = point(m.place);
  body.velocities[mass] = point(m.velocity);
}

/// Adds a spring's tension (N) to the sums of stress, at `joint`, and of power, at `mass`.
__device__ __forceinline__ void note(const Body& body, unsigned row, unsigned joint, unsigned mass, unsigned entry,
                                     Number rest_length, Number tension) {
  if constexpr (stress) body.stress[joint] += fabs(tension);
  if constexpr (work)
    body.power[mass] += physics::actuation_power(tension, body.rates[row * body.entries + entry] * rest_length);
}

}  // namespace evodevo::cuda
