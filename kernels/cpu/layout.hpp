// The memory layout of a body while it is simulated on the CPU.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "cpu/array.hpp"
#include "evodevo/body.hpp"

namespace evodevo::cpu {

/// An integer of the same size as T, which SIMD code needs for indices that belong to vectors of T.
template <class T>
using Index = std::conditional_t<sizeof(T) == sizeof(float), std::int32_t, std::int64_t>;

/// Numbers per mass in an interleaved array of positions: x, y, z and one number of padding, so that one load
/// instruction reads the position of a neighbour.
inline constexpr std::size_t position_stride = 4;

/// A body's springs, listed by mass. Masses are sorted by descending degree (number of springs) and divided into groups
/// of `lanes`, one mass per SIMD lane. A group has as many rows as its mass of highest degree has springs. Row r holds
/// the r-th spring of each mass, so that every lane adds up its mass's forces in a fixed order. A slot is one lane of
/// one row. Every spring is in two slots, one at each end. Empty slots hold springs of stiffness 0 from a mass to
/// itself.
template <class T>
struct Layout {
  Layout(const Body& body, std::size_t lanes);

  std::size_t lanes, masses, springs;
  std::size_t groups;                    ///< ceil(masses / lanes)
  std::vector<std::uint32_t> mass_at;    ///< [masses] index into Body::masses of each sorted mass
  std::vector<std::uint32_t> slot_of;    ///< [springs] one of the two slots of each spring
  std::vector<std::uint32_t> first_row;  ///< [groups + 1] the rows of group g are first_row[g] .. first_row[g + 1] - 1
  Array<std::uint32_t>
      neighbour;         ///< [slots + lanes] position_stride times the index in mass_at of the mass at the other end
  Array<T> stiffness;    ///< [slots] N/m
  Array<T> rest_length;  ///< [slots] m
  Array<T> damping;      ///< [slots] coefficient of the spring's dashpot, N s/m; empty if no spring has one
  Array<Index<T>> material;  ///< [slots] index into Body::materials

  std::size_t padded_masses() const { return groups * lanes; }
  std::size_t slots() const { return first_row.back() * lanes; }
};

extern template struct Layout<float>;
extern template struct Layout<double>;

}  // namespace evodevo::cpu
