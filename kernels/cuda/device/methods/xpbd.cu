// xpbd: extended position-based dynamics. kernels/cpu/methods/xpbd.cpp describes it. One block simulates a body and
// solves the colours of its springs one after the other; no two springs of a colour share a mass.
//
//   apply_gravity   velocities ─► predicted velocities
//   solve_springs   colour by colour: velocities ─► corrected velocities; records of the springs
//   move            floor, friction ─► velocities, positions
#include "cuda/device/streamed/block.cuh"

namespace evodevo::cuda {

/// Predicts the velocities: applies gravity, drag and damping as symplectic-euler does.
__device__ __forceinline__ void apply_gravity(const StepConstants<Number>& constants, const Body& body) {
  for_each_mass(body, [&](unsigned mass) {
    Moving m = moving(body, mass);
    note_arrival(constants, m.velocity, m);
    if constexpr (rigid_floor) body.scratch[mass] = m.arrival;
    add_gravity(constants, m);
    apply_drag<true>(constants, constants.damped_dt, m);
    damp(constants.decay, m);
    advance_velocity(constants.damped_dt, m);
    body.velocities[mass] = point(m.velocity);
  });
  __syncthreads();
}

__device__ __forceinline__ void solve_spring(const StepConstants<Number>& constants, const Body& body, unsigned row,
                                             const ColouredSpring<Number> spring) {
  const Entry<Number> entry = body.table[row * body.entries + spring.entry];
  const Moving a = moving(body, spring.a), b = moving(body, spring.b);
  // x and v are subtracted separately: in float32, rounding of positions at the end of the step would hide the motion
  const Vector apart = difference(b.position, a.position), velocity = difference(b.velocity, a.velocity);
  const auto ends = physics::separation({0, 0, 0}, sum(apart, constants.dt, velocity));
  const Number distance = physics::length(ends);
  const Number stretch = distance - relative_length(entry) * spring.rest_length;
  const Number inverse_mass = a.inverse_mass + b.inverse_mass;
  Number force = physics::compliant_force(entry.stiffness, stretch, constants.dt * constants.damped_dt, inverse_mass);
  Number of_spring = force;
  if constexpr (dashpots) {
    const Number along =
        physics::multiply_add(ends.d.z, velocity.z, physics::multiply_add(ends.d.y, velocity.y, ends.d.x * velocity.x));
    force = physics::damped_force(entry.stiffness, body.dashpots[spring.entry], stretch, along / distance, constants.dt,
                                  constants.damped_dt, inverse_mass);
    of_spring = entry.stiffness * (stretch - force * constants.dt * constants.damped_dt * inverse_mass);
  }
  const Number factor = force / distance;
  body.velocities[spring.a] = point(sum(a.velocity, constants.damped_dt * factor * a.inverse_mass, ends.d));
  body.velocities[spring.b] = point(sum(b.velocity, -constants.damped_dt * factor * b.inverse_mass, ends.d));
  record(body, row, spring.joint, spring.a, spring.entry, spring.rest_length,
         physics::spring_tension(ends, distance, factor),
         physics::spring_tension(ends, distance, of_spring / distance));
}

__device__ __forceinline__ void solve_springs(const StepConstants<Number>& constants, const Body& body, unsigned row) {
  for (unsigned colour = 0; colour < body.colours; ++colour) {
    const unsigned end = body.first_of_colour[colour + 1];
    for (unsigned i = body.first_of_colour[colour] + threadIdx.x; i < end; i += blockDim.x)
      solve_spring(constants, body, row, body.coloured[i]);
    __syncthreads();
  }
}

/// Solves an elastic floor: pushes up a mass that would end the step below it. The slope is that at the beginning of
/// the step.
__device__ __forceinline__ void solve_floor(const StepConstants<Number>& constants, Moving& m) {
  if constexpr (elastic_floor) {
    const Number z = next_clearance(constants, m);
    Number inverse_mass = m.inverse_mass;
    if constexpr (rough) inverse_mass *= physics::normal_squared(ground_under(constants, m.position));
    m.normal_force = physics::compliant_force(constants.floor_stiffness, physics::maximum(-z, Number(0)),
                                              constants.dt * constants.damped_dt, inverse_mass);
    m.velocity.z = physics::advanced_velocity(m.velocity.z, m.normal_force, constants.damped_dt * m.inverse_mass);
    add_horizontal_part(constants, m.position, m.normal_force * (constants.damped_dt * m.inverse_mass), m.velocity);
  }
}

__device__ __forceinline__ void move(const StepConstants<Number>& constants, const Body& body) {
  for_each_mass(body, [&](unsigned mass) {
    Moving m = moving(body, mass);
    solve_floor(constants, m);
    if constexpr (rigid_floor) m.arrival = body.scratch[mass];
    land(constants, m);
    apply_friction(constants, 1, m, m.velocity);
    advance_position(constants.dt, m);
    store(body, mass, m);
    count_contact(body, mass, m);
  });
}

/// Computes the steps of check span `index`. Row 0 of the tables holds the lengths at its beginning.
extern "C" __global__ void __launch_bounds__(EVODEVO_MAX_THREADS)
    evodevo_advance_streamed(const Body* bodies, std::uint64_t index) {
  advance_span(bodies[blockIdx.x], index, [](const Body& body, unsigned count, Samples& samples) {
    for (unsigned step = 0; step < count; ++step) {
      apply_gravity(body.constants, body);
      solve_springs(body.constants, body, step + 1);
      move(body.constants, body);
      end_step(body, step + 1, samples);
    }
  });
}

}  // namespace evodevo::cuda
