// A block of cubic voxels whose corners are masses and whose edges, face diagonals and body diagonals are springs.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "evodevo/body.hpp"

namespace evodevo {

/// One possible spring of a lattice and the voxels that it belongs to.
struct LatticeSpring {
  std::uint32_t a = 0, b = 0;         ///< corners, a < b
  std::vector<std::uint32_t> voxels;  ///< ascending
};

/// The corners of a block of voxels, and all springs that a body made of these voxels may have.
struct Lattice {
  std::array<std::uint32_t, 3> size;   ///< voxels along x, y, z
  std::vector<Vec3> corners;           ///< (x+1)(y+1)(z+1) positions, x fastest, from the origin, m
  std::vector<LatticeSpring> springs;  ///< ascending by (a, b)

  std::uint32_t voxels() const { return size[0] * size[1] * size[2]; }
  /// Whether a spring joins opposite corners of a voxel.
  bool is_body_diagonal(const LatticeSpring& spring) const {
    const Vec3 d = corners[spring.b] - corners[spring.a];
    return d.x != 0 && d.y != 0 && d.z != 0;
  }
  /// Returns the voxel that is the mirror image of a voxel across the plane through the middle of the block at right
  /// angles to x.
  std::uint32_t mirrored_voxel(std::uint32_t voxel) const { return mirrored(voxel, size[0]); }
  /// Returns the corner that is the mirror image of a corner across the same plane.
  std::uint32_t mirrored_corner(std::uint32_t corner) const { return mirrored(corner, size[0] + 1); }

 private:
  /// Returns the mirror image of one of several items that are numbered with x fastest, `along_x` in a row.
  static std::uint32_t mirrored(std::uint32_t item, std::uint32_t along_x) {
    return item + along_x - 1 - 2 * (item % along_x);
  }
};

/// The lattice of size[0] x size[1] x size[2] voxels with edges of `edge` metres. Ten voxels per side give the body of
/// the paper's benchmark: 1,331 masses and 14,230 springs (section V-A).
inline Lattice make_lattice(std::array<std::uint32_t, 3> size, double edge) {
  Lattice lattice{size, {}, {}};
  const auto corner = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return x + (size[0] + 1) * (y + (size[1] + 1) * z);
  };
  for (std::uint32_t z = 0; z <= size[2]; ++z)
    for (std::uint32_t y = 0; y <= size[1]; ++y)
      for (std::uint32_t x = 0; x <= size[0]; ++x) lattice.corners.push_back({x * edge, y * edge, z * edge});

  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> voxels_of;
  std::uint32_t voxel = 0;
  for (std::uint32_t z = 0; z < size[2]; ++z)
    for (std::uint32_t y = 0; y < size[1]; ++y)
      for (std::uint32_t x = 0; x < size[0]; ++x, ++voxel) {
        std::array<std::uint32_t, 8> corners{};
        for (std::uint32_t c = 0; c < 8; ++c) corners[c] = corner(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2));
        // every pair of a voxel's corners is an edge, a face diagonal or a body diagonal
        for (std::uint32_t i = 0; i < 8; ++i)
          for (std::uint32_t j = i + 1; j < 8; ++j) voxels_of[std::minmax(corners[i], corners[j])].push_back(voxel);
      }
  for (auto& [pair, voxels] : voxels_of) lattice.springs.push_back({pair.first, pair.second, std::move(voxels)});
  return lattice;
}

}  // namespace evodevo
