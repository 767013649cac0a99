// A body's springs in the order in which a Gauss-Seidel method (xpbd) solves them.
#pragma once

#include "cpu/layout.hpp"

namespace evodevo::cpu {

/// The springs sorted by colour (spring_colours()). Each colour is padded to whole SIMD vectors with springs of
/// stiffness 0 from a mass to itself. All arrays have `size` entries, one per spring or padding.
template <class T>
struct ColouredSprings {
  ColouredSprings() = default;
  ColouredSprings(const Body& body, const Layout<T>& layout);

  std::size_t size = 0;
  Array<std::uint32_t> a, b;                ///< position_stride times the masses' indices in Layout::mass_at
  Array<std::uint32_t> slot;                ///< Layout::slot_of the spring
  Array<T> stiffness;                       ///< N/m
  Array<T> rest_length;                     ///< m
  Array<T> damping;                         ///< Layout::damping
  Array<T> inverse_mass_a, inverse_mass_b;  ///< 1/kg
  Array<Index<T>> material;                 ///< index into Body::materials
};

extern template struct ColouredSprings<float>;
extern template struct ColouredSprings<double>;

}  // namespace evodevo::cpu
