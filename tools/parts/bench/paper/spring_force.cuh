// Code that both of the paper's methods share: the force of one spring, the step of one mass, and the table of the
// materials' states over time.
#pragma once

#include "cuda/device/methods/paper_euler.cuh"
#include "paper/formats.hpp"

namespace evodevo::tools::bench {

using cuda::Entry;
using cuda::Number;
using cuda::Point;
using cuda::StepConstants;
using cuda::Vector;

__device__ __forceinline__ Vector triple(const Point<Number>& p) { return {p.x, p.y, p.z}; }

struct Pull {
  Vector force;    // on the spring's end a, N
  Number tension;  // tension of the spring, N
};

__device__ __forceinline__ Pull pull_of(const PaperSpring& spring, Vector a, Vector b, Entry<Number> entry) {
  const auto s = physics::separation(a, b);
  const Number inverse = physics::inverse_length(s);
  const Number factor =
      physics::spring_factor_by_inverse(inverse, entry.stiffness, entry.rest_force * spring.rest_length);
  return {{factor * s.d.x, factor * s.d.y, factor * s.d.z}, factor * physics::length_by_inverse(s, inverse)};
}

/// Moves the mass at `position` by one step; `force` is the sum of its spring forces (N).
__device__ __forceinline__ void move(const StepConstants<Number>& constants, const PaperBatch& batch, unsigned mass,
                                     Vector position, Vector force) {
  cuda::Method::Kept nothing;
  cuda::Moving m{position, triple(batch.velocities[mass]), force, batch.mass[mass], batch.inverse_mass[mass]};
  cuda::Method::move(constants, {}, nothing, m);
  batch.positions[mass] = {m.position.x, m.position.y, m.position.z, 0};
  batch.velocities[mass] = {m.velocity.x, m.velocity.y, m.velocity.z, 0};
}

/// Fills in the material table for `count` steps; `step` is the number of the first of these steps, counted from birth.
extern "C" __global__ void evodevo_paper_table(const StepConstants<Number> constants, const cuda::Actuator* actuators,
                                               unsigned entries, std::uint64_t step, unsigned count,
                                               Entry<Number>* table) {
  for (unsigned i = threadIdx.x; i < count * entries; i += blockDim.x)
    table[i] = cuda::entry_of(actuators[i % entries], static_cast<double>(step + i / entries) * constants.exact_dt);
}

}  // namespace evodevo::tools::bench
