// Passes over a body's masses, padded to whole groups: one per force, and those that move it; included once per
// instruction set.
#if defined(EVODEVO_CPU_MASSES_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef EVODEVO_CPU_MASSES_INL_HPP
#undef EVODEVO_CPU_MASSES_INL_HPP
#else
#define EVODEVO_CPU_MASSES_INL_HPP
#endif

#include "cpu/places-inl.hpp"
#include "cpu/step.hpp"

HWY_BEFORE_NAMESPACE();
namespace evodevo::HWY_NAMESPACE {

template <class T>
HWY_INLINE void add_gravity(const cpu::Motion<T>& m, const cpu::World<T>& world, std::size_t masses) {
  const hn::ScalableTag<T> d;
  const auto acceleration = hn::Set(d, world.acceleration);
  for (std::size_t i = 0; i < masses; i += hn::Lanes(d))
    hn::Store(hn::Load(d, m.fz + i) + weight(hn::Load(d, m.mass + i), acceleration), d, m.fz + i);
}

template <class T>
HWY_INLINE void add_floor(const cpu::Motion<T>& m, const cpu::World<T>& world, std::size_t masses) {
  const hn::ScalableTag<T> d;
  const auto stiffness = hn::Set(d, world.floor_stiffness);
  for (std::size_t i = 0; i < masses; i += hn::Lanes(d)) {
    const auto push = floor_force(stiffness, hn::Load(d, m.z + i));
    hn::Store(push, d, m.floor_force + i);
    hn::Store(hn::Load(d, m.fz + i) + push, d, m.fz + i);
  }
}

template <class T>
HWY_INLINE void add_drag(const cpu::Motion<T>& m, const cpu::World<T>& world, std::size_t masses) {
  const hn::ScalableTag<T> d;
  using V = hn::Vec<decltype(d)>;
  const V coefficient = hn::Set(d, world.drag_coefficient);
  for (std::size_t i = 0; i < masses; i += hn::Lanes(d)) {
    const Triple<V> v{hn::Load(d, m.vx + i), hn::Load(d, m.vy + i), hn::Load(d, m.vz + i)};
    const V factor = drag_factor(coefficient, v);
    hn::Store(multiply_add(factor, v.x, hn::Load(d, m.fx + i)), d, m.fx + i);
    hn::Store(multiply_add(factor, v.y, hn::Load(d, m.fy + i)), d, m.fy + i);
    hn::Store(multiply_add(factor, v.z, hn::Load(d, m.fz + i)), d, m.fz + i);
  }
}

template <class T>
HWY_INLINE void advance_velocities(const cpu::Motion<T>& m, const cpu::World<T>& world, std::size_t masses) {
  const hn::ScalableTag<T> d;
  const auto dt = hn::Set(d, world.dt);
  for (std::size_t i = 0; i < masses; i += hn::Lanes(d)) {
    const auto dt_over_mass = dt * hn::Load(d, m.inverse_mass + i);
    hn::Store(advanced_velocity(hn::Load(d, m.vx + i), hn::Load(d, m.fx + i), dt_over_mass), d, m.vx + i);
    hn::Store(advanced_velocity(hn::Load(d, m.vy + i), hn::Load(d, m.fy + i), dt_over_mass), d, m.vy + i);
    hn::Store(advanced_velocity(hn::Load(d, m.vz + i), hn::Load(d, m.fz + i), dt_over_mass), d, m.vz + i);
  }
}

template <class T>
HWY_INLINE void damp(const cpu::Motion<T>& m, const cpu::World<T>& world, std::size_t masses) {
  const hn::ScalableTag<T> d;
  const auto decay = hn::Set(d, world.decay);
  for (T* v : {m.vx, m.vy, m.vz})
    for (std::size_t i = 0; i < masses; i += hn::Lanes(d)) hn::Store(hn::Load(d, v + i) * decay, d, v + i);
}

template <class T>
HWY_INLINE void rub(const cpu::Motion<T>& m, const cpu::World<T>& world, std::size_t masses) {
  const hn::ScalableTag<T> d;
  const auto coefficient_dt = hn::Set(d, world.friction_coefficient * world.dt);
  for (std::size_t i = 0; i < masses; i += hn::Lanes(d)) {
    const auto vx = hn::Load(d, m.vx + i), vy = hn::Load(d, m.vy + i);
    const auto loss = coefficient_dt * hn::Load(d, m.floor_force + i) * hn::Load(d, m.inverse_mass + i);
    const auto kept = friction_factor(vx, vy, loss);
    hn::Store(vx * kept, d, m.vx + i);
    hn::Store(vy * kept, d, m.vy + i);
  }
}

/// x <- x + dt v, in both copies of the places.
template <class T>
HWY_INLINE void move(const cpu::Motion<T>& m, T time_step, std::size_t masses) {
  const hn::ScalableTag<T> d;
  const auto dt = hn::Set(d, time_step);
  for (std::size_t i = 0; i < masses; i += hn::Lanes(d)) {
    const auto x = moved(hn::Load(d, m.x + i), hn::Load(d, m.vx + i), dt);
    const auto y = moved(hn::Load(d, m.y + i), hn::Load(d, m.vy + i), dt);
    const auto z = moved(hn::Load(d, m.z + i), hn::Load(d, m.vz + i), dt);
    hn::Store(x, d, m.x + i);
    hn::Store(y, d, m.y + i);
    hn::Store(z, d, m.z + i);
    store_places(d, Triple<hn::Vec<decltype(d)>>{x, y, z}, m.places + cpu::place_stride * i);
  }
}

}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
