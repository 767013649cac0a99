// A body's springs in the order in which a Gauss-Seidel method solves them.
#pragma once

#include "cpu/layout.hpp"

namespace evodevo::cpu {

/// The springs by colour (spring_colours()), each colour filled up to whole vectors of `lanes` springs with springs of
/// stiffness 0 from a mass to itself.
template <class T>
struct ColouredSprings {
  ColouredSprings() = default;
  ColouredSprings(const Body& body, const Layout<T>& layout);

  std::size_t size = 0;
  Array<std::uint32_t> a, b;                ///< position_stride times the places of the masses
  Array<std::uint32_t> slot;                ///< Layout::slot_of
  Array<T> stiffness;                       ///< N/m
  Array<T> rest_length;                     ///< m
  Array<T> inverse_mass_a, inverse_mass_b;  ///< 1/kg
  Array<Index<T>> material;                 ///< index into Body::materials
};

extern template struct ColouredSprings<float>;
extern template struct ColouredSprings<double>;

}  // namespace evodevo::cpu
