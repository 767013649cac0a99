// implicit: linearised backward Euler, solved by conjugate gradients. Compiled once for each instruction set.
#include "cpu/instruction_sets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/methods/implicit.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "cpu/methods/implicit_floor-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace evodevo::HWY_NAMESPACE {

/// Let u = decay v be the damped velocity. The correction c, and with it the velocity v' = u + c at the end of a step,
/// is the solution of (Baraff and Witkin, Large steps in cloth simulation, 1998)
///
///   (M + damped_dt (dt K+ + C + R)) c = damped_dt (F - (dt K + C + R) u),   then x <- x + dt v'.
///
///   M   the masses
///   F   the forces at the present positions, with the springs' lengths at the end of the step
///   K   the springs' stiffness matrix with its negative transverse part (spring_force_rate()); without that part,
///       springs under tension would brake every rotation of a body
///   K+  the stiffness matrix without the negative part (spring_stiffness()), so that the matrix of the equation is
///       symmetric and positive definite at any dt
///   C   the damping matrix of the dashpots: as if the springs were stiffer by c/dt along their direction
///   R   diagonal: drag (coefficient times |v|) and, for a mass that touches the floor at the end of the step, dt times
///       the floor's stiffness along z, so that the floor's force is k (-z - dt v'_z). On rough ground the force is
///       along the ground's normal; that part of R is not diagonal (rough_resistance()). A rigid floor holds masses in
///       the same way, so that their v' has the rise after the contact (Contact). Which masses touch is a part of the
///       solution: after a guess, those are let go that the floor pulls, and those held that enter it, until none
///       change.
///
/// A step: set_resistance, set_stiffness, set_residual ─► the equation; solve ─► c; add_correction ─► velocities;
/// rigid floor; friction; advance_positions.
struct Implicit : ImplicitFloor {
  static constexpr std::size_t mass_arrays = 22, slot_arrays = 4;

  template <class T>
  static void step(const Stepper<T>& s, std::size_t row) {
    const Memory<T> memory(s);
    if (s.constants.rigid) note_arrivals(s.motion, s.constants, T(0), s.masses);
    s.undamped_springs(s.motion, s.actuation, row + 1);
    if (s.constants.gravity) add_gravity(s.motion, s.constants, s.masses);
    set_resistance(s, memory);
    if (s.constants.damping) damp(s.motion, s.constants.step.decay, s.masses);
    if (s.constants.rough) subtract_rough_resistance(s, memory);
    set_stiffness(s, memory, row + 1);
    set_residual(s, memory);
    solve(s, memory);
    add_correction(s, memory);
    if (s.constants.rigid) {
      land_held(s, memory);
    } else if (s.constants.friction) {
      set_floor_force(s, memory);
      apply_friction(s.motion, s.constants, s.constants.step.dt, velocities(s.motion), s.masses);
    }
    advance_positions(s.motion, s.constants.step.dt, s.masses);
    if (s.is_recording()) s.compute(s.recording_springs, row + 1);
  }

 private:
  /// The solver stops when the residual, in the preconditioner's norm, has fallen to this fraction of its initial
  /// value. In float32 rounding alone leaves about 1e-4 at twenty times the explicit methods' largest dt, where the
  /// condition number of the matrix is 1,600. In float64, 1e-6 is far below the error of the method itself.
  template <class T>
  static constexpr T tolerance = sizeof(T) == sizeof(float) ? T(1e-4) : T(1e-6);
  /// The solver stops after this many iterations in any case. The remaining residual is an error of the motion, but
  /// adds no energy.
  static constexpr int most_iterations = 500;

  /// Copies the vector (x, y, z) to memory.interleaved, from which neighbours read it.
  template <class T>
  static void interleave(const Stepper<T>& s, const Memory<T>& memory, const T* x, const T* y, const T* z) {
    const hn::ScalableTag<T> d;
    for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d))
      store_positions(d, load(x + i, y + i, z + i), memory.interleaved + cpu::position_stride * i);
  }

  /// Sets K+ and the preconditioner, and subtracts dt K u from the forces. Row `row` of the tables has the lengths.
  template <class T>
  static void set_stiffness(const Stepper<T>& s, const Memory<T>& memory, std::size_t row) {
    const cpu::Motion<T>& m = s.motion;
    const TableInMemory<T> lengths(s.actuation.relative_length + row * s.actuation.padded);
    interleave(s, memory, m.vx, m.vy, m.vz);
    for (std::size_t group = 0; group < m.groups; ++group) set_stiffness_of(s, memory, lengths, group);
  }

  template <class T>
  static HWY_INLINE void set_stiffness_of(const Stepper<T>& s, const Memory<T>& memory, const TableInMemory<T>& lengths,
                                          std::size_t group) {
    const hn::ScalableTag<T> d;
    using V = hn::Vec<decltype(d)>;
    const cpu::Motion<T>& m = s.motion;
    const std::size_t i = group * hn::Lanes(d), end = m.first_row[group + 1] * hn::Lanes(d);
    const Triple<V> x = load(m.x + i, m.y + i, m.z + i), v = load(m.vx + i, m.vy + i, m.vz + i);
    Triple<V> diagonal{hn::Zero(d), hn::Zero(d), hn::Zero(d)}, rate = diagonal;
    const V inverse_dt = hn::Set(d, T(1) / s.constants.step.dt);
    for (std::size_t slot = m.first_row[group] * hn::Lanes(d); slot < end; slot += hn::Lanes(d)) {
      const Separation<V> between = separation(x, load_positions(d, m.interleaved_positions, m.neighbour + slot));
      const Triple<V> other = load_positions(d, memory.interleaved, m.neighbour + slot);
      const V distance = length(between), k = hn::Load(d, m.stiffness + slot);
      const V spring_length = hn::Load(d, m.rest_length + slot) * lengths.at(m.material + slot);
      const V factor = spring_factor(distance, k, spring_length);
      const V damping = m.damping != nullptr ? hn::Load(d, m.damping + slot) * inverse_dt : hn::Zero(d);  // N/m
      const SpringStiffness<V> matrix = spring_stiffness(between, distance, k + damping, factor);
      hn::Store(matrix.transverse, d, memory.transverse + slot);
      hn::Store(matrix.along.x, d, memory.along[0] + slot);
      hn::Store(matrix.along.y, d, memory.along[1] + slot);
      hn::Store(matrix.along.z, d, memory.along[2] + slot);
      diagonal = {diagonal.x + multiply_add(matrix.along.x, matrix.along.x, matrix.transverse),
                  diagonal.y + multiply_add(matrix.along.y, matrix.along.y, matrix.transverse),
                  diagonal.z + multiply_add(matrix.along.z, matrix.along.z, matrix.transverse)};
      const Triple<V> velocity{other.x - v.x, other.y - v.y, other.z - v.z};
      const Triple<V> change = spring_force_rate(between, k, factor, velocity);
      const V resisted = dashpot_factor(between, damping, velocity);
      rate = {rate.x + multiply_add(resisted, between.d.x, change.x),
              rate.y + multiply_add(resisted, between.d.y, change.y),
              rate.z + multiply_add(resisted, between.d.z, change.z)};
    }
    set_preconditioner(s, memory, i, diagonal);
    const V dt = hn::Set(d, s.constants.step.dt);
    hn::Store(multiply_add(dt, rate.x, hn::Load(d, m.fx + i)), d, m.fx + i);
    hn::Store(multiply_add(dt, rate.y, hn::Load(d, m.fy + i)), d, m.fy + i);
    hn::Store(multiply_add(dt, rate.z, hn::Load(d, m.fz + i)), d, m.fz + i);
  }

  /// Sets the preconditioner for the vector of masses at index i. `stiffness` is the diagonal of K+, N/m.
  template <class T, class V>
  static HWY_INLINE void set_preconditioner(const Stepper<T>& s, const Memory<T>& memory, std::size_t i,
                                            const Triple<V>& stiffness) {
    const hn::ScalableTag<T> d;
    const V damped_dt = hn::Set(d, s.constants.step.damped_dt), dt = hn::Set(d, s.constants.step.dt),
            one = hn::Set(d, T(1));
    const V mass = hn::Load(d, s.motion.mass + i), inverse_mass = hn::Load(d, s.motion.inverse_mass + i);
    const V across = hn::Load(d, memory.resistance + i), vertical = hn::Load(d, memory.vertical_resistance + i);
    const V resistances[] = {multiply_add(dt, stiffness.x, across), multiply_add(dt, stiffness.y, across),
                             multiply_add(dt, stiffness.z, vertical)};
    for (std::size_t c = 0; c < 3; ++c) {
      // for a mass of 0 kg this may divide by zero, but then the quotient is not used
      const V inverse = one / multiply_add(damped_dt, resistances[c], mass);
      hn::Store(zero_unless_greater(inverse_mass, hn::Zero(d), inverse), d, memory.inverse_diagonal + c * s.masses + i);
    }
  }

  /// Sets the residual at c = 0, which is the right-hand side of the equation, kg m/s. dt K u has already been
  /// subtracted from the forces.
  template <class T>
  static void set_residual(const Stepper<T>& s, const Memory<T>& memory) {
    const hn::ScalableTag<T> d;
    const cpu::Motion<T>& m = s.motion;
    const auto damped_dt = hn::Set(d, s.constants.step.damped_dt);
    const auto set = [&](const T* force, const T* resistance, const T* velocity, T* to) HWY_ATTR {
      for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d)) {
        const auto resisted_by = hn::Load(d, resistance + i) * hn::Load(d, velocity + i);
        hn::Store(damped_dt * (hn::Load(d, force + i) - resisted_by), d, to + i);
      }
    };
    set(m.fx, memory.resistance, m.vx, memory.residual);
    set(m.fy, memory.resistance, m.vy, memory.residual + s.masses);
    set(m.fz, memory.vertical_resistance, m.vz, memory.residual + 2 * s.masses);
  }

  /// damped_dt (dt K+ + R) times the interleaved vector, for the masses of `group`; `own` is their part of the vector.
  template <class T, class V>
  static HWY_INLINE Triple<V> resisted(const Stepper<T>& s, const Memory<T>& memory, std::size_t group,
                                       const Triple<V>& own) {
    const hn::ScalableTag<T> d;
    const cpu::Motion<T>& m = s.motion;
    const std::size_t i = group * hn::Lanes(d), end = m.first_row[group + 1] * hn::Lanes(d);
    Triple<V> sum{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    for (std::size_t slot = m.first_row[group] * hn::Lanes(d); slot < end; slot += hn::Lanes(d)) {
      const Triple<V> other = load_positions(d, memory.interleaved, m.neighbour + slot);
      const SpringStiffness<V> matrix{hn::Load(d, memory.transverse + slot),
                                      {hn::Load(d, memory.along[0] + slot), hn::Load(d, memory.along[1] + slot),
                                       hn::Load(d, memory.along[2] + slot)}};
      const Triple<V> force = times(matrix, Triple<V>{own.x - other.x, own.y - other.y, own.z - other.z});
      sum = {sum.x + force.x, sum.y + force.y, sum.z + force.z};
    }
    const V dt = hn::Set(d, s.constants.step.dt), damped_dt = hn::Set(d, s.constants.step.damped_dt);
    if (s.constants.rough) {
      const Triple<V> rough = rough_resistance(s, memory, i, own);
      const V inverse_dt = hn::Set(d, 1 / s.constants.step.dt);
      sum = {multiply_add(inverse_dt, rough.x, sum.x), multiply_add(inverse_dt, rough.y, sum.y),
             multiply_add(inverse_dt, rough.z, sum.z)};
    }
    const V across = hn::Load(d, memory.resistance + i), vertical = hn::Load(d, memory.vertical_resistance + i);
    return {damped_dt * multiply_add(dt, sum.x, across * own.x), damped_dt * multiply_add(dt, sum.y, across * own.y),
            damped_dt * multiply_add(dt, sum.z, vertical * own.z)};
  }

  /// The contacts are revised at most this many times in a step.
  static constexpr int most_revisions = 8;

  /// Solves the equation for the correction, by preconditioned conjugate gradients for each guess of the contacts. <r,
  /// P r> measures the residual r, with P the preconditioner.
  template <class T>
  static void solve(const Stepper<T>& s, const Memory<T>& memory) {
    T left = start(s, memory);
    if (s.constants.rigid) left = start_with_contacts(s, memory);
    const T enough = tolerance<T> * tolerance<T> * left;
    iterate(s, memory, left, enough);
    for (int i = 0; i < most_revisions && s.constants.floor && revise_contacts(s, memory); ++i) {
      if (s.constants.rigid)
        left = start_with_contacts(s, memory);
      else
        left = restart(s, memory);
      iterate(s, memory, left, enough);
    }
    balance(s, memory);
  }

  /// Reduces the residual `left` to `enough`.
  template <class T>
  static void iterate(const Stepper<T>& s, const Memory<T>& memory, T left, T enough) {
    for (int i = 0; i < most_iterations && left > enough; ++i) {
      const T curvature = apply(s, memory);
      if (!(curvature > 0)) break;  // the direction is so small that its square is 0
      const T before = left;
      left = advance_along(s, memory, left / curvature);
      update_direction(s, memory, left / before);
    }
  }

  /// Sets the correction to zero and the direction to P r. Returns <r, P r>.
  template <class T>
  static T start(const Stepper<T>& s, const Memory<T>& memory) {
    const hn::ScalableTag<T> d;
    for (std::size_t i = 0; i < 3 * s.masses; i += hn::Lanes(d)) hn::Store(hn::Zero(d), d, memory.correction + i);
    return restart(s, memory);
  }

  /// Sets the direction to P r. Returns <r, P r>.
  template <class T>
  static T restart(const Stepper<T>& s, const Memory<T>& memory) {
    const hn::ScalableTag<T> d;
    hn::Vec<decltype(d)> sum = hn::Zero(d);
    for (std::size_t i = 0; i < 3 * s.masses; i += hn::Lanes(d)) {
      const auto r = hn::Load(d, memory.residual + i), direction = hn::Load(d, memory.inverse_diagonal + i) * r;
      hn::Store(direction, d, memory.direction + i);
      sum = multiply_add(direction, r, sum);
    }
    return hn::GetLane(hn::SumOfLanes(d, sum));
  }

  /// Moves the body as a whole so that the masses' residuals add up to zero: then the momentum changes by the forces
  /// from outside alone, apart from rounding. Where the body is held, this only reduces the error.
  template <class T>
  static void balance(const Stepper<T>& s, const Memory<T>& memory) {
    const hn::ScalableTag<T> d;
    using V = hn::Vec<decltype(d)>;
    const V damped_dt = hn::Set(d, s.constants.step.damped_dt), zero = hn::Zero(d);
    V slope = zero;
    for (std::size_t c = 0; c < 3; ++c) {
      const T* const resistance = c == 2 ? memory.vertical_resistance : memory.resistance;
      T *const direction = memory.direction + c * s.masses, *const residual = memory.residual + c * s.masses;
      V error = zero, inertia = zero;
      for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d)) {
        const V inverse_mass = hn::Load(d, s.motion.inverse_mass + i), mass = hn::Load(d, s.motion.mass + i);
        error = error + zero_unless_greater(inverse_mass, zero, hn::Load(d, residual + i));
        inertia = inertia + multiply_add(damped_dt, hn::Load(d, resistance + i), mass);
      }
      const V common = hn::SumOfLanes(d, error) / hn::SumOfLanes(d, inertia);
      for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d)) {
        const V step = zero_unless_greater(hn::Load(d, s.motion.inverse_mass + i), zero, common);
        hn::Store(step, d, direction + i);
        slope = multiply_add(step, hn::Load(d, residual + i), slope);
      }
    }
    const T curvature = apply(s, memory);
    if (curvature > 0) advance_along(s, memory, hn::GetLane(hn::SumOfLanes(d, slope)) / curvature);
  }

  /// Lets the correction of the masses that a rigid floor holds reach their targets. If the solver had to find these,
  /// the rest of the body would be a small part of its residual, and inaccurate. Returns <r, P r>.
  template <class T>
  static T start_with_contacts(const Stepper<T>& s, const Memory<T>& memory) {
    direct_to_targets(s, memory);
    apply(s, memory);
    const T left = advance_along(s, memory, T(1));
    update_direction(s, memory, T(0));
    return left;
  }

  /// Sets memory.applied to the matrix times the direction d. Returns <d, applied>.
  template <class T>
  static T apply(const Stepper<T>& s, const Memory<T>& memory) {
    const hn::ScalableTag<T> d;
    using V = hn::Vec<decltype(d)>;
    const T *x = memory.direction, *y = x + s.masses, *z = y + s.masses;
    interleave(s, memory, x, y, z);
    V sum = hn::Zero(d);
    for (std::size_t group = 0; group < s.motion.groups; ++group) {
      const std::size_t i = group * hn::Lanes(d);
      const V mass = hn::Load(d, s.motion.mass + i);
      const Triple<V> own = load(x + i, y + i, z + i);
      const Triple<V> part = resisted(s, memory, group, own);
      const Triple<V> all{multiply_add(mass, own.x, part.x), multiply_add(mass, own.y, part.y),
                          multiply_add(mass, own.z, part.z)};
      hn::Store(all.x, d, memory.applied + i);
      hn::Store(all.y, d, memory.applied + s.masses + i);
      hn::Store(all.z, d, memory.applied + 2 * s.masses + i);
      sum = multiply_add(own.z, all.z, multiply_add(own.y, all.y, multiply_add(own.x, all.x, sum)));
    }
    return hn::GetLane(hn::SumOfLanes(d, sum));
  }

  /// Adds `share` times the direction to the correction and updates the residual. Returns the new <r, P r>.
  template <class T>
  static T advance_along(const Stepper<T>& s, const Memory<T>& memory, T share_) {
    const hn::ScalableTag<T> d;
    const auto share = hn::Set(d, share_);
    hn::Vec<decltype(d)> sum = hn::Zero(d);
    for (std::size_t i = 0; i < 3 * s.masses; i += hn::Lanes(d)) {
      const auto correction = hn::Load(d, memory.correction + i), residual = hn::Load(d, memory.residual + i);
      hn::Store(multiply_add(share, hn::Load(d, memory.direction + i), correction), d, memory.correction + i);
      const auto r = negative_multiply_add(share, hn::Load(d, memory.applied + i), residual);
      hn::Store(r, d, memory.residual + i);
      sum = multiply_add(r * r, hn::Load(d, memory.inverse_diagonal + i), sum);
    }
    return hn::GetLane(hn::SumOfLanes(d, sum));
  }

  /// Sets the next direction: P r + share times the last direction.
  template <class T>
  static void update_direction(const Stepper<T>& s, const Memory<T>& memory, T share_) {
    const hn::ScalableTag<T> d;
    const auto share = hn::Set(d, share_);
    for (std::size_t i = 0; i < 3 * s.masses; i += hn::Lanes(d)) {
      const auto steepest = hn::Load(d, memory.inverse_diagonal + i) * hn::Load(d, memory.residual + i);
      hn::Store(multiply_add(share, hn::Load(d, memory.direction + i), steepest), d, memory.direction + i);
    }
  }

  template <class T>
  static void add_correction(const Stepper<T>& s, const Memory<T>& memory) {
    const hn::ScalableTag<T> d;
    const T* correction = memory.correction;
    for (T* v : {s.motion.vx, s.motion.vy, s.motion.vz}) {
      for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d))
        hn::Store(hn::Load(d, v + i) + hn::Load(d, correction + i), d, v + i);
      correction += s.masses;
    }
  }
};

template cpu::Integrator<float> integrator<Implicit, float>();
template cpu::Integrator<double> integrator<Implicit, double>();

}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
