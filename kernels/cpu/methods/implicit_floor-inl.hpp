// The floor and drag in the equation of the method implicit. Included once per instruction set.
#if defined(EVODEVO_CPU_METHODS_IMPLICIT_FLOOR_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef EVODEVO_CPU_METHODS_IMPLICIT_FLOOR_INL_HPP
#undef EVODEVO_CPU_METHODS_IMPLICIT_FLOOR_INL_HPP
#else
#define EVODEVO_CPU_METHODS_IMPLICIT_FLOOR_INL_HPP
#endif

#include "cpu/stepper-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace evodevo::HWY_NAMESPACE {

/// The part R of the equation, and the floor's forces; implicit-inl.hpp defines the equation.
struct ImplicitFloor : StepMethod {
 protected:
  /// The solver's memory. A vector has the x of all masses, then all y, then all z.
  template <class T>
  struct Memory {
    explicit Memory(const Stepper<T>& s)
        : residual(s.scratch(0)),
          direction(s.scratch(3)),
          correction(s.scratch(6)),
          applied(s.scratch(9)),
          inverse_diagonal(s.scratch(12)),
          resistance(s.scratch(15)),
          vertical_resistance(s.scratch(16)),
          interleaved(s.scratch(17)),
          transverse(s.motion.slot_scratch),
          along{transverse + s.motion.slots, transverse + 2 * s.motion.slots, transverse + 3 * s.motion.slots} {}

    T *residual, *direction, *correction;
    T* applied;              ///< the matrix times the direction
    T* inverse_diagonal;     ///< the preconditioner: inverses of the matrix's diagonal elements; 0 for fixed masses
    T* resistance;           ///< R along x and y, kg/s
    T* vertical_resistance;  ///< R along z, kg/s
    T* interleaved;          ///< a copy of a vector that neighbours read: position_stride numbers for each mass
    T* transverse;
    T* along[3];  ///< with `transverse`: SpringStiffness of the springs, K+
  };

  /// Sets R, and adds the floor's forces at the present positions to F.
  template <class T>
  static void set_resistance(const Stepper<T>& s, const Memory<T>& memory) {
    const hn::ScalableTag<T> d;
    using V = hn::Vec<decltype(d)>;
    const cpu::Motion<T>& m = s.motion;
    const V coefficient = hn::Set(d, s.constants.drag_coefficient), zero = hn::Zero(d);
    const V dt = hn::Set(d, s.constants.step.dt), floor = hn::Set(d, s.constants.floor_stiffness);
    for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d)) {
      const V vz = hn::Load(d, m.vz + i);
      V across = zero, touching = zero;
      if (s.constants.drag)
        across = zero - drag_factor(coefficient, Triple<V>{hn::Load(d, m.vx + i), hn::Load(d, m.vy + i), vz});
      if (s.constants.rigid) {
        touching = hold(s, i);
      } else if (s.constants.rough) {
        touching = add_ground(s, i);
      } else if (s.constants.floor) {
        const V z = hn::Load(d, m.z + i);
        touching = zero_unless_greater(zero - advanced_position(z, vz, dt), zero, floor);
        hn::Store(negative_multiply_add(touching, z, hn::Load(d, m.fz + i)), d, m.fz + i);
      }
      hn::Store(across, d, memory.resistance + i);
      hn::Store(multiply_add(dt, touching, across), d, memory.vertical_resistance + i);
    }
  }

  /// Adds the force of rough ground to those masses of the vector at index i that touch it. Returns the stiffness of
  /// the ground (N/m) for them and 0 for the others.
  template <class T>
  static HWY_INLINE hn::Vec<hn::ScalableTag<T>> add_ground(const Stepper<T>& s, std::size_t i) {
    const hn::ScalableTag<T> d;
    using V = hn::Vec<decltype(d)>;
    const cpu::Motion<T>& m = s.motion;
    const Ground<V> ground = ground_under(m, s.constants, i);
    const V depth = ground.height - hn::Load(d, m.z + i);
    const V end = negative_multiply_add(hn::Set(d, s.constants.step.dt),
                                        along_normal(ground, load(m.vx + i, m.vy + i, m.vz + i)), depth);
    const V touching = zero_unless_greater(end, hn::Zero(d), hn::Set(d, s.constants.floor_stiffness));
    const Triple<V> force = add_along_normal(ground, load(m.fx + i, m.fy + i, m.fz + i), touching * depth);
    hn::Store(force.x, d, m.fx + i);
    hn::Store(force.y, d, m.fy + i);
    hn::Store(force.z, d, m.fz + i);
    return touching;
  }

  /// The state of a rigid floor under the masses of a vector, at the beginning of a step.
  template <class V>
  struct Contact {
    Ground<V> ground;
    V arrival;    ///< m/s
    V clearance;  ///< m
    V lowest;     ///< lowest_rise(), m/s
    V after;      ///< rise_after_contact(), m/s
  };

  template <class T>
  static HWY_INLINE auto contact(const Stepper<T>& s, std::size_t i) {
    const hn::ScalableTag<T> d;
    using V = hn::Vec<decltype(d)>;
    const Ground<V> ground = ground_under(s.motion, s.constants, i);
    const V arrival = hn::Load(d, s.motion.arrival + i), clearance = hn::Load(d, s.motion.z + i) - ground.height;
    const V lowest = lowest_rise(clearance, hn::Set(d, s.constants.step.dt));
    const V after = rise_after_contact(lowest, bounce(hn::Set(d, s.constants.restitution), arrival));
    return Contact<V>{ground, arrival, clearance, lowest, after};
  }

  /// Decides which masses of the vector at index i a rigid floor holds in this step: those that the present forces
  /// press against it, and that touch it or arrive (with a margin of 1 mm/s for rounding). Without this, the solver
  /// would let them fall with the body, and a body of large dt^2 k/m would collapse. Adds the force that gives them the
  /// rise after the contact, and returns the stiffness of that hold, 10^4 m/dt^2 (N/m); 0 for other masses.
  template <class T>
  static HWY_INLINE hn::Vec<hn::ScalableTag<T>> hold(const Stepper<T>& s, std::size_t i) {
    const hn::ScalableTag<T> d;
    using V = hn::Vec<decltype(d)>;
    const cpu::Motion<T>& m = s.motion;
    const T step = s.constants.step.dt;
    const V dt = hn::Set(d, step), margin = hn::Set(d, T(1e-3) * step);
    const auto [ground, arrival, clearance, lowest, after] = contact(s, i);
    const Triple<V> force = load(m.fx + i, m.fy + i, m.fz + i);
    const V rise = multiply_add(dt * hn::Load(d, m.inverse_mass + i), along_normal(ground, force), arrival);
    const V near = zero_unless_greater(margin, multiply_add(dt, arrival, clearance), hn::Load(d, m.mass + i));
    const V stiffness = hn::Set(d, T(1e4) / (step * step)) * zero_unless_greater(lowest, rise, near);
    const Triple<V> sum = add_along_normal(ground, force, stiffness * dt * after);
    hn::Store(sum.x, d, m.fx + i);
    hn::Store(sum.y, d, m.fy + i);
    hn::Store(sum.z, d, m.fz + i);
    return stiffness;
  }

  /// The part of R with which the floor resists the masses of the vector at index i, kg/s.
  template <class T>
  static HWY_INLINE hn::Vec<hn::ScalableTag<T>> floor_resistance(const Memory<T>& memory, std::size_t i) {
    const hn::ScalableTag<T> d;
    return hn::Load(d, memory.vertical_resistance + i) - hn::Load(d, memory.resistance + i);
  }

  /// Sets the direction to the correction by which the masses that a rigid floor holds get the rise after their
  /// contact.
  template <class T>
  static void direct_to_rises(const Stepper<T>& s, const Memory<T>& memory) {
    const hn::ScalableTag<T> d;
    const cpu::Motion<T>& m = s.motion;
    for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d)) {
      const auto c = contact(s, i);
      const auto missing = c.after - along_normal(c.ground, load(m.vx + i, m.vy + i, m.vz + i)), zero = hn::Zero(d);
      Triple<hn::Vec<decltype(d)>> correction{zero, zero, zero};
      push_off(c.ground, zero_unless_greater(floor_resistance(memory, i), zero, missing), correction);
      hn::Store(correction.x, d, memory.direction + i);
      hn::Store(correction.y, d, memory.direction + s.masses + i);
      hn::Store(correction.z, d, memory.direction + 2 * s.masses + i);
    }
  }

  /// Lets a rigid floor and its friction act on the velocities at the end of the step. The push of a held mass is what
  /// the hold has added to its rise; where the hold has pulled, it is 0.
  template <class T>
  static void land_held(const Stepper<T>& s, const Memory<T>& memory) {
    const hn::ScalableTag<T> d;
    using V = hn::Vec<decltype(d)>;
    const cpu::Motion<T>& m = s.motion;
    const V damped_dt = hn::Set(d, s.constants.step.damped_dt), zero = hn::Zero(d);
    for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d)) {
      const auto c = contact(s, i);
      Triple<V> v = load(m.vx + i, m.vy + i, m.vz + i);
      const V missing = c.after - along_normal(c.ground, v), squared = normal_squared(c.ground);
      const V held = damped_dt * floor_resistance(memory, i) * hn::Load(d, m.inverse_mass + i) * squared;
      const V free = lift_of(m, i, along_normal(c.ground, v), c.lowest, missing);
      push_off(c.ground, choose(held, zero, maximum(missing, zero), free), v);
      const V push =
          choose(held, zero, maximum(multiply_add(held, missing, missing), zero), free) / square_root(squared);
      rub(s.constants, c.ground, push, v);
      hn::Store(push, d, m.push + i);
      hn::Store(v.x, d, m.vx + i);
      hn::Store(v.y, d, m.vy + i);
      hn::Store(v.z, d, m.vz + i);
    }
  }

  /// The part of R v that is not in the diagonal, for the vector of masses at index i: rough ground pushes along its
  /// normal instead of along z.
  template <class T, class V>
  static HWY_INLINE Triple<V> rough_resistance(const Stepper<T>& s, const Memory<T>& memory, std::size_t i,
                                               const Triple<V>& v) {
    const hn::ScalableTag<T> d;
    const V touching = floor_resistance(memory, i);
    const Ground<V> ground = ground_under(s.motion, s.constants, i);
    const V zero = hn::Zero(d);
    return add_along_normal(ground, Triple<V>{zero, zero, zero - touching * v.z}, touching * along_normal(ground, v));
  }

  /// Subtracts rough_resistance() of the velocities from the forces.
  template <class T>
  static void subtract_rough_resistance(const Stepper<T>& s, const Memory<T>& memory) {
    const hn::ScalableTag<T> d;
    const cpu::Motion<T>& m = s.motion;
    for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d)) {
      const auto resisted = rough_resistance(s, memory, i, load(m.vx + i, m.vy + i, m.vz + i));
      hn::Store(hn::Load(d, m.fx + i) - resisted.x, d, m.fx + i);
      hn::Store(hn::Load(d, m.fy + i) - resisted.y, d, m.fy + i);
      hn::Store(hn::Load(d, m.fz + i) - resisted.z, d, m.fz + i);
    }
  }

  template <class T>
  static HWY_INLINE Triple<hn::Vec<hn::ScalableTag<T>>> load(const T* x, const T* y, const T* z) {
    const hn::ScalableTag<T> d;
    return {hn::Load(d, x), hn::Load(d, y), hn::Load(d, z)};
  }

  /// Sets the floor's force at the end of the step, N; never negative, so the floor does not hold masses that leave it.
  template <class T>
  static void set_floor_force(const Stepper<T>& s, const Memory<T>& memory) {
    const hn::ScalableTag<T> d;
    const cpu::Motion<T>& m = s.motion;
    const auto stiffness = hn::Set(d, s.constants.floor_stiffness), dt = hn::Set(d, s.constants.step.dt);
    for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d)) {
      auto z = advanced_position(hn::Load(d, m.z + i), hn::Load(d, m.vz + i), dt);
      if (s.constants.rough) {
        const auto ground = ground_under(m, s.constants, i);
        const auto velocity = along_normal(ground, load(m.vx + i, m.vy + i, m.vz + i));
        z = advanced_position(hn::Load(d, m.z + i), velocity, dt) - ground.height;
      }
      hn::Store(zero_unless_greater(floor_resistance(memory, i), hn::Zero(d), floor_force(stiffness, z)), d,
                m.floor_force + i);
    }
  }
};

}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
