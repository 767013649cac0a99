// Bodies that are too large for the chip. Their state is in the device's memory, and every pass over the springs is a
// launch over the masses of all these bodies:
//
//   positions, velocities ─► spring_forces (gathered by each mass) ─► Method::move ─► positions, velocities
//
// A mass gathers the forces of its springs in a fixed order, so each spring is computed twice.
#include EVODEVO_METHOD
#include "cuda/device/streamed.cuh"

namespace evodevo::cuda {

static_assert(sizeof(Method::Kept) <= (EVODEVO_NUMBERS_OF_MASS > 0 ? EVODEVO_NUMBERS_OF_MASS * sizeof(Number) : 1));

/// The sum of the spring forces on a mass, N. If `recorded`, adds to the records of the springs that the mass owns.
__device__ __forceinline__ Vector spring_forces(const Body& body, unsigned mass, const Point<Number>* positions,
                                                unsigned row, bool recorded) {
  const Entry<Number>* table = body.table + row * body.entries;
  const Vector own = triple(positions[mass]);
  Vector force{0, 0, 0};
  Number power = 0;
  for_each_joint(body, mass, [&](unsigned i, const Joint<Number> joint) {
    const Entry<Number> entry = table[joint.entry];
    const auto s = physics::separation(own, triple(positions[joint.other]));
    const Number inverse = physics::inverse_length(s);
    const Number factor =
        physics::spring_factor_by_inverse(inverse, entry.stiffness, entry.rest_force * joint.rest_length);
    if (joint.owned && recorded) {
      const Number tension = factor * physics::length_by_inverse(s, inverse);
      if constexpr (stress) body.stress[i] += fabs(tension);
      if constexpr (work) {
        const Number watts =
            physics::actuation_power(tension, body.rates[row * body.entries + joint.entry] * joint.rest_length);
        power += watts;
        if constexpr (muscle_work) body.powers[i] += watts;
      }
      if constexpr (peak_force) body.peak[i] = fmax(body.peak[i], fabs(tension));
      if constexpr (mean_tension) body.tensions[i] += tension;
    }
    force.x = physics::multiply_add(factor, s.d.x, force.x);
    force.y = physics::multiply_add(factor, s.d.y, force.y);
    force.z = physics::multiply_add(factor, s.d.z, force.z);
  });
  if constexpr (work) body.power[mass] += power;
  return force;
}

/// Computes pass `pass` of check span `index` for all bodies whose span has that pass. The tables hold the lengths of
/// this span. Counted from the beginning of the piece, even passes read the first half of the positions and write the
/// second; odd passes do the reverse.
extern "C" __global__ void evodevo_pass_streamed(const Body* bodies, std::uint64_t index, unsigned pass) {
  const Body& body = bodies[blockIdx.y];
  const unsigned mass = blockIdx.x * blockDim.x + threadIdx.x;
  const CheckSpan span(body.piece, index);
  if (mass >= body.masses || pass >= span.passes() || body.answer->diverged) return;
  const auto half = static_cast<unsigned>((passes_before(span, index) + pass) % 2);
  const Point<Number>* from = body.positions + half * body.masses;
  const Vector position = triple(from[mass]), velocity = triple(body.velocities[mass]);
  const Vector force = spring_forces(body, mass, from, Method::row(pass), Method::is_recorded(pass));
  Moving m{position, velocity, force, body.mass[mass], body.inverse_mass[mass]};
  Method::move(body.constants, {pass, pass + 1 == span.passes()}, reinterpret_cast<Method::Kept*>(body.scratch)[mass],
               m);
  body.positions[(1 - half) * body.masses + mass] = point(m.position);
  body.velocities[mass] = point(m.velocity);
}

}  // namespace evodevo::cuda
