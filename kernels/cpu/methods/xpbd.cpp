// xpbd: extended position-based dynamics. Compiled once for each instruction set.
#include "cpu/instruction_sets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/methods/xpbd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "cpu/stepper-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace evodevo::HWY_NAMESPACE {

/// A step: gravity, drag and damping ─► predicted velocities; one Gauss-Seidel pass over the springs, by colour ─►
/// corrected velocities; floor; friction; x <- x + dt v.
///
/// Each spring is a constraint |d| = L of compliance 1/k, and an elastic floor is a constraint z >= 0 (Macklin et al.,
/// XPBD, 2016). One pass per step is made because, at equal cost, one pass with smaller steps is more accurate than
/// several passes with larger ones (Macklin et al., Small steps in physics simulation, 2019). The unknowns are the
/// velocities v, from which the positions at the end of the step follow as x + dt v. If the unknowns were the
/// positions, float32 velocities would be differences of almost equal positions, mostly rounding error.
struct Xpbd : StepMethod {
  static constexpr std::size_t mass_arrays = cpu::position_stride;
  static constexpr bool coloured = true;

  template <class T>
  static void step(const Stepper<T>& s, std::size_t row) {
    if (s.constants.rigid) note_arrivals(s.motion, s.constants, T(0), s.masses);
    apply_gravity(s);
    interleave_velocities(s);
    for (std::size_t at = 0; at < s.motion.coloured.size; at += hn::Lanes(hn::ScalableTag<T>()))
      solve_springs(s, row + 1, at);
    deinterleave_velocities(s);
    if (s.constants.floor && !s.constants.rigid) s.constants.rough ? solve_rough_floor(s) : solve_floor(s);
    touch_floor(s);
    advance_positions(s.motion, s.constants.step.dt, s.masses);
  }

 private:
  /// The velocities that springs read and write: position_stride numbers for each mass, m/s.
  template <class T>
  static T* interleaved(const Stepper<T>& s) {
    return s.scratch(0);
  }

  /// Predicts the velocities: applies gravity, drag and damping as symplectic-euler does.
  template <class T>
  static void apply_gravity(const Stepper<T>& s) {
    const hn::ScalableTag<T> d;
    for (T* force : {s.motion.fx, s.motion.fy, s.motion.fz})
      for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d)) hn::Store(hn::Zero(d), d, force + i);
    if (s.constants.gravity) add_gravity(s.motion, s.constants, s.masses);
    if (s.constants.drag) apply_drag<true>(s.motion, s.constants, s.constants.step.damped_dt, s.masses);
    if (s.constants.damping) damp(s.motion, s.constants.step.decay, s.masses);
    if (s.constants.gravity) advance_velocities(s.motion, s.constants.step.damped_dt, s.masses);
  }

  template <class T>
  static void interleave_velocities(const Stepper<T>& s) {
    const hn::ScalableTag<T> d;
    const cpu::Motion<T>& m = s.motion;
    for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d))
      store_positions(d,
                      Triple<hn::Vec<decltype(d)>>{hn::Load(d, m.vx + i), hn::Load(d, m.vy + i), hn::Load(d, m.vz + i)},
                      interleaved(s) + cpu::position_stride * i);
  }

  template <class T>
  static void deinterleave_velocities(const Stepper<T>& s) {
    const T* velocity = interleaved(s);
    for (std::size_t i = 0; i < s.masses; ++i, velocity += cpu::position_stride) {
      s.motion.vx[i] = velocity[0];
      s.motion.vy[i] = velocity[1];
      s.motion.vz[i] = velocity[2];
    }
  }

  /// Solves the springs at, at + 1, .., one SIMD vector of springs of the same colour.
  template <class T>
  static void solve_springs(const Stepper<T>& s, std::size_t row, std::size_t at) {
    const hn::ScalableTag<T> d;
    using V = hn::Vec<decltype(d)>;
    const cpu::ColouredView<T>& springs = s.motion.coloured;
    const std::uint32_t *a = springs.a + at, *b = springs.b + at;
    const TableInMemory<T> lengths(s.actuation.relative_length + row * s.actuation.padded);
    const V dt = hn::Set(d, s.constants.step.dt), damped_dt = hn::Set(d, s.constants.step.damped_dt);
    const V rest_length = hn::Load(d, springs.rest_length + at), k = hn::Load(d, springs.stiffness + at);
    const V wa = hn::Load(d, springs.inverse_mass_a + at), wb = hn::Load(d, springs.inverse_mass_b + at);

    const Triple<V> va = load_positions(d, interleaved(s), a), vb = load_positions(d, interleaved(s), b);
    const Triple<V> xa = load_positions(d, s.motion.interleaved_positions, a),
                    xb = load_positions(d, s.motion.interleaved_positions, b);
    const Triple<V> x = {xb.x - xa.x, xb.y - xa.y, xb.z - xa.z}, v = {vb.x - va.x, vb.y - va.y, vb.z - va.z};
    const Separation<V> ends =
        separation(Triple<V>{hn::Zero(d), hn::Zero(d), hn::Zero(d)},
                   Triple<V>{multiply_add(dt, v.x, x.x), multiply_add(dt, v.y, x.y), multiply_add(dt, v.z, x.z)});
    const V distance = length(ends);
    const V stretch = distance - rest_length * lengths.at(springs.material + at);
    V force = compliant_force(k, stretch, dt * damped_dt, wa + wb), of_spring = force;
    if (springs.damping != nullptr) {
      const V rate = multiply_add(ends.d.z, v.z, multiply_add(ends.d.y, v.y, ends.d.x * v.x)) / distance;
      force = damped_force(k, hn::Load(d, springs.damping + at), stretch, rate, dt, damped_dt, wa + wb);
      of_spring = k * (stretch - force * dt * damped_dt * (wa + wb));
    }
    const V factor = force / distance;
    store_velocities(s, at, a, add_scaled(va, damped_dt * factor * wa, ends.d));
    store_velocities(s, at, b, add_scaled(vb, hn::Zero(d) - damped_dt * factor * wb, ends.d));
    if (s.is_recording())
      record(s, row, at, spring_tension(ends, distance, factor), spring_tension(ends, distance, of_spring / distance));
  }

  template <class V>
  static HWY_INLINE Triple<V> add_scaled(const Triple<V>& v, V by, const Triple<V>& d) {
    return {multiply_add(by, d.x, v.x), multiply_add(by, d.y, v.y), multiply_add(by, d.z, v.z)};
  }

  /// Whether entry `at` is a spring, and not padding of its colour.
  template <class T>
  static bool is_spring(const Stepper<T>& s, std::size_t at) {
    return s.motion.coloured.stiffness[at] > T(0);
  }

  template <class T, class V>
  static HWY_INLINE void store_velocities(const Stepper<T>& s, std::size_t at, const std::uint32_t* offset,
                                          const Triple<V>& v) {
    const hn::ScalableTag<T> d;
    HWY_ALIGN T rows[cpu::position_stride * hn::MaxLanes(hn::ScalableTag<T>())];
    store_positions(d, v, rows);
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
      if (!is_spring(s, at + lane)) continue;
      for (std::size_t c = 0; c < 3; ++c) interleaved(s)[offset[lane] + c] = rows[cpu::position_stride * lane + c];
    }
  }

  /// Adds the springs' tensions (N) to the enabled sums. `pull` is the tension without that of the dashpot, with which
  /// a muscle works.
  template <class T, class V>
  static void record(const Stepper<T>& s, std::size_t row, std::size_t at, V tension, V pull) {
    const hn::ScalableTag<T> d;
    const auto add = [](T sum, T value) { return sum + value; };
    if (s.sums.force) put_into_slots(s, at, hn::Abs(tension), s.motion.force_sum, add);
    if (s.sums.tension) put_into_slots(s, at, tension, s.motion.tension_sum, add);
    if (s.sums.peak)
      put_into_slots(s, at, hn::Abs(tension), s.motion.peak,
                     [](T most, T value) { return value > most ? value : most; });
    if (s.sums.power) {
      const cpu::ColouredView<T>& springs = s.motion.coloured;
      const TableInMemory<T> rates(s.actuation.relative_rate + row * s.actuation.padded);
      const V rate = hn::Load(d, springs.rest_length + at) * rates.at(springs.material + at);
      put_into_slots(s, at, actuation_power(pull, rate), s.motion.power_sum, add);
    }
  }

  /// Replaces the number in each spring's slot of `recorded` by join(number, value).
  template <class T, class V, class Join>
  static void put_into_slots(const Stepper<T>& s, std::size_t at, V values, T* recorded, const Join& join) {
    const hn::ScalableTag<T> d;
    HWY_ALIGN T numbers[hn::MaxLanes(hn::ScalableTag<T>())];
    hn::Store(values, d, numbers);
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
      if (!is_spring(s, at + lane)) continue;
      T& slot = recorded[s.motion.coloured.slot[at + lane]];
      slot = join(slot, numbers[lane]);
    }
  }

  /// Solves rough ground as solve_floor() does level ground, with the ground's slope at the beginning of the step.
  template <class T>
  static void solve_rough_floor(const Stepper<T>& s) {
    const hn::ScalableTag<T> d;
    using V = hn::Vec<decltype(d)>;
    const cpu::Motion<T>& m = s.motion;
    const V dt = hn::Set(d, s.constants.step.dt), damped_dt = hn::Set(d, s.constants.step.damped_dt);
    const V stiffness = hn::Set(d, s.constants.floor_stiffness);
    for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d)) {
      const Ground<V> ground = ground_under(m, s.constants, i);
      const Triple<V> v{hn::Load(d, m.vx + i), hn::Load(d, m.vy + i), hn::Load(d, m.vz + i)};
      const V depth = ground.height - advanced_position(hn::Load(d, m.z + i), along_normal(ground, v), dt);
      const V inverse_mass = hn::Load(d, m.inverse_mass + i);
      const V force = compliant_force(stiffness, maximum(depth, hn::Zero(d)), dt * damped_dt,
                                      inverse_mass * normal_squared(ground));
      const Triple<V> pushed = add_along_normal(ground, v, force * damped_dt * inverse_mass);
      hn::Store(force, d, m.floor_force + i);
      hn::Store(pushed.x, d, m.vx + i);
      hn::Store(pushed.y, d, m.vy + i);
      hn::Store(pushed.z, d, m.vz + i);
    }
  }

  /// Solves the floor: pushes up masses that would end the step below it.
  template <class T>
  static void solve_floor(const Stepper<T>& s) {
    const hn::ScalableTag<T> d;
    const cpu::Motion<T>& m = s.motion;
    const auto dt = hn::Set(d, s.constants.step.dt), damped_dt = hn::Set(d, s.constants.step.damped_dt);
    const auto stiffness = hn::Set(d, s.constants.floor_stiffness);
    for (std::size_t i = 0; i < s.masses; i += hn::Lanes(d)) {
      const auto vz = hn::Load(d, m.vz + i), inverse_mass = hn::Load(d, m.inverse_mass + i);
      const auto depth = maximum(hn::Zero(d) - advanced_position(hn::Load(d, m.z + i), vz, dt), hn::Zero(d));
      const auto force = compliant_force(stiffness, depth, dt * damped_dt, inverse_mass);
      hn::Store(force, d, m.floor_force + i);
      hn::Store(advanced_velocity(vz, force, damped_dt * inverse_mass), d, m.vz + i);
    }
  }
};

template cpu::Integrator<float> integrator<Xpbd, float>();
template cpu::Integrator<double> integrator<Xpbd, double>();

}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
