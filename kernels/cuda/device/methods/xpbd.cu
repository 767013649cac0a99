// Extended position-based dynamics: kernels/cpu/methods/xpbd-inl.hpp says what is solved. One block moves a body and
// goes through the colours of its springs one after the other; no two springs of a colour share a mass.
#include "cuda/device/block.cuh"

namespace evodevo::cuda {

/// Gravity, drag and damping, as in symplectic-euler.
__device__ __forceinline__ void fall(const World<Number>& world, const Body& body) {
  for_each_mass(body, [&](unsigned mass) {
    Moving m = moving(body, mass);
    add_gravity(world, m);
    yield_to_drag<true>(world, world.push, m);
    damp(world.decay, m);
    advance_velocity(world.push, m);
    body.velocities[mass] = point(m.velocity);
  });
  __syncthreads();
}

__device__ __forceinline__ void solve_spring(const World<Number>& world, const Body& body, unsigned row,
                                             const ColouredSpring<Number> spring) {
  const Entry<Number> entry = body.table[row * body.entries + spring.entry];
  const Moving a = moving(body, spring.a), b = moving(body, spring.b);
  // not from the places at the end of the step, in which float32 would round the motion off
  const Place apart = difference(b.place, a.place), velocity = difference(b.velocity, a.velocity);
  const auto ends = physics::separation({0, 0, 0}, sum(apart, world.dt, velocity));
  const Number distance = physics::length(ends);
  const Number stretch = distance - relative_length(entry) * spring.rest_length;
  const Number force =
      physics::compliant_force(entry.stiffness, stretch, world.dt * world.push, a.inverse_mass + b.inverse_mass);
  const Number factor = force / distance;
  body.velocities[spring.a] = point(sum(a.velocity, world.push * factor * a.inverse_mass, ends.d));
  body.velocities[spring.b] = point(sum(b.velocity, -world.push * factor * b.inverse_mass, ends.d));
  note(body, row, spring.joint, spring.a, spring.entry, spring.rest_length,
       physics::spring_tension(ends, distance, factor));
}

__device__ __forceinline__ void solve_springs(const World<Number>& world, const Body& body, unsigned row) {
  for (unsigned colour = 0; colour < body.colours; ++colour) {
    const unsigned end = body.first_of_colour[colour + 1];
    for (unsigned i = body.first_of_colour[colour] + threadIdx.x; i < end; i += blockDim.x)
      solve_spring(world, body, row, body.coloured[i]);
    __syncthreads();
  }
}

/// Pushes up what would end below the floor, which is as steep as at the beginning of the step.
__device__ __forceinline__ void solve_floor(const World<Number>& world, Moving& m) {
  if constexpr (floor_on) {
    const Number z = next_clearance(world, m);
    Number inverse_mass = m.inverse_mass;
    if constexpr (rough) inverse_mass *= physics::normal_squared(ground_under(world, m.place));
    m.push = physics::compliant_force(world.floor_stiffness, physics::maximum(-z, Number(0)), world.dt * world.push,
                                      inverse_mass);
    m.velocity.z = physics::advanced_velocity(m.velocity.z, m.push, world.push * m.inverse_mass);
    lean(world, m.place, m.push * (world.push * m.inverse_mass), m.velocity);
  }
}

__device__ __forceinline__ void move(const World<Number>& world, const Body& body) {
  for_each_mass(body, [&](unsigned mass) {
    Moving m = moving(body, mass);
    solve_floor(world, m);
    rub(world.friction_dt, m, m.velocity);
    move_on(world.dt, m);
    store(body, mass, m);
  });
}

/// Makes the steps of leg `index`, the lengths at whose beginning are in the tables' first row.
extern "C" __global__ void __launch_bounds__(EVODEVO_MAX_THREADS)
    evodevo_advance_streamed(const Body* bodies, std::uint64_t index) {
  advance_leg(bodies[blockIdx.x], index, [](const Body& body, unsigned count) {
    for (unsigned step = 0; step < count; ++step) {
      fall(body.world, body);
      solve_springs(body.world, body, step + 1);
      move(body.world, body);
    }
  });
}

}  // namespace evodevo::cuda
