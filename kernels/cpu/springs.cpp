// The loop over a body's springs. Compiled once for each instruction set.
#include "cpu/instruction_sets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/springs.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "cpu/actuation-inl.hpp"
#include "cpu/positions-inl.hpp"
#include "cpu/stepper-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace evodevo::HWY_NAMESPACE {

/// A choice of sums that is known at compile time, so that the loop contains no code for other sums. Most runs use one
/// of these.
template <bool force_on, bool power_on>
struct UsualSums {
  template <class T>
  explicit UsualSums(const cpu::Motion<T>&) {}
  static constexpr bool force = force_on, power = power_on, peak = false, tension = false;
};

/// A choice of sums that is known at run time: those that the motion has arrays for.
struct AnySums : cpu::Sums {
  template <class T>
  explicit AnySums(const cpu::Motion<T>& m)
      : Sums{m.force_sum != nullptr, m.power_sum != nullptr, m.peak != nullptr, m.tension_sum != nullptr} {}
};

/// The vectors of consecutive masses, beginning with the mass of index i, in an interleaved array.
template <class T>
HWY_INLINE Triple<hn::Vec<hn::ScalableTag<T>>> own_interleaved(const T* interleaved, std::size_t i) {
  const hn::ScalableTag<T> d;
  Triple<hn::Vec<decltype(d)>> own;
  [[maybe_unused]] hn::Vec<decltype(d)> padding;
  hn::LoadInterleaved4(d, interleaved + cpu::position_stride * i, own.x, own.y, own.z, padding);
  return own;
}

/// Computes the spring forces on the masses of one group.
///
///   in:  positions, if `damped` also interleaved velocities, springs of the group, `lengths` (current relative length
///        of each material), `rates` (its rate of change, 1/s; not read without sums.power)
///   out: motion.fx, fy, fz: the sum of the forces of springs and dashpots on each mass, N; the enabled sums, for each
///        slot. A muscle does the work of its spring alone.
template <bool damped, class Sums, class Table, class T>
HWY_INLINE void set_spring_forces(const cpu::Motion<T>& motion, const Sums& sums, std::size_t group,
                                  const Table& lengths, const Table& rates) {
  using D = hn::ScalableTag<T>;
  using V = hn::Vec<D>;
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  const std::size_t at = group * lanes;
  const Triple<V> own{hn::Load(d, motion.x + at), hn::Load(d, motion.y + at), hn::Load(d, motion.z + at)};
  Triple<V> force{hn::Zero(d), hn::Zero(d), hn::Zero(d)}, own_velocity = force;
  if constexpr (damped) own_velocity = own_interleaved(motion.interleaved_velocities, at);
  const std::size_t end = motion.first_row[group + 1] * lanes;
  std::size_t slot = motion.first_row[group] * lanes;
  // positions are read one row ahead, so that the loads overlap with the square root and division of this row
  Separation<V> next = separation(own, load_positions(d, motion.interleaved_positions, motion.neighbour + slot));
  for (; slot < end; slot += lanes) {
    const Separation<V> s = next;
    const V distance = length(s);
    next = separation(own, load_positions(d, motion.interleaved_positions, motion.neighbour + slot + lanes));
    const cpu::Index<T>* material = motion.material + slot;
    const V rest_length = hn::Load(d, motion.rest_length + slot);
    const V elastic = spring_factor(distance, hn::Load(d, motion.stiffness + slot), rest_length * lengths.at(material));
    V factor = elastic;
    if constexpr (damped) {
      const Triple<V> other = load_positions(d, motion.interleaved_velocities, motion.neighbour + slot);
      const Triple<V> velocity{other.x - own_velocity.x, other.y - own_velocity.y, other.z - own_velocity.z};
      factor = factor + dashpot_factor(s, hn::Load(d, motion.damping + slot), velocity);
    }
    force.x = multiply_add(factor, s.d.x, force.x);
    force.y = multiply_add(factor, s.d.y, force.y);
    force.z = multiply_add(factor, s.d.z, force.z);
    const V tension = spring_tension(s, distance, factor);
    if (sums.force) {
      T* sum = motion.force_sum + slot;
      hn::Store(hn::Load(d, sum) + hn::Abs(tension), d, sum);
    }
    if (sums.power) {
      T* sum = motion.power_sum + slot;
      const V pull = damped ? spring_tension(s, distance, elastic) : tension;
      hn::Store(hn::Load(d, sum) + actuation_power(pull, rest_length * rates.at(material)), d, sum);
    }
    if (sums.peak) {
      T* peak = motion.peak + slot;
      hn::Store(hn::Max(hn::Load(d, peak), hn::Abs(tension)), d, peak);
    }
    if (sums.tension) {
      T* sum = motion.tension_sum + slot;
      hn::Store(hn::Load(d, sum) + tension, d, sum);
    }
  }
  hn::Store(force.x, d, motion.fx + at);
  hn::Store(force.y, d, motion.fy + at);
  hn::Store(force.z, d, motion.fz + at);
}

template <bool damped, class Table, class Sums, class T>
void set_spring_forces(const cpu::Motion<T>& motion, const cpu::Actuation<T>& actuation, std::size_t row) {
  const Sums sums(motion);
  const T* relative_length = actuation.relative_length + row * actuation.padded;
  const Table lengths(relative_length);
  const Table rates(sums.power ? actuation.relative_rate + row * actuation.padded : relative_length);
  for (std::size_t group = 0; group < motion.groups; ++group)
    set_spring_forces<damped>(motion, sums, group, lengths, rates);
}

template <bool damped, class Table, class T>
SpringPass<T> spring_pass_with(cpu::Sums sums) {
  if (sums.peak || sums.tension) return set_spring_forces<damped, Table, AnySums, T>;
  if (sums.force && sums.power) return set_spring_forces<damped, Table, UsualSums<true, true>, T>;
  if (sums.force) return set_spring_forces<damped, Table, UsualSums<true, false>, T>;
  if (sums.power) return set_spring_forces<damped, Table, UsualSums<false, true>, T>;
  return set_spring_forces<damped, Table, UsualSums<false, false>, T>;
}

/// Returns the pass over the springs that adds to the given sums.
template <bool damped, class T>
SpringPass<T> spring_pass(const cpu::Actuation<T>& actuation, cpu::Sums sums) {
  if constexpr (register_table_size<T>() > 0)
    if (actuation.materials <= register_table_size<T>()) return spring_pass_with<damped, TableInRegisters<T>, T>(sums);
  return spring_pass_with<damped, TableInMemory<T>, T>(sums);
}

template <class T>
SpringPass<T> spring_pass(bool damped, const cpu::Actuation<T>& actuation, cpu::Sums sums) {
  return damped ? spring_pass<true>(actuation, sums) : spring_pass<false>(actuation, sums);
}
template SpringPass<float> spring_pass(bool, const cpu::Actuation<float>&, cpu::Sums);
template SpringPass<double> spring_pass(bool, const cpu::Actuation<double>&, cpu::Sums);

}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
