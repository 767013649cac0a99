// Samples of bodies in the device's memory, taken by one block for each body.
#pragma once

#include "cuda/device/sampling.cuh"
#include "cuda/device/streamed/streamed.cuh"

namespace evodevo::cuda {

/// The motion of a mass at the end of a step.
struct MassAtEnd {
  Vector position, velocity;
  double power = 0;  // of its springs since the last check, W
};

/// Writes the forces of the springs that a mass owns into a sample (N), without those of their dashpots, in the order
/// of the joints.
__device__ __forceinline__ void write_forces(const Body& body, const Point<Number>* positions, unsigned row,
                                             unsigned mass, float* to) {
  const Vector own = triple(positions[mass]);
  for_each_joint(body, mass, [&](unsigned i, const Joint<Number> joint) {
    if (!joint.owned) return;
    const Entry<Number> entry = body.table[row * body.entries + joint.entry];
    const auto s = physics::separation(own, triple(positions[joint.other]));
    const Number inverse = physics::inverse_length(s);
    const Number factor =
        physics::spring_factor_by_inverse(inverse, entry.stiffness, entry.rest_force * joint.rest_length);
    to[i] = static_cast<float>(factor * physics::length_by_inverse(s, inverse));
  });
}

/// Takes the samples that are due after `done` steps. Row `row` of the tables holds the present lengths; at_end(mass)
/// returns a MassAtEnd. Nothing else may use of_warps until the block is synchronised again.
template <class AtEnd>
__device__ __forceinline__ void take_samples(const Body& body, const Point<Number>* positions, unsigned row,
                                             const AtEnd& at_end, std::uint64_t done, NextSample& next) {
  const Sampling& sampling = body.sampling;
  while (next.step == done) {
    const SampleMark mark = next.take(sampling);
    const SampleLists lists(mark, sampling.masses);
    Reduction reduction;
    for (unsigned mass = threadIdx.x; mass < body.masses; mass += blockDim.x) {
      const MassAtEnd at = at_end(mass);
      sample_mass(sampling, mark, lists, mass, mass, at.position, at.velocity, reduction);
      if constexpr (contacts) sample_contact(mark, lists, mass, sampling.contact_steps[mass], reduction);
      if constexpr (work) reduction.add_work(body.constants.exact_dt * at.power);
      if (mark.channels & forces_bit) write_forces(body, positions, row, mass, lists.forces);
    }
    if constexpr (work)
      if (threadIdx.x == 0) reduction.add_work(body.answer->work);
    reduction.write(mark);
    __syncthreads();
  }
}

}  // namespace evodevo::cuda
