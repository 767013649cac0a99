// Loops over a body's masses, padded to whole SIMD vectors: one for each force, and those that advance velocities and
// positions. They read and write the arrays of cpu::Motion. Included once per instruction set.
#if defined(EVODEVO_CPU_MASSES_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef EVODEVO_CPU_MASSES_INL_HPP
#undef EVODEVO_CPU_MASSES_INL_HPP
#else
#define EVODEVO_CPU_MASSES_INL_HPP
#endif

#include "cpu/positions-inl.hpp"
#include "cpu/step.hpp"

HWY_BEFORE_NAMESPACE();
namespace evodevo::HWY_NAMESPACE {

/// Lets dashpots act at the present velocities.
template <class T>
HWY_INLINE void interleave_velocities(const cpu::Motion<T>& m, std::size_t masses) {
  const hn::ScalableTag<T> d;
  for (std::size_t i = 0; i < masses; i += hn::Lanes(d))
    store_positions(d,
                    Triple<hn::Vec<decltype(d)>>{hn::Load(d, m.vx + i), hn::Load(d, m.vy + i), hn::Load(d, m.vz + i)},
                    m.interleaved_velocities + cpu::position_stride * i);
}

template <class T>
HWY_INLINE void add_gravity(const cpu::Motion<T>& m, const cpu::StepConstants<T>& constants, std::size_t masses) {
  const hn::ScalableTag<T> d;
  const auto acceleration = hn::Set(d, constants.acceleration);
  for (std::size_t i = 0; i < masses; i += hn::Lanes(d))
    hn::Store(hn::Load(d, m.fz + i) + weight(hn::Load(d, m.mass + i), acceleration), d, m.fz + i);
  if (!constants.slope) return;
  const auto grade = hn::Set(d, constants.grade);
  for (std::size_t i = 0; i < masses; i += hn::Lanes(d)) {
    const auto pull = downhill_force(weight(hn::Load(d, m.mass + i), acceleration), grade);
    hn::Store(hn::Load(d, m.fx + i) + pull, d, m.fx + i);
  }
}

/// The ground under the masses of the vector that begins at index i.
template <class T>
HWY_INLINE auto ground_under(const cpu::Motion<T>& m, const cpu::StepConstants<T>& constants, std::size_t i) {
  const hn::ScalableTag<T> d;
  using V = hn::Vec<decltype(d)>;
  if (!constants.rough) return Ground<V>{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  return ground_at(hn::Load(d, m.x + i), hn::Load(d, m.y + i),
                   Roughness<V>{hn::Set(d, constants.roughness), hn::Set(d, constants.cells), constants.seed});
}

template <class T>
HWY_INLINE void add_rough_floor(const cpu::Motion<T>& m, const cpu::StepConstants<T>& constants, std::size_t masses) {
  const hn::ScalableTag<T> d;
  using V = hn::Vec<decltype(d)>;
  const V stiffness = hn::Set(d, constants.floor_stiffness);
  for (std::size_t i = 0; i < masses; i += hn::Lanes(d)) {
    const Ground<V> ground = ground_under(m, constants, i);
    const V normal_force = floor_force(stiffness, hn::Load(d, m.z + i) - ground.height);
    const Triple<V> force{hn::Load(d, m.fx + i), hn::Load(d, m.fy + i), hn::Load(d, m.fz + i)};
    const Triple<V> sum = add_along_normal(ground, force, normal_force);
    hn::Store(normal_force, d, m.floor_force + i);
    hn::Store(sum.x, d, m.fx + i);
    hn::Store(sum.y, d, m.fy + i);
    hn::Store(sum.z, d, m.fz + i);
  }
}

template <class T>
HWY_INLINE void add_floor(const cpu::Motion<T>& m, const cpu::StepConstants<T>& constants, std::size_t masses) {
  if (constants.rigid) return;
  if (constants.rough) return add_rough_floor(m, constants, masses);
  const hn::ScalableTag<T> d;
  const auto stiffness = hn::Set(d, constants.floor_stiffness);
  for (std::size_t i = 0; i < masses; i += hn::Lanes(d)) {
    const auto normal_force = floor_force(stiffness, hn::Load(d, m.z + i));
    hn::Store(normal_force, d, m.floor_force + i);
    hn::Store(hn::Load(d, m.fz + i) + normal_force, d, m.fz + i);
  }
}

/// Notes how fast masses rise at the beginning of a step, before a rigid floor acts: with their present velocities,
/// less what the present forces add in `since` seconds.
template <class T>
HWY_INLINE void note_arrivals(const cpu::Motion<T>& m, const cpu::StepConstants<T>& constants, T since,
                              std::size_t masses) {
  const hn::ScalableTag<T> d;
  using V = hn::Vec<decltype(d)>;
  for (std::size_t i = 0; i < masses; i += hn::Lanes(d)) {
    const V by = hn::Set(d, since) * hn::Load(d, m.inverse_mass + i);
    const Triple<V> before{negative_multiply_add(by, hn::Load(d, m.fx + i), hn::Load(d, m.vx + i)),
                           negative_multiply_add(by, hn::Load(d, m.fy + i), hn::Load(d, m.vy + i)),
                           negative_multiply_add(by, hn::Load(d, m.fz + i), hn::Load(d, m.vz + i))};
    hn::Store(along_normal(ground_under(m, constants, i), before), d, m.arrival + i);
  }
}

/// `lift` where a rigid floor acts, 0 elsewhere: the other forces have given a mass less than the lowest rise, and the
/// mass is not one of 0 kg.
template <class T, class V>
HWY_INLINE V lift_of(const cpu::Motion<T>& m, std::size_t i, V rise, V lowest, V lift) {
  const hn::ScalableTag<T> d;
  return zero_unless_greater(hn::Load(d, m.inverse_mass + i), hn::Zero(d), zero_unless_greater(lowest, rise, lift));
}

/// Adds `lift` (m/s) to the rise of masses with the velocity v. Returns what this adds along the unit normal, m/s.
template <class V>
HWY_INLINE V push_off(const Ground<V>& ground, V lift, Triple<V>& v) {
  const V squared = normal_squared(ground);
  v = add_along_normal(ground, v, lift / squared);
  return lift / square_root(squared);
}

/// Reduces velocities by the friction of a floor that has added `push` (m/s) along its unit normal, of which forces
/// have caused `pressed` (after_friction()).
template <class T, class V>
HWY_INLINE void rub(const cpu::StepConstants<T>& constants, const Ground<V>& ground, V push, V pressed, Triple<V>& v) {
  const hn::ScalableTag<T> d;
  if (!constants.friction) return;
  const T at_rest = constants.static_friction ? constants.static_coefficient : 0;
  v = after_friction(ground, v, push, pressed, hn::Set(d, constants.friction_coefficient), hn::Set(d, at_rest));
}

/// Lets a rigid floor and its friction act on the velocities that all other forces have given the masses in a step.
template <class T>
HWY_INLINE void land(const cpu::Motion<T>& m, const cpu::StepConstants<T>& constants, std::size_t masses) {
  const hn::ScalableTag<T> d;
  using V = hn::Vec<decltype(d)>;
  const V dt = hn::Set(d, constants.step.dt), restitution = hn::Set(d, constants.restitution);
  for (std::size_t i = 0; i < masses; i += hn::Lanes(d)) {
    const Ground<V> ground = ground_under(m, constants, i);
    Triple<V> v{hn::Load(d, m.vx + i), hn::Load(d, m.vy + i), hn::Load(d, m.vz + i)};
    const V rise = along_normal(ground, v), lowest = lowest_rise(hn::Load(d, m.z + i) - ground.height, dt);
    const V arrival = hn::Load(d, m.arrival + i), pressed = press(arrival, rise);
    const V after = rise_after_contact(lowest, bounce(restitution, arrival, pressed));
    const V push = push_off(ground, lift_of(m, i, rise, lowest, after - rise), v);
    rub(constants, ground, push, pressed / square_root(normal_squared(ground)), v);
    hn::Store(push, d, m.push + i);
    hn::Store(v.x, d, m.vx + i);
    hn::Store(v.y, d, m.vy + i);
    hn::Store(v.z, d, m.vz + i);
  }
}

/// Stops the descent of masses that a rigid floor has pushed in the step, with the friction under the push that this
/// takes. `v` are velocities of the masses of the vector at index i after half a step of the present forces.
template <class T, class V>
HWY_INLINE void stay_landed(const cpu::Motion<T>& m, const cpu::StepConstants<T>& constants, std::size_t i,
                            Triple<V>& v) {
  const hn::ScalableTag<T> d;
  const Ground<V> ground = ground_under(m, constants, i);
  const V descent = maximum(hn::Zero(d) - along_normal(ground, v), hn::Zero(d));
  const V lift = zero_unless_greater(hn::Load(d, m.push + i), hn::Zero(d), descent);
  const Triple<V> force{hn::Load(d, m.fx + i), hn::Load(d, m.fy + i), hn::Load(d, m.fz + i)};
  const V by = hn::Set(d, constants.half_step.dt) * hn::Load(d, m.inverse_mass + i);
  const V pressed = press(hn::Zero(d), by * along_normal(ground, force)) / square_root(normal_squared(ground));
  rub(constants, ground, push_off(ground, lift, v), pressed, v);
}

/// Lets dashpots act at the velocities that masses will have after half a step under the present forces and then half a
/// step of drag and damping. Masses that a rigid floor has pushed in the step do not descend.
template <class T>
HWY_INLINE void interleave_predicted_velocities(const cpu::Motion<T>& m, const cpu::StepConstants<T>& constants,
                                                std::size_t masses) {
  const hn::ScalableTag<T> d;
  using V = hn::Vec<decltype(d)>;
  const cpu::TimeSpan<T>& half = constants.half_step;
  for (std::size_t i = 0; i < masses; i += hn::Lanes(d)) {
    const V inverse_mass = hn::Load(d, m.inverse_mass + i), by = hn::Set(d, half.dt) * inverse_mass;
    Triple<V> v{multiply_add(by, hn::Load(d, m.fx + i), hn::Load(d, m.vx + i)),
                multiply_add(by, hn::Load(d, m.fy + i), hn::Load(d, m.vy + i)),
                multiply_add(by, hn::Load(d, m.fz + i), hn::Load(d, m.vz + i))};
    if (constants.rigid) stay_landed(m, constants, i, v);
    V kept = hn::Set(d, constants.damping ? half.decay : T(1));
    if (constants.drag)
      kept = kept * drag_retention(hn::Set(d, constants.drag_coefficient * half.damped_dt) * inverse_mass, v);
    store_positions(d, Triple<V>{kept * v.x, kept * v.y, kept * v.z},
                    m.interleaved_velocities + cpu::position_stride * i);
  }
}

/// Adds 1 to the number of contact steps of each mass that an elastic floor pushes now, or that a rigid floor has
/// pushed in the step.
template <class T>
HWY_INLINE void count_contacts(const cpu::Motion<T>& m, const cpu::StepConstants<T>& constants, std::size_t masses) {
  if (!constants.floor) return;
  const hn::ScalableTag<T> d;
  const auto one = hn::Set(d, T(1)), zero = hn::Zero(d);
  for (std::size_t i = 0; i < masses; i += hn::Lanes(d)) {
    auto depth = hn::Load(d, m.push + i);
    if (!constants.rigid) depth = ground_under(m, constants, i).height - hn::Load(d, m.z + i);
    const auto touches = zero_unless_greater(depth, zero, one);
    hn::Store(hn::Load(d, m.contact_steps + i) + touches, d, m.contact_steps + i);
  }
}

template <class T>
HWY_INLINE void add_drag(const cpu::Motion<T>& m, const cpu::StepConstants<T>& constants, std::size_t masses) {
  const hn::ScalableTag<T> d;
  using V = hn::Vec<decltype(d)>;
  const V coefficient = hn::Set(d, constants.drag_coefficient);
  for (std::size_t i = 0; i < masses; i += hn::Lanes(d)) {
    const Triple<V> v{hn::Load(d, m.vx + i), hn::Load(d, m.vy + i), hn::Load(d, m.vz + i)};
    const V factor = drag_factor(coefficient, v);
    hn::Store(multiply_add(factor, v.x, hn::Load(d, m.fx + i)), d, m.fx + i);
    hn::Store(multiply_add(factor, v.y, hn::Load(d, m.fy + i)), d, m.fy + i);
    hn::Store(multiply_add(factor, v.z, hn::Load(d, m.fz + i)), d, m.fz + i);
  }
}

/// Adds damping to the forces.
template <class T>
HWY_INLINE void add_damping(const cpu::Motion<T>& m, const cpu::StepConstants<T>& constants, std::size_t masses) {
  const hn::ScalableTag<T> d;
  const auto rate = hn::Set(d, constants.damping_rate);
  for (std::size_t i = 0; i < masses; i += hn::Lanes(d)) {
    const auto factor = damping_factor(rate, hn::Load(d, m.mass + i));
    hn::Store(multiply_add(factor, hn::Load(d, m.vx + i), hn::Load(d, m.fx + i)), d, m.fx + i);
    hn::Store(multiply_add(factor, hn::Load(d, m.vy + i), hn::Load(d, m.fy + i)), d, m.fy + i);
    hn::Store(multiply_add(factor, hn::Load(d, m.vz + i), hn::Load(d, m.fz + i)), d, m.fz + i);
  }
}

/// Applies quadratic drag over a step (drag_retention()): scales the velocities and, if `forces_too`, the forces that
/// act during the step.
template <bool forces_too, class T>
HWY_INLINE void apply_drag(const cpu::Motion<T>& m, const cpu::StepConstants<T>& constants, T damped_dt,
                           std::size_t masses) {
  const hn::ScalableTag<T> d;
  using V = hn::Vec<decltype(d)>;
  const V coefficient_dt = hn::Set(d, constants.drag_coefficient * damped_dt);
  for (std::size_t i = 0; i < masses; i += hn::Lanes(d)) {
    const Triple<V> v{hn::Load(d, m.vx + i), hn::Load(d, m.vy + i), hn::Load(d, m.vz + i)};
    const V kept = drag_retention(coefficient_dt * hn::Load(d, m.inverse_mass + i), v);
    hn::Store(v.x * kept, d, m.vx + i);
    hn::Store(v.y * kept, d, m.vy + i);
    hn::Store(v.z * kept, d, m.vz + i);
    if constexpr (forces_too)
      for (T* force : {m.fx, m.fy, m.fz}) hn::Store(hn::Load(d, force + i) * kept, d, force + i);
  }
}

/// v <- v + time F/m
template <class T>
HWY_INLINE void advance_velocities(const cpu::Motion<T>& m, T time, std::size_t masses) {
  const hn::ScalableTag<T> d;
  const auto dt = hn::Set(d, time);
  for (std::size_t i = 0; i < masses; i += hn::Lanes(d)) {
    const auto dt_over_mass = dt * hn::Load(d, m.inverse_mass + i);
    hn::Store(advanced_velocity(hn::Load(d, m.vx + i), hn::Load(d, m.fx + i), dt_over_mass), d, m.vx + i);
    hn::Store(advanced_velocity(hn::Load(d, m.vy + i), hn::Load(d, m.fy + i), dt_over_mass), d, m.vy + i);
    hn::Store(advanced_velocity(hn::Load(d, m.vz + i), hn::Load(d, m.fz + i), dt_over_mass), d, m.vz + i);
  }
}

template <class T>
HWY_INLINE void damp(const cpu::Motion<T>& m, T decay_, std::size_t masses) {
  const hn::ScalableTag<T> d;
  const auto decay = hn::Set(d, decay_);
  for (T* v : {m.vx, m.vy, m.vz})
    for (std::size_t i = 0; i < masses; i += hn::Lanes(d)) hn::Store(hn::Load(d, v + i) * decay, d, v + i);
}

template <class T>
HWY_INLINE Triple<T*> velocities(const cpu::Motion<T>& m) {
  return {m.vx, m.vy, m.vz};
}

/// apply_friction() on rough ground, where m.floor_force is the vertical part of the normal force.
template <class T>
HWY_INLINE void apply_friction_along_ground(const cpu::Motion<T>& m, const cpu::StepConstants<T>& constants, T time,
                                            const Triple<T*>& velocity, std::size_t masses) {
  const hn::ScalableTag<T> d;
  using V = hn::Vec<decltype(d)>;
  for (std::size_t i = 0; i < masses; i += hn::Lanes(d)) {
    const Ground<V> ground = ground_under(m, constants, i);
    const V up = hn::Set(d, time) * hn::Load(d, m.floor_force + i) * hn::Load(d, m.inverse_mass + i);
    Triple<V> v{hn::Load(d, velocity.x + i), hn::Load(d, velocity.y + i), hn::Load(d, velocity.z + i)};
    const V push = up * square_root(normal_squared(ground));
    rub(constants, ground, push, push, v);
    hn::Store(v.x, d, velocity.x + i);
    hn::Store(v.y, d, velocity.y + i);
    hn::Store(v.z, d, velocity.z + i);
  }
}

/// Reduces velocities (m/s) along an elastic floor by the friction that acts for `time` seconds under the normal forces
/// m.floor_force.
template <class T>
HWY_INLINE void apply_friction(const cpu::Motion<T>& m, const cpu::StepConstants<T>& constants, T time,
                               const Triple<T*>& velocity, std::size_t masses) {
  if (constants.rough) return apply_friction_along_ground(m, constants, time, velocity, masses);
  const hn::ScalableTag<T> d;
  const auto coefficient_dt = hn::Set(d, constants.friction_coefficient * time);
  const auto static_dt = hn::Set(d, constants.static_coefficient * time);
  for (std::size_t i = 0; i < masses; i += hn::Lanes(d)) {
    const auto vx = hn::Load(d, velocity.x + i), vy = hn::Load(d, velocity.y + i);
    const auto force = hn::Load(d, m.floor_force + i), inverse_mass = hn::Load(d, m.inverse_mass + i);
    auto kept = friction_factor(vx, vy, coefficient_dt * force * inverse_mass);
    if (constants.static_friction) kept = kept_unless_held(vx, vy, static_dt * force * inverse_mass, kept);
    hn::Store(vx * kept, d, velocity.x + i);
    hn::Store(vy * kept, d, velocity.y + i);
  }
}

/// Copies the positions x, y, z to the interleaved array, from which neighbours read them.
template <class T>
HWY_INLINE void interleave_positions(const cpu::Motion<T>& m, std::size_t masses) {
  const hn::ScalableTag<T> d;
  for (std::size_t i = 0; i < masses; i += hn::Lanes(d))
    store_positions(d, Triple<hn::Vec<decltype(d)>>{hn::Load(d, m.x + i), hn::Load(d, m.y + i), hn::Load(d, m.z + i)},
                    m.interleaved_positions + cpu::position_stride * i);
}

/// x <- x + dt v, in both copies of the positions.
template <class T>
HWY_INLINE void advance_positions(const cpu::Motion<T>& m, T time_step, std::size_t masses) {
  const hn::ScalableTag<T> d;
  const auto dt = hn::Set(d, time_step);
  for (std::size_t i = 0; i < masses; i += hn::Lanes(d)) {
    const auto x = advanced_position(hn::Load(d, m.x + i), hn::Load(d, m.vx + i), dt);
    const auto y = advanced_position(hn::Load(d, m.y + i), hn::Load(d, m.vy + i), dt);
    const auto z = advanced_position(hn::Load(d, m.z + i), hn::Load(d, m.vz + i), dt);
    hn::Store(x, d, m.x + i);
    hn::Store(y, d, m.y + i);
    hn::Store(z, d, m.z + i);
    store_positions(d, Triple<hn::Vec<decltype(d)>>{x, y, z}, m.interleaved_positions + cpu::position_stride * i);
  }
}

}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
