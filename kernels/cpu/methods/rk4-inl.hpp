// rk4: the classical fourth-order Runge-Kutta method. Included once per instruction set.
#if defined(EVODEVO_CPU_METHODS_RK4_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef EVODEVO_CPU_METHODS_RK4_INL_HPP
#undef EVODEVO_CPU_METHODS_RK4_INL_HPP
#else
#define EVODEVO_CPU_METHODS_RK4_INL_HPP
#endif

#include "cpu/stepper-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace evodevo::HWY_NAMESPACE {

/// A step: four stages, with damping, drag and floor as forces; their weighted means advance position and velocity.
/// Friction acts once, at the end of the step, as a constant force: it reduces the velocity by mu N dt/m, where N is
/// the mean normal force of the stages, and the mean velocity by half of that, so that a mass inside the friction cone
/// stays where it is.
struct Rk4 : StepMethod {
  static constexpr std::size_t rows_per_step = 2, mass_arrays = 13;

  template <class T>
  static void step(const Stepper<T>& s, std::size_t row) {
    const T dt = s.constants.step.dt, half = s.constants.half_step.dt;
    begin_stages(s);
    set_forces(s, s.recording_springs, row);
    add_stage(s, T(1) / 6);
    go_to_stage(s, half);
    set_forces(s, s.springs, row + 1);
    add_stage(s, T(1) / 3);
    go_to_stage(s, half);
    set_forces(s, s.springs, row + 1);
    add_stage(s, T(1) / 3);
    go_to_stage(s, dt);
    set_forces(s, s.springs, row + 2);
    add_stage(s, T(1) / 6);
    finish(s, dt);
  }

 private:
  /// One coordinate of all masses.
  template <class T>
  struct Axis {
    T *position, *velocity;
    const T* force;
    T *first_position, *first_velocity;  ///< at the beginning of the step
    T *mean_velocity, *mean_acceleration;
  };

  template <class T>
  static Axis<T> axis(const Stepper<T>& s, std::size_t c) {
    const cpu::Motion<T>& m = s.motion;
    T* const positions[] = {m.x, m.y, m.z};
    T* const velocities[] = {m.vx, m.vy, m.vz};
    const T* const forces[] = {m.fx, m.fy, m.fz};
    return {positions[c], velocities[c], forces[c], s.scratch(c), s.scratch(3 + c), s.scratch(6 + c), s.scratch(9 + c)};
  }

  template <class T>
  static T* mean_floor_force(const Stepper<T>& s) {
    return s.scratch(12);
  }

  template <class T>
  static void begin_stages(const Stepper<T>& s) {
    const hn::ScalableTag<T> d;
    for (std::size_t c = 0; c < 3; ++c) {
      const Axis<T> a = axis(s, c);
      for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d)) {
        hn::Store(hn::Load(d, a.position + i), d, a.first_position + i);
        hn::Store(hn::Load(d, a.velocity + i), d, a.first_velocity + i);
        hn::Store(hn::Zero(d), d, a.mean_velocity + i);
        hn::Store(hn::Zero(d), d, a.mean_acceleration + i);
      }
    }
    for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d)) hn::Store(hn::Zero(d), d, mean_floor_force(s) + i);
  }

  template <class T>
  static void set_forces(const Stepper<T>& s, SpringPass<T> springs, std::size_t row) {
    springs(s.motion, s.actuation, row);
    if (s.constants.gravity) add_gravity(s.motion, s.constants, s.masses);
    if (s.constants.floor) add_floor(s.motion, s.constants, s.masses);
    if (s.constants.drag) add_drag(s.motion, s.constants, s.masses);
    if (s.constants.damping) add_damping(s.motion, s.constants, s.masses);
  }

  /// Adds `share` of this stage's velocities, accelerations and normal forces to their means.
  template <class T>
  static void add_stage(const Stepper<T>& s, T share) {
    const hn::ScalableTag<T> d;
    const auto weight = hn::Set(d, share);
    const auto add = [&](std::size_t i, auto value, T* mean)
                         HWY_ATTR { hn::Store(multiply_add(weight, value, hn::Load(d, mean + i)), d, mean + i); };
    for (std::size_t c = 0; c < 3; ++c) {
      const Axis<T> a = axis(s, c);
      for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d)) {
        add(i, hn::Load(d, a.velocity + i), a.mean_velocity);
        add(i, hn::Load(d, a.force + i) * hn::Load(d, s.motion.inverse_mass + i), a.mean_acceleration);
      }
    }
    if (s.constants.friction)
      for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d))
        add(i, hn::Load(d, s.motion.floor_force + i), mean_floor_force(s));
  }

  /// Sets positions and velocities for the next stage: those at the beginning of the step, advanced by `time` (s) with
  /// the velocities and accelerations of this stage.
  template <class T>
  static void go_to_stage(const Stepper<T>& s, T time) {
    const hn::ScalableTag<T> d;
    const auto dt = hn::Set(d, time);
    for (std::size_t c = 0; c < 3; ++c) {
      const Axis<T> a = axis(s, c);
      for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d)) {
        const auto dt_over_mass = dt * hn::Load(d, s.motion.inverse_mass + i);
        hn::Store(advanced_position(hn::Load(d, a.first_position + i), hn::Load(d, a.velocity + i), dt), d,
                  a.position + i);
        hn::Store(advanced_velocity(hn::Load(d, a.first_velocity + i), hn::Load(d, a.force + i), dt_over_mass), d,
                  a.velocity + i);
      }
    }
    interleave_positions(s.motion, s.masses);
  }

  template <class T>
  static void finish(const Stepper<T>& s, T time) {
    const hn::ScalableTag<T> d;
    const auto dt = hn::Set(d, time);
    for (std::size_t c = 0; c < 3; ++c) {
      const Axis<T> a = axis(s, c);
      for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d))
        hn::Store(multiply_add(dt, hn::Load(d, a.mean_acceleration + i), hn::Load(d, a.first_velocity + i)), d,
                  a.velocity + i);
    }
    if (s.constants.friction) apply_friction_over_step(s, time);
    for (std::size_t c = 0; c < 3; ++c) {
      const Axis<T> a = axis(s, c);
      for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d))
        hn::Store(advanced_position(hn::Load(d, a.first_position + i), hn::Load(d, a.mean_velocity + i), dt), d,
                  a.position + i);
    }
    interleave_positions(s.motion, s.masses);
  }

  template <class T>
  static void apply_friction_over_step(const Stepper<T>& s, T time) {
    const hn::ScalableTag<T> d;
    for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d))
      hn::Store(hn::Load(d, mean_floor_force(s) + i), d, s.motion.floor_force + i);
    apply_friction(s.motion, s.constants, time, s.motion.vx, s.motion.vy, s.masses);
    apply_friction(s.motion, s.constants, time / 2, axis(s, 0).mean_velocity, axis(s, 1).mean_velocity, s.masses);
  }
};

}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
