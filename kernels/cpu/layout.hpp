// How a body lies in memory while it is simulated on the CPU.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "cpu/array.hpp"
#include "evodevo/body.hpp"

namespace evodevo::cpu {

/// An integer as wide as T, as vectors of T need it.
template <class T>
using Index = std::conditional_t<sizeof(T) == sizeof(float), std::int32_t, std::int64_t>;

/// The numbers of one place: x, y, z and one that fills up, so that one load brings a neighbour.
inline constexpr std::size_t position_stride = 4;

/// A body's springs as its masses see them. Masses are sorted by how many springs they have and handled in groups of
/// `lanes`, one lane each. A group has as many rows as its most connected mass has springs; row r holds every mass's
/// r-th spring, so that all lanes add up their forces in one fixed order. Every spring is in two slots (row, lane), one
/// at each end. Empty slots hold springs of stiffness 0 from a mass to itself.
template <class T>
struct Layout {
  Layout(const Body& body, std::size_t lanes);

  std::size_t lanes, masses, springs;
  std::size_t groups;                    ///< ceil(masses / lanes)
  std::vector<std::uint32_t> mass_at;    ///< [masses] index into Body::masses of the mass at each place
  std::vector<std::uint32_t> slot_of;    ///< [springs] one slot of each spring
  std::vector<std::uint32_t> first_row;  ///< [groups + 1] the rows of group g are first_row[g] .. first_row[g + 1] - 1
  Array<std::uint32_t> neighbour;  ///< [slots + lanes] position_stride times the place of the mass at the other end
  Array<T> stiffness;              ///< [slots] N/m
  Array<T> rest_length;            ///< [slots] m
  Array<Index<T>> material;        ///< [slots] index into Body::materials

  std::size_t padded_masses() const { return groups * lanes; }
  std::size_t slots() const { return first_row.back() * lanes; }
};

extern template struct Layout<float>;
extern template struct Layout<double>;

}  // namespace evodevo::cpu
