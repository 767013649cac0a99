// The properties of a body, or of a part of one, on which its arrangement depends.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "evodevo/body.hpp"

namespace evodevo::cuda {

/// The masses that a block simulates, the masses in its halo (formats.hpp), and the pairs of them that springs join.
struct Outline {
  using Ends = std::pair<std::uint32_t, std::uint32_t>;

  Outline() = default;
  explicit Outline(const Body& body);
  /// Whether this is the outline of `body`, except for rest positions.
  bool fits(const Body& body) const;

  std::vector<Vec3> rest;  ///< [masses] rest positions, by which masses are recognised later
  std::vector<Ends> ends;  ///< [springs inside] both masses
  std::uint32_t halo = 0;  ///< number of masses in the halo
  std::vector<Ends> cut;   ///< [cut springs] the mass and the index of the other one in the halo
};

}  // namespace evodevo::cuda
