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
          target(s.scratch(17)),
          interleaved(s.scratch(18)),
          transverse(s.motion.slot_scratch),
          along{transverse + s.motion.slots, transverse + 2 * s.motion.slots, transverse + 3 * s.motion.slots} {}

    T *residual, *direction, *correction;
    T* applied;              ///< the matrix times the direction
    T* inverse_diagonal;     ///< the preconditioner: inverses of the matrix's diagonal elements; 0 for fixed masses
    T* resistance;           ///< R along x and y, kg/s
    T* vertical_resistance;  ///< R along z, kg/s
    T* target;               ///< Contact::target, m/s
    T* interleaved;          ///< a copy of a vector that neighbours read: position_stride numbers for each mass
    T* transverse;
    T* along[3];  ///< with `transverse`: SpringStiffness of the springs, K+
  };

  /// The floor under the masses of a vector at the beginning of a step. It holds a mass along the normal by the force
  /// stiffness dt (target - rise), with the rise of the mass at the end of the step: an elastic floor by its own
  /// stiffness, and a rigid one by one so high that the mass gets the target.
  template <class V>
  struct Contact {
    Ground<V> ground;
    V stiffness;  ///< N/m
    V target;     ///< rise after the contact, m/s
    V lowest;     ///< rise below which the mass enters the floor in the step, m/s
  };

  template <class T>
  static HWY_INLINE auto contact(const Stepper<T>& s, const Memory<T>& memory, std::size_t i) {
    const hn::ScalableTag<T> d;
    using V = hn::Vec<decltype(d)>;
    const V target = hn::Load(d, memory.target + i), step = hn::Set(d, s.constants.step.dt);
    Contact<V> c{ground_under(s.motion, s.constants, i), hn::Set(d, s.constants.floor_stiffness), target, target};
    if (!s.constants.rigid) return c;
    c.stiffness = hn::Set(d, T(1e4)) / (step * step) * hn::Load(d, s.motion.mass + i);
    c.lowest = lowest_rise(hn::Load(d, s.motion.z + i) - c.ground.height, step);
    return c;
  }

  /// Sets R and the targets of the floor, and adds the floor's forces to F.
  template <class T>
  static void set_resistance(const Stepper<T>& s, const Memory<T>& memory) {
    const hn::ScalableTag<T> d;
    using V = hn::Vec<decltype(d)>;
    const cpu::Motion<T>& m = s.motion;
    const V coefficient = hn::Set(d, s.constants.drag_coefficient), zero = hn::Zero(d);
    for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d)) {
      V across = zero;
      if (s.constants.drag) across = zero - drag_factor(coefficient, load(m.vx + i, m.vy + i, m.vz + i));
      hn::Store(across, d, memory.resistance + i);
      hn::Store(s.constants.floor ? across + touch(s, memory, i) : across, d, memory.vertical_resistance + i);
    }
  }

  /// Guesses which masses of the vector at index i the floor holds at the end of the step, sets their targets, and adds
  /// the force that belongs to them to F. Returns dt times the stiffness of the hold (kg/s); 0 for other masses.
  ///
  /// An elastic floor holds masses that would be in it with their present velocities. A rigid one holds those that the
  /// present forces of springs and gravity press against it, and that touch it or arrive (with a margin of 1 mm/s for
  /// rounding). revise_contacts() corrects the guess.
  template <class T>
  static HWY_INLINE hn::Vec<hn::ScalableTag<T>> touch(const Stepper<T>& s, const Memory<T>& memory, std::size_t i) {
    const hn::ScalableTag<T> d;
    using V = hn::Vec<decltype(d)>;
    const cpu::Motion<T>& m = s.motion;
    const V dt = hn::Set(d, s.constants.step.dt), zero = hn::Zero(d), inverse_mass = hn::Load(d, m.inverse_mass + i);
    const Ground<V> ground = ground_under(m, s.constants, i);
    const V clearance = hn::Load(d, m.z + i) - ground.height;
    const V arrival = along_normal(ground, load(m.vx + i, m.vy + i, m.vz + i));
    const Triple<V> force = load(m.fx + i, m.fy + i, m.fz + i);
    V rise = arrival, target = zero - clearance / dt, reach = zero;
    if (s.constants.rigid) {
      rise = multiply_add(dt * inverse_mass, along_normal(ground, force), arrival);
      const V speed = bounce(hn::Set(d, s.constants.restitution), arrival, press(arrival, rise));
      target = rise_after_contact(lowest_rise(clearance, dt), speed);
      reach = hn::Set(d, T(1e-3) * s.constants.step.dt) - multiply_add(dt, arrival, clearance);
    }
    hn::Store(target, d, memory.target + i);
    const Contact<V> c = contact(s, memory, i);
    V held = zero_unless_greater(c.lowest, rise, dt * c.stiffness);
    if (s.constants.rigid) held = zero_unless_greater(reach, zero, held);
    held = zero_unless_greater(inverse_mass, zero, held);
    const Triple<V> sum = add_along_normal(ground, force, held * target);
    hn::Store(sum.x, d, m.fx + i);
    hn::Store(sum.y, d, m.fy + i);
    hn::Store(sum.z, d, m.fz + i);
    return held;
  }

  /// Lets go of the masses that the floor would pull down at the end of the step, and holds those that would enter it,
  /// given the present correction. Sets the residual of the new equation. Returns whether anything has changed.
  template <class T>
  static bool revise_contacts(const Stepper<T>& s, const Memory<T>& memory) {
    const hn::ScalableTag<T> d;
    using V = hn::Vec<decltype(d)>;
    const cpu::Motion<T>& m = s.motion;
    const V dt = hn::Set(d, s.constants.step.dt), damped_dt = hn::Set(d, s.constants.step.damped_dt),
            zero = hn::Zero(d);
    bool any = false;
    for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d)) {
      const Contact<V> c = contact(s, memory, i);
      const V rise = along_normal(c.ground, velocity_at_end(s, memory, i)), before = floor_resistance(memory, i);
      const V threshold = choose(before, zero, c.target, c.lowest);
      const V hold = zero_unless_greater(hn::Load(d, m.inverse_mass + i), zero,
                                         zero_unless_greater(threshold, rise, dt * c.stiffness));
      // compares the states, not the numbers, which rounding may change
      const V change = choose(hold, zero, choose(before, zero, zero, hold), zero - before);
      if (hn::AllTrue(d, hn::Eq(change, zero))) continue;
      any = true;
      const V impulse = damped_dt * change * (c.target - rise);
      const Triple<V> residual = add_along_normal(
          c.ground, load(memory.residual + i, memory.residual + s.masses + i, memory.residual + 2 * s.masses + i),
          impulse);
      hn::Store(residual.x, d, memory.residual + i);
      hn::Store(residual.y, d, memory.residual + s.masses + i);
      hn::Store(residual.z, d, memory.residual + 2 * s.masses + i);
      const V across = hn::Load(d, memory.resistance + i),
              vertical = across + choose(hold, zero, before + change, zero);
      T* const inverse_diagonal = memory.inverse_diagonal + 2 * s.masses + i;
      const V diagonal = hn::Set(d, T(1)) / hn::Load(d, inverse_diagonal) +
                         damped_dt * (vertical - hn::Load(d, memory.vertical_resistance + i));
      hn::Store(zero_unless_greater(hn::Load(d, m.inverse_mass + i), zero, hn::Set(d, T(1)) / diagonal), d,
                inverse_diagonal);
      hn::Store(vertical, d, memory.vertical_resistance + i);
    }
    return any;
  }

  /// The velocities of the vector of masses at index i at the end of the step, given the present correction, m/s.
  template <class T>
  static HWY_INLINE Triple<hn::Vec<hn::ScalableTag<T>>> velocity_at_end(const Stepper<T>& s, const Memory<T>& memory,
                                                                        std::size_t i) {
    const Triple<hn::Vec<hn::ScalableTag<T>>> v = load(s.motion.vx + i, s.motion.vy + i, s.motion.vz + i);
    const T* const c = memory.correction + i;
    const auto correction = load(c, c + s.masses, c + 2 * s.masses);
    return {v.x + correction.x, v.y + correction.y, v.z + correction.z};
  }

  /// The part of R with which the floor resists the masses of the vector at index i, kg/s.
  template <class T>
  static HWY_INLINE hn::Vec<hn::ScalableTag<T>> floor_resistance(const Memory<T>& memory, std::size_t i) {
    const hn::ScalableTag<T> d;
    return hn::Load(d, memory.vertical_resistance + i) - hn::Load(d, memory.resistance + i);
  }

  /// Sets the direction to what the correction of the masses that a rigid floor holds lacks for their targets.
  template <class T>
  static void direct_to_targets(const Stepper<T>& s, const Memory<T>& memory) {
    const hn::ScalableTag<T> d;
    for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d)) {
      const auto c = contact(s, memory, i);
      const auto missing = c.target - along_normal(c.ground, velocity_at_end(s, memory, i)), zero = hn::Zero(d);
      Triple<hn::Vec<decltype(d)>> correction{zero, zero, zero};
      push_off(c.ground, zero_unless_greater(floor_resistance(memory, i), zero, missing), correction);
      hn::Store(correction.x, d, memory.direction + i);
      hn::Store(correction.y, d, memory.direction + s.masses + i);
      hn::Store(correction.z, d, memory.direction + 2 * s.masses + i);
    }
  }

  /// Lets a rigid floor and its friction act on the velocities at the end of the step. The push of a held mass is what
  /// the hold has added to its rise; that of another one, which the solver has let into the floor, acts on it alone.
  template <class T>
  static void land_held(const Stepper<T>& s, const Memory<T>& memory) {
    const hn::ScalableTag<T> d;
    using V = hn::Vec<decltype(d)>;
    const cpu::Motion<T>& m = s.motion;
    const V damped_dt = hn::Set(d, s.constants.step.damped_dt), zero = hn::Zero(d);
    for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d)) {
      const Contact<V> c = contact(s, memory, i);
      Triple<V> v = load(m.vx + i, m.vy + i, m.vz + i);
      const V missing = c.target - along_normal(c.ground, v), squared = normal_squared(c.ground);
      const V held = damped_dt * floor_resistance(memory, i) * hn::Load(d, m.inverse_mass + i) * squared;
      const V free = lift_of(m, i, along_normal(c.ground, v), c.lowest, missing);
      push_off(c.ground, choose(held, zero, maximum(missing, zero), free), v);
      const V lift = choose(held, zero, maximum(multiply_add(held, missing, missing), zero), free);
      const V impact = c.target - hn::Load(d, m.arrival + i), steepness = square_root(squared);
      rub(s.constants, c.ground, lift / steepness, maximum(lift - maximum(impact, zero), zero) / steepness, v);
      hn::Store(lift / steepness, d, m.push + i);
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

  /// Sets the force of an elastic floor at the end of the step, N.
  template <class T>
  static void set_floor_force(const Stepper<T>& s, const Memory<T>& memory) {
    const hn::ScalableTag<T> d;
    const cpu::Motion<T>& m = s.motion;
    for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d)) {
      const auto c = contact(s, memory, i);
      const auto missing = c.target - along_normal(c.ground, load(m.vx + i, m.vy + i, m.vz + i));
      hn::Store(floor_resistance(memory, i) * maximum(missing, hn::Zero(d)), d, m.floor_force + i);
    }
  }
};

}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
