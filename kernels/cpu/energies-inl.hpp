// The energies of a body, which the guard against divergence checks. Included once per instruction set.
#if defined(EVODEVO_CPU_ENERGIES_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef EVODEVO_CPU_ENERGIES_INL_HPP
#undef EVODEVO_CPU_ENERGIES_INL_HPP
#else
#define EVODEVO_CPU_ENERGIES_INL_HPP
#endif

#include "cpu/actuation-inl.hpp"
#include "cpu/positions-inl.hpp"
#include "cpu/step.hpp"

HWY_BEFORE_NAMESPACE();
namespace evodevo::HWY_NAMESPACE {

template <class T>
double elastic_energy_of(const cpu::Motion<T>& m, const cpu::Actuation<T>& actuation) {
  const hn::ScalableTag<T> d;
  using V = hn::Vec<decltype(d)>;
  const std::size_t lanes = hn::Lanes(d);
  const TableInMemory<T> lengths(actuation.relative_length);
  V sum = hn::Zero(d);
  for (std::size_t group = 0; group < m.groups; ++group) {
    const std::size_t at = group * lanes;
    const Triple<V> own{hn::Load(d, m.x + at), hn::Load(d, m.y + at), hn::Load(d, m.z + at)};
    const std::size_t end = m.first_row[group + 1] * lanes;
    for (std::size_t slot = m.first_row[group] * lanes; slot < end; slot += lanes) {
      const Separation<V> s = separation(own, load_positions(d, m.interleaved_positions, m.neighbour + slot));
      const V length = hn::Load(d, m.rest_length + slot) * lengths.at(m.material + slot);
      sum = sum + elastic_energy(s, hn::Load(d, m.stiffness + slot), length);
    }
  }
  // every spring is in two slots, one at each end
  return static_cast<double>(hn::GetLane(hn::SumOfLanes(d, sum))) / 2;
}

template <class T>
cpu::Energies energies(const cpu::Motion<T>& m, const cpu::StepConstants<T>& constants,
                       const cpu::Actuation<T>& actuation) {
  const hn::ScalableTag<T> d;
  using V = hn::Vec<decltype(d)>;
  const V grade = hn::Set(d, constants.grade);
  V kinetic = hn::Zero(d), height_moment = hn::Zero(d), not_finite = hn::Zero(d);
  for (std::size_t i = 0; i < m.groups * hn::Lanes(d); i += hn::Lanes(d)) {
    const Triple<V> v{hn::Load(d, m.vx + i), hn::Load(d, m.vy + i), hn::Load(d, m.vz + i)};
    const V mass = hn::Load(d, m.mass + i), x = hn::Load(d, m.x + i), z = hn::Load(d, m.z + i);
    kinetic = kinetic + kinetic_energy(mass, v);
    height_moment = multiply_add(mass, height(x, z, grade), height_moment);
    // zero times a finite number is 0; zero times infinity or NaN is NaN, and so is every sum with it
    const V total = (x + hn::Load(d, m.y + i) + z) + (v.x + v.y + v.z);
    not_finite = multiply_add(total, hn::Zero(d), not_finite);
  }
  const bool finite = hn::GetLane(hn::SumOfLanes(d, not_finite)) == T(0);
  return {static_cast<double>(hn::GetLane(hn::SumOfLanes(d, kinetic))), elastic_energy_of(m, actuation),
          static_cast<double>(hn::GetLane(hn::SumOfLanes(d, height_moment))), finite};
}

}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
