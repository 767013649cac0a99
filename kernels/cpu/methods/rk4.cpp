// rk4: the classical fourth-order Runge-Kutta method. Compiled once for each instruction set.
#include "cpu/instruction_sets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/methods/rk4.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "cpu/stepper-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace evodevo::HWY_NAMESPACE {

/// A step: four stages, with damping, drag and floor as forces; their weighted means advance position and velocity.
/// Friction acts once, at the end of the step, as a constant force: it reduces the velocity by mu N dt/m, where N is
/// the mean normal force of the stages, and the mean velocity by half of that, so that a mass inside the friction cone
/// stays where it is.
///
/// A rigid floor acts once, too, at the end of the step: on masses that would have entered it. A mass that bounces
/// moves in that step by the mean of its velocities of arrival and of departure, so that it is not higher than before.
/// In addition, the floor holds masses in the stages: if a mass that rests on it fell in the later stages, springs
/// would feel a ground that gives way.
struct Rk4 : StepMethod {
  static constexpr std::size_t rows_per_step = 2, mass_arrays = 13;

  template <class T>
  static void step(const Stepper<T>& s, std::size_t row) {
    const T dt = s.constants.step.dt, half = s.constants.half_step.dt;
    begin_stages(s);
    if (s.constants.rigid) note_arrivals(s.motion, s.constants, T(0), s.masses);
    set_forces(s, s.recording_springs, row);
    add_stage(s, T(1) / 6);
    go_to_stage(s, half, T(1) / 3);
    set_forces(s, s.springs, row + 1);
    add_stage(s, T(1) / 3);
    go_to_stage(s, half, T(1) / 3);
    set_forces(s, s.springs, row + 1);
    add_stage(s, T(1) / 3);
    go_to_stage(s, dt, T(1) / 6);
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
    s.compute(springs, row);
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
  /// the velocities and accelerations of this stage. `share` is the weight of the next stage in the means.
  template <class T>
  static void go_to_stage(const Stepper<T>& s, T time, T share) {
    if (s.constants.rigid) return go_to_held_stage(s, time, share);
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

  /// The same on a rigid floor. On its way to the stage, no mass passes the plane that touches the ground under its
  /// first position. A mass that is there does not go on into the ground, nor does one that 1 mm/s would bring there in
  /// this step; friction acts under the push that this takes. The mean velocity gets back what the floor takes from the
  /// velocity of a stage, because the floor acts on the mean velocity at the end of the step.
  template <class T>
  static void go_to_held_stage(const Stepper<T>& s, T time, T share) {
    const hn::ScalableTag<T> d;
    using V = hn::Vec<decltype(d)>;
    const cpu::Motion<T>& m = s.motion;
    const V dt = hn::Set(d, time), half = hn::Set(d, s.constants.half_step.dt), weight = hn::Set(d, share);
    const V margin = hn::Set(d, T(1e-3) * s.constants.step.dt);
    for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d)) {
      const Triple<V> first = load<V>(s, i, &Axis<T>::first_position), v = load<V>(s, i, &Axis<T>::first_velocity);
      const V dt_over_mass = dt * hn::Load(d, m.inverse_mass + i);
      Triple<V> way = load<V>(s, i, &Axis<T>::velocity);
      const Triple<V> free{advanced_velocity(v.x, hn::Load(d, m.fx + i), dt_over_mass),
                           advanced_velocity(v.y, hn::Load(d, m.fy + i), dt_over_mass),
                           advanced_velocity(v.z, hn::Load(d, m.fz + i), dt_over_mass)};
      store(s, i, &Axis<T>::position, first);
      const Ground<V> ground = ground_under(m, s.constants, i);
      const V clearance = first.z - ground.height;
      hold(s, i, ground, lowest_rise(clearance, dt), way);
      store(s, i, &Axis<T>::position,
            Triple<V>{advanced_position(first.x, way.x, dt), advanced_position(first.y, way.y, dt),
                      advanced_position(first.z, way.z, dt)});
      Triple<V> held = free, mean = load<V>(s, i, &Axis<T>::mean_velocity);
      const V there = advanced_position(clearance, along_normal(ground, way), dt);
      const V lowest = choose(margin, there, lowest_rise(there, half), along_normal(ground, held));
      const V pressed =
          press(along_normal(ground, v), along_normal(ground, free)) / square_root(normal_squared(ground));
      rub(s.constants, ground, hold(s, i, ground, lowest, held), pressed, held);
      store(s, i, &Axis<T>::velocity, held);
      store(s, i, &Axis<T>::mean_velocity,
            Triple<V>{multiply_add(weight, free.x - held.x, mean.x), multiply_add(weight, free.y - held.y, mean.y),
                      multiply_add(weight, free.z - held.z, mean.z)});
    }
    interleave_positions(m, s.masses);
  }

  /// Raises the velocity v of masses that rise less than `lowest` (m/s) to it. Returns what this adds along the unit
  /// normal, m/s.
  template <class T, class V>
  static HWY_INLINE V hold(const Stepper<T>& s, std::size_t i, const Ground<V>& ground, V lowest, Triple<V>& v) {
    const V rise = along_normal(ground, v);
    return push_off(ground, lift_of(s.motion, i, rise, lowest, lowest - rise), v);
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
    if (s.constants.rigid)
      land_at_end(s);
    else if (s.constants.friction)
      apply_friction_over_step(s, time);
    for (std::size_t c = 0; c < 3; ++c) {
      const Axis<T> a = axis(s, c);
      for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d))
        hn::Store(advanced_position(hn::Load(d, a.first_position + i), hn::Load(d, a.mean_velocity + i), dt), d,
                  a.position + i);
    }
    interleave_positions(s.motion, s.masses);
  }

  /// Lets a rigid floor act on the mean velocities, which brings masses to their positions at the end of the step, and
  /// then on the velocities there. If it pushed along the normal at the beginning of the step, curved ground would add
  /// energy.
  template <class T>
  static void land_at_end(const Stepper<T>& s) {
    const hn::ScalableTag<T> d;
    using V = hn::Vec<decltype(d)>;
    const cpu::Motion<T>& m = s.motion;
    const V dt = hn::Set(d, s.constants.step.dt), restitution = hn::Set(d, s.constants.restitution);
    const V zero = hn::Zero(d), half = hn::Set(d, T(0.5));
    for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d)) {
      const Triple<V> first = load<V>(s, i, &Axis<T>::first_position);
      Triple<V> end = load<V>(s, i, &Axis<T>::velocity), mean = load<V>(s, i, &Axis<T>::mean_velocity);
      store(s, i, &Axis<T>::position, first);
      Ground<V> ground = ground_under(m, s.constants, i);
      const V arrival = hn::Load(d, m.arrival + i), pressed = press(arrival, along_normal(ground, end));
      const V speed = bounce(restitution, arrival, pressed);
      const V rise = along_normal(ground, mean), lowest = lowest_rise(first.z - ground.height, dt);
      const V departure = maximum(speed, lowest);
      const V passage = choose(speed, zero, maximum(half * (departure + arrival), lowest), lowest);
      const V steepness = square_root(normal_squared(ground));
      const V lift = maximum(departure - along_normal(ground, end), zero) / steepness;
      push_off(ground, lift_of(m, i, rise, lowest, passage - rise), mean);
      rub(s.constants, ground, half * lift_of(m, i, rise, lowest, lift), half * pressed / steepness, mean);
      store(s, i, &Axis<T>::mean_velocity, mean);
      store(s, i, &Axis<T>::position,
            Triple<V>{advanced_position(first.x, mean.x, dt), advanced_position(first.y, mean.y, dt),
                      advanced_position(first.z, mean.z, dt)});
      ground = ground_under(m, s.constants, i);
      const V missing = maximum(departure - along_normal(ground, end), zero);
      const V push = push_off(ground, lift_of(m, i, rise, lowest, missing), end);
      rub(s.constants, ground, push, pressed / steepness, end);
      hn::Store(push, d, m.push + i);
      store(s, i, &Axis<T>::velocity, end);
    }
  }

  template <class V, class T>
  static HWY_INLINE Triple<V> load(const Stepper<T>& s, std::size_t i, T* Axis<T>::*array) {
    const hn::ScalableTag<T> d;
    return {hn::Load(d, axis(s, 0).*array + i), hn::Load(d, axis(s, 1).*array + i), hn::Load(d, axis(s, 2).*array + i)};
  }

  template <class V, class T>
  static HWY_INLINE void store(const Stepper<T>& s, std::size_t i, T* Axis<T>::*array, const Triple<V>& v) {
    const hn::ScalableTag<T> d;
    hn::Store(v.x, d, axis(s, 0).*array + i);
    hn::Store(v.y, d, axis(s, 1).*array + i);
    hn::Store(v.z, d, axis(s, 2).*array + i);
  }

  template <class T>
  static void apply_friction_over_step(const Stepper<T>& s, T time) {
    const hn::ScalableTag<T> d;
    for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d))
      hn::Store(hn::Load(d, mean_floor_force(s) + i), d, s.motion.floor_force + i);
    apply_friction(s.motion, s.constants, time, velocities(s.motion), s.masses);
    const Triple<T*> mean{axis(s, 0).mean_velocity, axis(s, 1).mean_velocity, axis(s, 2).mean_velocity};
    apply_friction(s.motion, s.constants, time / 2, mean, s.masses);
  }
};

template cpu::Integrator<float> integrator<Rk4, float>();
template cpu::Integrator<double> integrator<Rk4, double>();

}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
