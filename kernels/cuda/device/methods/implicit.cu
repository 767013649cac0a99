// implicit: linearised backward Euler, solved by conjugate gradients. kernels/cpu/methods/implicit.cpp states the
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
constexpr int most_iterations = 500, most_revisions = 8;

/// K+ of a spring, aligned so that it is read and written by single instructions.
struct alignas(4 * sizeof(Number)) Stiffness : physics::SpringStiffness<Number> {};

/// The solver's memory.
struct Memory {
  Point<Number>*residual, *correction;
  Point<Number>* applied;           // the matrix times the direction
  Point<Number>* inverse_diagonal;  // the preconditioner: 1/(diagonal of the matrix); 0 for fixed masses
  Point<Number>* resistance;        // R, kg/s; in w, the rise that the floor lets a mass have, m/s
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

/// The resistance of a mass to drag, kg/s.
__device__ __forceinline__ Number drag_resistance(const StepConstants<Number>& constants, const Moving& m) {
  Number across = 0;
  if constexpr (drag) across = -physics::drag_factor(constants.drag_coefficient, m.velocity);
  return across;
}

/// The floor under a mass at the beginning of a step (kernels/cpu/methods/implicit_floor-inl.hpp).
struct Contact {
  physics::Ground<Number> ground;
  Number stiffness;  ///< dt times the stiffness with which the floor holds the mass, kg/s
  Number target;     ///< rise after the contact, m/s
  Number lowest;     ///< rise below which the mass enters the floor in the step, m/s
};

__device__ __forceinline__ Contact contact(const StepConstants<Number>& constants, const Moving& m, Number target) {
  const auto ground = ground_of(constants, m.position);
  if constexpr (rigid_floor) {
    const Number lowest = physics::lowest_rise(m.position.z - ground.height, constants.dt);
    return {ground, Number(1e4) / constants.dt * m.mass, target, lowest};
  }
  return {ground, constants.dt * constants.floor_stiffness, target, target};
}

/// The part of R with which the floor holds a mass, kg/s.
__device__ __forceinline__ Number held_by(const Point<Number>& resistance) { return resistance.z - resistance.x; }

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

/// Guesses whether the floor holds a mass at the end of the step, and adds the force that belongs to that. Returns dt
/// times the stiffness of the hold (kg/s), 0 for a mass that is not held, and sets the target.
/// kernels/cpu/methods/implicit_floor-inl.hpp says which masses are held.
__device__ __forceinline__ Number touch(const StepConstants<Number>& constants, Moving& m, Number& target) {
  const auto ground = ground_of(constants, m.position);
  const Number dt = constants.dt, clearance = m.position.z - ground.height;
  Number rise = m.arrival, reach = 1;
  target = -clearance / dt;
  if constexpr (rigid_floor) {
    rise = physics::multiply_add(dt * m.inverse_mass, physics::along_normal(ground, m.force), m.arrival);
    const Number speed = physics::bounce(constants.restitution, m.arrival, physics::press(m.arrival, rise));
    target = physics::rise_after_contact(physics::lowest_rise(clearance, dt), speed);
    reach = Number(1e-3) * dt - physics::multiply_add(dt, m.arrival, clearance);
  }
  const Contact c = contact(constants, m, target);
  if (!(c.lowest > rise && reach > 0 && m.inverse_mass > 0)) return 0;
  m.force = physics::add_along_normal(ground, m.force, c.stiffness * target);
  return c.stiffness;
}

/// What the velocity at the end of the step lacks for the target of a mass that a rigid floor holds; zero for other
/// masses. `held`: whether it does.
__device__ __forceinline__ Vector missing_rise(const Contact& c, bool held, const Vector& velocity) {
  Vector correction{0, 0, 0};
  if (held) push_off(c.ground, c.target - physics::along_normal(c.ground, velocity), correction);
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
    if constexpr (has_floor) m.arrival = normal_velocity(constants, m.position, m.velocity);
    const Number across = drag_resistance(constants, m);
    Vector rate{0, 0, 0};
    add_gravity(constants, m);
    damp(constants.decay, m);
    const Vector stiffness = add_springs(constants, body, memory, row, mass, m, rate);
    Number held = 0, target = 0;
    if constexpr (has_floor) held = touch(constants, m, target);
    const Vector resistance{across, across, across + held};
    m.force = sum(m.force, constants.dt, rate);
    const Vector all = sum(resistance, constants.dt, stiffness);
    const Vector inverse_diagonal{inverse(constants, m, all.x), inverse(constants, m, all.y),
                                  inverse(constants, m, all.z)};
    const Vector residual =
        scaled(difference(m.force, resisted(constants, m.position, resistance, m.velocity)), constants.damped_dt);
    Vector direction = product(inverse_diagonal, residual);
    left += dot(direction, residual);
    if constexpr (rigid_floor) direction = missing_rise(contact(constants, m, target), held > 0, m.velocity);
    memory.resistance[mass] = {across, across, across + held, target};
    memory.inverse_diagonal[mass] = point(inverse_diagonal);
    memory.residual[mass] = point(residual);
    memory.direction[mass] = point(direction);
    memory.correction[mass] = {0, 0, 0, 0};
  });
  return sum_for_all(left);
}

/// Lets go of the masses that the floor would pull down at the end of the step, and holds those that would enter it,
/// given the present correction. Sets the residual of the new equation and the first direction, as begin() does.
/// Returns <r, P r>; a negative number if nothing has changed.
__device__ __forceinline__ double revise_contacts(const StepConstants<Number>& constants, const Body& body,
                                                  const Memory& memory) {
  double left = 0, changes = 0;
  for_each_mass(body, [&](unsigned mass) {
    Moving m = moving(body, mass);
    damp(constants.decay, m);
    const Vector velocity = sum(m.velocity, Number(1), triple(memory.correction[mass]));
    Point<Number> resistance = memory.resistance[mass];
    const Contact c = contact(constants, m, resistance.w);
    const Number before = held_by(resistance), rise = physics::along_normal(c.ground, velocity);
    const bool held = m.inverse_mass > 0 && (before > 0 ? c.target : c.lowest) > rise;
    Vector residual = triple(memory.residual[mass]), inverse_diagonal = triple(memory.inverse_diagonal[mass]);
    if (held != (before > 0)) {
      changes += 1;
      const Number change = held ? c.stiffness : -before;
      residual = physics::add_along_normal(c.ground, residual, constants.damped_dt * change * (c.target - rise));
      inverse_diagonal.z = 1 / physics::multiply_add(constants.damped_dt, change, 1 / inverse_diagonal.z);
      resistance.z = held ? resistance.x + change : resistance.x;
      memory.residual[mass] = point(residual);
      memory.inverse_diagonal[mass] = point(inverse_diagonal);
      memory.resistance[mass] = resistance;
    }
    Vector direction = product(inverse_diagonal, residual);
    left += dot(direction, residual);
    if constexpr (rigid_floor) direction = missing_rise(c, held, velocity);
    memory.direction[mass] = point(direction);
  });
  left = sum_for_all(left);
  return sum_for_all(changes) > 0 ? left : -1;
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

/// Goes from the correction of the masses that a rigid floor holds, which is the first direction, to the direction P r.
/// If the solver had to find that correction, the rest of the body would be a small part of its residual, and
/// inaccurate. `left` is <r, P r>; returns the new one.
__device__ __forceinline__ double start_with_contacts(const StepConstants<Number>& constants, const Body& body,
                                                      const Memory& memory, double left) {
  if constexpr (rigid_floor) {
    apply(constants, body, memory);
    left = advance_along(body, memory, 1);
    update_direction(body, memory, 0);
  }
  return left;
}

/// Reduces the residual, of which `left` measures the present one, to `enough`.
__device__ __forceinline__ void iterate(const StepConstants<Number>& constants, const Body& body, const Memory& memory,
                                        double left, double enough) {
  for (int i = 0; i < most_iterations && left > enough; ++i) {
    const double curvature = apply(constants, body, memory);
    if (!(curvature > 0)) break;  // the direction is so small that its square is 0
    const double before = left;
    left = advance_along(body, memory, static_cast<Number>(left / curvature));
    update_direction(body, memory, static_cast<Number>(left / before));
  }
}

/// Moves the body as a whole so that the masses' residuals add up to zero: then the momentum changes by the forces from
/// outside alone, apart from rounding. Where the body is held, this only reduces the error.
__device__ __forceinline__ void balance(const StepConstants<Number>& constants, const Body& body,
                                        const Memory& memory) {
  double x = 0, y = 0, z = 0, inertia = 0, vertical_inertia = 0;
  for_each_mass(body, [&](unsigned mass) {
    if (!(body.inverse_mass[mass] > 0)) return;
    const Vector residual = triple(memory.residual[mass]);
    x += residual.x, y += residual.y, z += residual.z;
    inertia += physics::multiply_add(constants.damped_dt, memory.resistance[mass].x, body.mass[mass]);
    vertical_inertia += physics::multiply_add(constants.damped_dt, memory.resistance[mass].z, body.mass[mass]);
  });
  inertia = sum_for_all(inertia);
  const Vector common{static_cast<Number>(sum_for_all(x) / inertia), static_cast<Number>(sum_for_all(y) / inertia),
                      static_cast<Number>(sum_for_all(z) / sum_for_all(vertical_inertia))};
  double slope = 0;
  for_each_mass(body, [&](unsigned mass) {
    const Vector step = body.inverse_mass[mass] > 0 ? common : Vector{0, 0, 0};
    memory.direction[mass] = point(step);
    slope += dot(step, triple(memory.residual[mass]));
  });
  slope = sum_for_all(slope);
  const double curvature = apply(constants, body, memory);
  if (curvature > 0) advance_along(body, memory, static_cast<Number>(slope / curvature));
}

/// Solves the equation for the correction. `left` is <r, P r> at the start.
__device__ __forceinline__ void solve(const StepConstants<Number>& constants, const Body& body, const Memory& memory,
                                      double left) {
  left = start_with_contacts(constants, body, memory, left);
  const double enough = tolerance * tolerance * left;
  iterate(constants, body, memory, left, enough);
  if constexpr (has_floor) {
    for (int i = 0; i < most_revisions; ++i) {
      left = revise_contacts(constants, body, memory);
      if (left < 0) break;
      iterate(constants, body, memory, start_with_contacts(constants, body, memory, left), enough);
    }
  }
  balance(constants, body, memory);
}

/// Lets a rigid floor and its friction act on the velocity at the end of the step. `hold` is the part of R with which
/// the floor holds the mass (kg/s). The push of a held mass is what the hold has added to its rise; that of another
/// one, which the solver has let into the floor, acts on it alone.
__device__ __forceinline__ void land_held(const StepConstants<Number>& constants, const Point<Number>& resistance,
                                          Moving& m) {
  const Contact c = contact(constants, m, resistance.w);
  const Number hold = held_by(resistance), rise = physics::along_normal(c.ground, m.velocity);
  const Number missing = c.target - rise;
  const bool enters = c.lowest > rise && m.inverse_mass > 0;
  if (!(hold > 0 ? missing > 0 : enters)) return;
  push_off(c.ground, missing, m.velocity);
  const Number held = constants.damped_dt * hold * m.inverse_mass * physics::normal_squared(c.ground);
  const Number lift = physics::multiply_add(held, missing, missing);
  const Number impact = physics::maximum(c.target - m.arrival, Number(0));
  m.push = along_unit_normal(c.ground, lift);
  rub(constants, c.ground, m.push, along_unit_normal(c.ground, physics::maximum(lift - impact, Number(0))), m.velocity);
}

__device__ __forceinline__ void move(const StepConstants<Number>& constants, const Body& body, const Memory& memory) {
  for_each_mass(body, [&](unsigned mass) {
    Moving m = moving(body, mass);
    note_arrival(constants, m.velocity, m);
    damp(constants.decay, m);
    m.velocity = sum(m.velocity, Number(1), triple(memory.correction[mass]));
    const Point<Number> resistance = memory.resistance[mass];
    if constexpr (rigid_floor) land_held(constants, resistance, m);
    if constexpr (elastic_floor && friction) {
      // the floor's force at the end of the step
      const Number missing = resistance.w - normal_velocity(constants, m.position, m.velocity);
      m.normal_force = held_by(resistance) * physics::maximum(missing, Number(0));
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
