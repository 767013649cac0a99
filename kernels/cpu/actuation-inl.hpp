// Actuation: tables of the relative length L(t)/L0 of each material. Included once per instruction set.
#if defined(EVODEVO_CPU_ACTUATION_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef EVODEVO_CPU_ACTUATION_INL_HPP
#undef EVODEVO_CPU_ACTUATION_INL_HPP
#else
#define EVODEVO_CPU_ACTUATION_INL_HPP
#endif

#include <hwy/contrib/math/math-inl.h>

#include "cpu/step.hpp"
#include "physics/vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace evodevo::HWY_NAMESPACE {

/// The largest number of materials whose row is held in registers; 0 if no row is.
template <class T>
constexpr std::size_t register_table_size() {
  constexpr std::size_t lanes = hn::MaxLanes(hn::ScalableTag<T>());
  return lanes >= 8 ? 16 : 0;
}

/// A row of a table, which is read from memory one lane after the other, because gather instructions are slower on many
/// processors.
template <class T>
struct TableInMemory {
  using D = hn::ScalableTag<T>;
  static constexpr std::size_t lanes = hn::MaxLanes(D());

  HWY_INLINE explicit TableInMemory(const T* row_) : row(row_) {}

  /// The entries of the materials material[0], material[1], .., one per lane.
  HWY_INLINE hn::Vec<D> at(const cpu::Index<T>* material) const {
    HWY_ALIGN T values[lanes];
    for (std::size_t lane = 0; lane < lanes; ++lane) values[lane] = row[material[lane]];
    return hn::Load(D(), values);
  }

  const T* row;
};

/// A row of up to 16 entries, held in one or two registers.
template <class T>
struct TableInRegisters {
  using D = hn::ScalableTag<T>;
  using DI = hn::ScalableTag<cpu::Index<T>>;
  static constexpr std::size_t lanes = hn::MaxLanes(D());

  HWY_INLINE explicit TableInRegisters(const T* row)
      : low(hn::Load(D(), row)), high(hn::Load(D(), row + (lanes < 16 ? lanes : 0))) {}

  HWY_INLINE hn::Vec<D> at(const cpu::Index<T>* material) const {
    const D d;
    const DI di;
    const auto index = hn::Load(di, material);
    if constexpr (lanes == 16) return hn::TableLookupLanes(low, hn::IndicesFromVec(d, index));
    const auto upper = hn::Set(di, static_cast<cpu::Index<T>>(lanes));
    const auto in_half = hn::IndicesFromVec(d, hn::AndNot(upper, index));
    return hn::IfThenElse(hn::RebindMask(d, hn::TestBit(index, upper)), hn::TableLookupLanes(high, in_half),
                          hn::TableLookupLanes(low, in_half));
  }

  hn::Vec<D> low, high;
};

/// Stores doubles as doubles or floats.
template <class D>
HWY_INLINE void store_as(D d, hn::Vec<D> values, double* to) {
  hn::Store(values, d, to);
}
template <class D>
HWY_INLINE void store_as(D, hn::Vec<D> values, float* to) {
  const hn::Rebind<float, D> df;
  hn::Store(hn::DemoteTo(df, values), df, to);
}

/// Kernels::actuate.
template <class T>
void actuate(const cpu::Actuation<T>& actuation, double start, std::uint64_t first, std::size_t rows, double dt) {
  const hn::ScalableTag<double> d;
  const auto full_turn = hn::Set(d, 2 * 3.14159265358979323846);
  for (std::size_t row = 0; row < rows; ++row) {
    const auto time = hn::Set(d, start + static_cast<double>(first + row) * dt);
    for (std::size_t m = 0; m < actuation.padded; m += hn::Lanes(d)) {
      const auto amplitude = hn::Load(d, actuation.amplitude + m);
      const auto frequency = hn::Load(d, actuation.frequency + m);
      // the phase is reduced in double precision, so that late times lose no digits
      const auto turns = frequency * time;
      const auto angle = full_turn * (turns - hn::Floor(turns)) + hn::Load(d, actuation.phase + m);
      const std::size_t entry = row * actuation.padded + m;
      store_as(d, hn::Set(d, 1.0) + amplitude * hn::Sin(d, angle), actuation.relative_length + entry);
      if (actuation.relative_rate != nullptr)
        store_as(d, full_turn * frequency * amplitude * hn::Cos(d, angle), actuation.relative_rate + entry);
    }
  }
}

}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
