// Bodies that are too large for the chip: their state lies in the device's memory, and every pass over the springs is
// one launch over the masses of all of them. Each mass gathers the forces of its springs in a fixed order, so each
// spring is computed twice.
#include EVODEVO_METHOD
#include "cuda/streamed.cuh"

namespace evodevo::cuda {

static_assert(sizeof(Method::Kept) <= (EVODEVO_NUMBERS_OF_MASS > 0 ? EVODEVO_NUMBERS_OF_MASS * sizeof(Number) : 1));

/// The sum of the spring forces at a mass, N. Adds to the sums of stress and power where the pass is `noted`.
__device__ __forceinline__ Place spring_forces(const Body& body, unsigned mass, const Point<Number>* places,
                                               unsigned row, bool noted) {
  const Entry<Number>* table = body.table + row * body.entries;
  const Place own = triple(places[mass]);
  Place force{0, 0, 0};
  Number power = 0;
  for_each_joint(body, mass, [&](unsigned i, const Joint<Number> joint) {
    const Entry<Number> entry = table[joint.entry];
    const auto s = physics::separation(own, triple(places[joint.other]));
    const Number inverse = physics::inverse_length(s);
    const Number factor =
        physics::spring_factor_by_inverse(inverse, entry.stiffness, entry.rest_force * joint.rest_length);
    if (joint.owned && noted) {
      const Number tension = factor * physics::length_by_inverse(s, inverse);
      if constexpr (stress) body.stress[i] += fabs(tension);
      if constexpr (work)
        power += physics::actuation_power(tension, body.rates[row * body.entries + joint.entry] * joint.rest_length);
    }
    force.x = physics::multiply_add(factor, s.d.x, force.x);
    force.y = physics::multiply_add(factor, s.d.y, force.y);
    force.z = physics::multiply_add(factor, s.d.z, force.z);
  });
  if constexpr (work) body.power[mass] += power;
  return force;
}

/// Whether a body makes pass `index` of those from step `done` to the next check.
__device__ __forceinline__ bool has_pass(const Body& body, std::uint64_t done, unsigned index) {
  if (opening_passes > 0 && done >= body.steps) return false;
  return done * passes_per_step + index < opening_passes + body.steps * passes_per_step;
}

/// Makes pass `index` of the steps from the `done`-th on, whose lengths begin with the tables, for all bodies that have
/// as many. Even passes of a run read the first half of the places and write the second, odd ones the other way.
extern "C" __global__ void evodevo_pass_streamed(const Body* bodies, std::uint64_t done, unsigned index) {
  const Body& body = bodies[blockIdx.y];
  const unsigned mass = blockIdx.x * blockDim.x + threadIdx.x;
  if (mass >= body.masses || !has_pass(body, done, index) || body.answer->diverged) return;
  const auto half = static_cast<unsigned>((passes_in(done) + index) % 2);
  const bool is_last = index + 1 == passes_in(guard_interval) || !has_pass(body, done, index + 1);
  const Point<Number>* from = body.places + half * body.masses;
  const Place place = triple(from[mass]), velocity = triple(body.velocities[mass]);
  const Place force = spring_forces(body, mass, from, Method::row(index), Method::is_noted(index));
  Moving m{place, velocity, force, body.mass[mass], body.inverse_mass[mass]};
  Method::move(body.world, {index, is_last}, reinterpret_cast<Method::Kept*>(body.scratch)[mass], m);
  body.places[(1 - half) * body.masses + mass] = point(m.place);
  body.velocities[mass] = point(m.velocity);
}

}  // namespace evodevo::cuda
