// implicit: linearised backward Euler, solved by conjugate gradients. kernels/cpu/methods/implicit-inl.hpp states the
// equation. One block simulates a body:
//
//   begin   positions, velocities ─► the equation, its residual for zero correction
//   solve   equation ─► correction of the velocities
//   move    correction ─► velocities, positions
//
// Every mass gathers from its springs in a fixed order, and scalar products are summed in a fixed order.
#include "cuda/device/streamed/block.cuh"

namespace evodevo::cuda {

// the same numbers as on the CPU
constexpr double tolerance = sizeof(Number) == sizeof(float) ? 1e-4 : 1e-6;
constexpr int most_iterations = 500;

/// K+ of a spring, aligned so that it is read and written by single instructions.
struct alignas(4 * sizeof(Number)) Stiffness : physics::SpringStiffness<Number> {};

/// The solver's memory.
struct Memory {
  Point<Number>*residual, *correction;
  Point<Number>* applied;           // the matrix times the direction
  Point<Number>* inverse_diagonal;  // the preconditioner: 1/(diagonal of the matrix); 0 for fixed masses
  Point<Number>* resistance;        // R, kg/s
  Point<Number>* direction;         // on the chip if there is room, because neighbours read it
  Stiffness* stiffness;             // [joints]
  std::uint32_t* other;  // [joints] the mass at the other end: a copy, because reading whole joints would take longer

  __device__ __forceinline__ explicit Memory(const Body& body)
      : residual(reinterpret_cast<Point<Number>*>(body.scratch)),
        correction(residual + body.masses),
        applied(correction + body.masses),
        inverse_diagonal(applied + body.masses),
        resistance(inverse_diagonal + body.masses),
        direction(body.on_chip ? points_on_chip(body, 2) : resistance + body.masses),
        stiffness(reinterpret_cast<Stiffness*>(resistance + 2 * body.masses)),
        other(reinterpret_cast<std::uint32_t*>(stiffness + body.first_row[(body.masses + lanes - 1) / lanes] * lanes)) {
  }
};
static_assert(6 * sizeof(Point<Number>) == EVODEVO_NUMBERS_OF_MASS * sizeof(Number));
static_assert(sizeof(Stiffness) + sizeof(Number) == EVODEVO_NUMBERS_OF_JOINT * sizeof(Number));

/// The component-wise product.
__device__ __forceinline__ Vector product(const Vector& a, const Vector& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}

__device__ __forceinline__ Number dot(const Vector& a, const Vector& b) {
  return physics::multiply_add(a.z, b.z, physics::multiply_add(a.y, b.y, a.x * b.x));
}

/// Returns R (kg/s) and adds the force of an elastic floor at the present position to the force.
__device__ __forceinline__ Vector resistance_of(const StepConstants<Number>& constants, Moving& m) {
  Number across = 0, touching = 0;
  if constexpr (drag) across = -physics::drag_factor(constants.drag_coefficient, m.velocity);
  if constexpr (elastic_floor) {
    touching = physics::zero_unless_greater(-next_clearance(constants, m), Number(0), constants.floor_stiffness);
    const Number above = clearance(constants, m.position);
    m.force.z = physics::negative_multiply_add(touching, above, m.force.z);
    add_horizontal_part(constants, m.position, -touching * above, m.force);
  }
  return {across, across, physics::multiply_add(constants.dt, touching, across)};
}

/// R times the vector v.
__device__ __forceinline__ Vector resisted(const StepConstants<Number>& constants, const Vector& position,
                                           const Vector& resistance, const Vector& v) {
  Vector all = product(resistance, v);
  if constexpr (rough) {
    // rough ground pushes along its normal instead of along z
    const Number touching = resistance.z - resistance.x;
    const Number up = touching * normal_velocity(constants, position, v);
    all.z += up - touching * v.z;
    add_horizontal_part(constants, position, up, all);
  }
  return all;
}

/// Adds the springs' forces F to the force and their -K u, with u the damped velocity, to `rate` (N/s), and sets K+.
/// Returns the diagonal of K+, N/m.
__device__ __forceinline__ Vector add_springs(const StepConstants<Number>& constants, const Body& body,
                                              const Memory& memory, unsigned row, unsigned mass, Moving& m,
                                              Vector& rate) {
  Vector diagonal{0, 0, 0};
  for_each_joint(body, mass, [&](unsigned i, const Joint<Number> joint) {
    const Entry<Number> entry = body.table[row * body.entries + joint.entry];
    Moving other = moving(body, joint.other);
    damp(constants.decay, other);
    const auto s = physics::separation(m.position, other.position);
    const Number distance = physics::length(s);
    const Number factor =
        physics::spring_factor_by_inverse(1 / distance, entry.stiffness, entry.rest_force * joint.rest_length);
    Number damping = 0;  // N/m: the dashpot acts as if the spring were stiffer along its direction
    if constexpr (dashpots) damping = body.dashpots[joint.entry] / constants.dt;
    const auto matrix = physics::spring_stiffness(s, distance, entry.stiffness + damping, factor);
    memory.stiffness[i] = {matrix};
    memory.other[i] = joint.other;
    diagonal = sum(diagonal, Number(1), product(matrix.along, matrix.along));
    diagonal = sum(diagonal, matrix.transverse, {1, 1, 1});
    m.force = sum(m.force, factor, s.d);
    const Vector velocity = difference(other.velocity, m.velocity);
    rate = sum(rate, Number(1), physics::spring_force_rate(s, entry.stiffness, factor, velocity));
    if constexpr (dashpots) rate = sum(rate, physics::dashpot_factor(s, damping, velocity), s.d);
  });
  return diagonal;
}

/// The rise of a mass after its contact with a rigid floor, m/s.
__device__ __forceinline__ Number rise_after(const StepConstants<Number>& constants,
                                             const physics::Ground<Number>& ground, const Moving& m) {
  const Number lowest = physics::lowest_rise(m.position.z - ground.height, constants.dt);
  return physics::rise_after_contact(lowest, physics::bounce(constants.restitution, m.arrival));
}

/// Adds the force with which a rigid floor holds a mass in this step, if it does, and returns the stiffness of that
/// hold (N/m) or 0. kernels/cpu/methods/implicit_floor-inl.hpp says which masses are held.
__device__ __forceinline__ Number hold(const StepConstants<Number>& constants, Moving& m) {
  const auto ground = ground_of(constants, m.position);
  const Number dt = constants.dt, clearance = m.position.z - ground.height;
  const Number rise = physics::multiply_add(dt * m.inverse_mass, physics::along_normal(ground, m.force), m.arrival);
  const Number lowest = physics::lowest_rise(clearance, dt);
  const bool is_near = physics::multiply_add(dt, m.arrival, clearance) < Number(1e-3) * dt;
  if (!(is_near && lowest > rise)) return 0;
  const Number stiffness = Number(1e4) / (dt * dt) * m.mass;
  m.force = physics::add_along_normal(ground, m.force, stiffness * dt * rise_after(constants, ground, m));
  return stiffness;
}

/// The correction that gives a mass that a rigid floor holds the rise after its contact; zero for other masses.
/// `resistance` is R.
__device__ __forceinline__ Vector rise_correction(const StepConstants<Number>& constants, const Moving& m,
                                                  const Vector& resistance) {
  Vector correction{0, 0, 0};
  if (!(resistance.z > resistance.x)) return correction;
  const auto ground = ground_of(constants, m.position);
  push_off(ground, rise_after(constants, ground, m) - physics::along_normal(ground, m.velocity), correction);
  return correction;
}

/// 1/(mass + damped_dt resistance), 1/kg; 0 for a mass that never moves.
__device__ __forceinline__ Number inverse(const StepConstants<Number>& constants, const Moving& m, Number resistance) {
  return physics::zero_unless_greater(m.inverse_mass, Number(0),
                                      1 / physics::multiply_add(constants.damped_dt, resistance, m.mass));
}

/// Sets up the equation, the residual r for zero correction and the first direction: P r with the preconditioner P, or,
/// on a rigid floor, the correction of the masses that it holds. Returns <r, P r>, which measures the residual.
__device__ __forceinline__ double begin(const StepConstants<Number>& constants, const Body& body, const Memory& memory,
                                        unsigned row) {
  double left = 0;
  for_each_mass(body, [&](unsigned mass) {
    Moving m = moving(body, mass);
    note_arrival(constants, m.velocity, m);
    Vector resistance = resistance_of(constants, m), rate{0, 0, 0};
    add_gravity(constants, m);
    damp(constants.decay, m);
    const Vector stiffness = add_springs(constants, body, memory, row, mass, m, rate);
    if constexpr (rigid_floor) resistance.z = physics::multiply_add(constants.dt, hold(constants, m), resistance.x);
    m.force = sum(m.force, constants.dt, rate);
    const Vector all = sum(resistance, constants.dt, stiffness);
    const Vector inverse_diagonal{inverse(constants, m, all.x), inverse(constants, m, all.y),
                                  inverse(constants, m, all.z)};
    const Vector residual =
        scaled(difference(m.force, resisted(constants, m.position, resistance, m.velocity)), constants.damped_dt);
    Vector direction = product(inverse_diagonal, residual);
    left += dot(direction, residual);
    if constexpr (rigid_floor) direction = rise_correction(constants, m, resistance);
    memory.resistance[mass] = point(resistance);
    memory.inverse_diagonal[mass] = point(inverse_diagonal);
    memory.residual[mass] = point(residual);
    memory.direction[mass] = point(direction);
    memory.correction[mass] = {0, 0, 0, 0};
  });
  return sum_for_all(left);
}

/// Sets memory.applied to the matrix times the direction d. Returns <d, applied>.
__device__ __forceinline__ double apply(const StepConstants<Number>& constants, const Body& body,
                                        const Memory& memory) {
  double curvature = 0;
  for_each_mass(body, [&](unsigned mass) {
    const Vector own = triple(memory.direction[mass]);
    Vector force{0, 0, 0};
    for_each_joint(body, mass, [&](unsigned i, const Joint<Number>&) {
      const Vector across = difference(own, triple(memory.direction[memory.other[i]]));
      force = sum(force, Number(1), physics::times(memory.stiffness[i], across));
    });
    const Vector all = sum(resisted(constants, triple(body.positions[mass]), triple(memory.resistance[mass]), own),
                           constants.dt, force);
    const Vector applied = sum(scaled(all, constants.damped_dt), body.mass[mass], own);
    memory.applied[mass] = point(applied);
    curvature += dot(own, applied);
  });
  return sum_for_all(curvature);
}

/// Adds `share` times the direction to the correction and updates the residual. Returns the new <r, P r>.
__device__ __forceinline__ double advance_along(const Body& body, const Memory& memory, Number share) {
  double left = 0;
  for_each_mass(body, [&](unsigned mass) {
    const Vector direction = triple(memory.direction[mass]), applied = triple(memory.applied[mass]);
    memory.correction[mass] = point(sum(triple(memory.correction[mass]), share, direction));
    const Vector residual = sum(triple(memory.residual[mass]), -share, applied);
    memory.residual[mass] = point(residual);
    left += dot(product(residual, residual), triple(memory.inverse_diagonal[mass]));
  });
  return sum_for_all(left);
}

/// Sets the next direction: P r + share times the last direction.
__device__ __forceinline__ void update_direction(const Body& body, const Memory& memory, Number share) {
  for_each_mass(body, [&](unsigned mass) {
    const Vector steepest = product(triple(memory.inverse_diagonal[mass]), triple(memory.residual[mass]));
    memory.direction[mass] = point(sum(steepest, share, triple(memory.direction[mass])));
  });
  __syncthreads();
}

/// Solves the equation for the correction. `left` is <r, P r> at the start.
__device__ __forceinline__ void solve(const StepConstants<Number>& constants, const Body& body, const Memory& memory,
                                      double left) {
  if constexpr (rigid_floor) {
    // begins with the rises of the masses that the floor holds
    apply(constants, body, memory);
    left = advance_along(body, memory, 1);
    update_direction(body, memory, 0);
  }
  const double enough = tolerance * tolerance * left;
  for (int i = 0; i < most_iterations && left > enough; ++i) {
    const double curvature = apply(constants, body, memory);
    if (!(curvature > 0)) break;  // the direction is so small that its square is 0
    const double before = left;
    left = advance_along(body, memory, static_cast<Number>(left / curvature));
    update_direction(body, memory, static_cast<Number>(left / before));
  }
}

/// Lets a rigid floor and its friction act on the velocity at the end of the step. `hold` is the part of R with which
/// the floor holds the mass (kg/s). The push of a held mass is what the hold has added to its rise.
__device__ __forceinline__ void land_held(const StepConstants<Number>& constants, Number hold, Moving& m) {
  if (!(hold > 0)) return land(constants, m);
  const auto ground = ground_of(constants, m.position);
  const Number squared = physics::normal_squared(ground);
  const Number missing = rise_after(constants, ground, m) - physics::along_normal(ground, m.velocity);
  if (!(missing > 0)) return;  // the hold has pulled
  const Number held = constants.damped_dt * hold * m.inverse_mass * squared;
  push_off(ground, missing, m.velocity);
  m.push = physics::multiply_add(held, missing, missing) / physics::square_root(squared);
  rub(constants, ground, m.push, m.velocity);
}

__device__ __forceinline__ void move(const StepConstants<Number>& constants, const Body& body, const Memory& memory) {
  for_each_mass(body, [&](unsigned mass) {
    Moving m = moving(body, mass);
    note_arrival(constants, m.velocity, m);
    damp(constants.decay, m);
    m.velocity = sum(m.velocity, Number(1), triple(memory.correction[mass]));
    if constexpr (rigid_floor) land_held(constants, memory.resistance[mass].z - memory.resistance[mass].x, m);
    if constexpr (elastic_floor && friction) {
      // the floor's force at the end of the step; never negative, so the floor does not hold masses that leave it
      const Number z = next_clearance(constants, m);
      const Number touches = memory.resistance[mass].z - memory.resistance[mass].x;
      m.normal_force =
          physics::zero_unless_greater(touches, Number(0), physics::floor_force(constants.floor_stiffness, z));
    }
    apply_friction(constants, 1, m, m.velocity);
    advance_position(constants.dt, m);
    store(body, mass, m);
    count_contact(body, mass, m);
  });
  __syncthreads();
}

/// Records the springs' tensions at the end of the step.
__device__ __forceinline__ void record_tensions(const Body& body, unsigned row) {
  for_each_mass(body, [&](unsigned mass) {
    const Vector own = triple(body.positions[mass]), own_velocity = triple(body.velocities[mass]);
    for_each_joint(body, mass, [&](unsigned i, const Joint<Number> joint) {
      if (!joint.owned) return;
      const Entry<Number> entry = body.table[row * body.entries + joint.entry];
      const auto s = physics::separation(own, triple(body.positions[joint.other]));
      const Number distance = physics::length(s);
      const Number factor =
          physics::spring_factor_by_inverse(1 / distance, entry.stiffness, entry.rest_force * joint.rest_length);
      const Number pull = physics::spring_tension(s, distance, factor);
      Number tension = pull;
      if constexpr (dashpots) {
        const Vector velocity = difference(triple(body.velocities[joint.other]), own_velocity);
        const Number damped = factor + physics::dashpot_factor(s, body.dashpots[joint.entry], velocity);
        tension = physics::spring_tension(s, distance, damped);
      }
      record(body, row, i, mass, joint.entry, joint.rest_length, tension, pull);
    });
  });
}

/// Computes the steps of check span `index`. Row 0 of the tables holds the lengths at its beginning.
extern "C" __global__ void __launch_bounds__(EVODEVO_MAX_THREADS)
    evodevo_advance_streamed(const Body* bodies, std::uint64_t index) {
  advance_span(bodies[blockIdx.x], index, [](const Body& body, unsigned count, Samples& samples) {
    const Memory memory(body);
    for (unsigned step = 0; step < count; ++step) {
      solve(body.constants, body, memory, begin(body.constants, body, memory, step + 1));
      move(body.constants, body, memory);
      if constexpr (stress || work || peak_force || mean_tension) record_tensions(body, step + 1);
      end_step(body, step + 1, samples);
    }
  });
}

}  // namespace evodevo::cuda
