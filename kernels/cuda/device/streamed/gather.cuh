// The spring forces on a mass of a body in the device's memory, for explicit methods. The mass gathers them in a fixed
// order, so each spring is computed twice.
#pragma once

#include "cuda/device/streamed/streamed.cuh"

namespace evodevo::cuda {

/// The forces of the springs of a mass.
struct SpringForces {
  Vector sum{0, 0, 0};  // N
  Number power = 0;     // of the springs that the mass owns, W; 0 if the pass is not recorded
};

/// The forces of the springs of a mass, from half `half` of the positions and of the velocities at which dashpots act.
/// If `recorded` and `keep`, adds to the records of the springs that the mass owns.
template <bool keep>
__device__ __forceinline__ SpringForces spring_forces(const Body& body, unsigned mass, unsigned half, unsigned row,
                                                      bool recorded) {
  const Entry<Number>* table = body.table + row * body.entries;
  const Point<Number>* positions = body.positions + half * body.masses;
  const Point<Number>* velocities = nullptr;
  if constexpr (dashpots) velocities = body.dashpot_velocities + half * body.masses;
  const Vector own = triple(positions[mass]);
  SpringForces forces;
  for_each_joint(body, mass, [&](unsigned i, const Joint<Number> joint) {
    const Entry<Number> entry = table[joint.entry];
    const auto s = physics::separation(own, triple(positions[joint.other]));
    const Number inverse = physics::inverse_length(s);
    Number factor = physics::spring_factor_by_inverse(inverse, entry.stiffness, entry.rest_force * joint.rest_length);
    const Number pull = factor * physics::length_by_inverse(s, inverse);  // of the spring alone
    if constexpr (dashpots) {
      const Vector velocity = difference(triple(velocities[joint.other]), triple(velocities[mass]));
      factor += physics::dashpot_factor_by_inverse(s, inverse, body.dashpots[joint.entry], velocity);
    }
    if (joint.owned && recorded) {
      const Number tension = factor * physics::length_by_inverse(s, inverse);
      if constexpr (stress && keep) body.stress[i] += fabs(tension);
      if constexpr (work) {
        const Number watts =
            physics::actuation_power(pull, body.rates[row * body.entries + joint.entry] * joint.rest_length);
        forces.power += watts;
        if constexpr (muscle_work && keep) body.powers[i] += watts;
      }
      if constexpr (peak_force && keep) body.peak[i] = fmax(body.peak[i], fabs(tension));
      if constexpr (mean_tension && keep) body.tensions[i] += tension;
    }
    forces.sum.x = physics::multiply_add(factor, s.d.x, forces.sum.x);
    forces.sum.y = physics::multiply_add(factor, s.d.y, forces.sum.y);
    forces.sum.z = physics::multiply_add(factor, s.d.z, forces.sum.z);
  });
  return forces;
}

}  // namespace evodevo::cuda
