// The loop over a body's springs; included once per instruction set.
#if defined(EVODEVO_CPU_SPRINGS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef EVODEVO_CPU_SPRINGS_INL_HPP
#undef EVODEVO_CPU_SPRINGS_INL_HPP
#else
#define EVODEVO_CPU_SPRINGS_INL_HPP
#endif

#include "cpu/actuation-inl.hpp"
#include "cpu/positions-inl.hpp"
#include "cpu/step.hpp"

HWY_BEFORE_NAMESPACE();
namespace evodevo::HWY_NAMESPACE {

/// Sums that are known when the code is compiled: those that most runs ask for, whose loops hold nothing else.
template <bool force_on, bool power_on>
struct UsualSums {
  template <class T>
  explicit UsualSums(const cpu::Motion<T>&) {}
  static constexpr bool force = force_on, power = power_on, peak = false, tension = false;
};

/// Sums that a motion has room for.
struct AnySums : cpu::Sums {
  template <class T>
  explicit AnySums(const cpu::Motion<T>& m)
      : Sums{m.force_sum != nullptr, m.power_sum != nullptr, m.peak != nullptr, m.tension_sum != nullptr} {}
};

/// Sets the motion's forces on a group's masses to the sums of the spring forces, and adds to the sums that are on.
/// `lengths` and `rates` are rows of the tables; without power, `rates` is not read.
template <class Sums, class Table, class T>
HWY_INLINE void set_spring_forces(const cpu::Motion<T>& motion, const Sums& sums, std::size_t group,
                                  const Table& lengths, const Table& rates) {
  using D = hn::ScalableTag<T>;
  using V = hn::Vec<D>;
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  const std::size_t at = group * lanes;
  const Triple<V> own{hn::Load(d, motion.x + at), hn::Load(d, motion.y + at), hn::Load(d, motion.z + at)};
  Triple<V> force{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  const std::size_t end = motion.first_row[group + 1] * lanes;
  std::size_t slot = motion.first_row[group] * lanes;
  // one row ahead: the next row's places are on their way while this row waits for its root and its division
  Separation<V> next = separation(own, load_positions(d, motion.interleaved_positions, motion.neighbour + slot));
  for (; slot < end; slot += lanes) {
    const Separation<V> s = next;
    const V distance = length(s);
    next = separation(own, load_positions(d, motion.interleaved_positions, motion.neighbour + slot + lanes));
    const cpu::Index<T>* material = motion.material + slot;
    const V rest_length = hn::Load(d, motion.rest_length + slot);
    const V factor = spring_factor(distance, hn::Load(d, motion.stiffness + slot), rest_length * lengths.at(material));
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
      hn::Store(hn::Load(d, sum) + actuation_power(tension, rest_length * rates.at(material)), d, sum);
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

}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
