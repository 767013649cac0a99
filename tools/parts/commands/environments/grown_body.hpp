// Developing bodies with the rest positions of their masses, in a frame of reference in which bodies of one genome can
// be compared.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "life/life.hpp"

namespace evodevo {

/// A body at some time during its development.
struct GrownBody {
  Body body;
  std::vector<Vec3> positions;  ///< present positions of the masses, m
  std::vector<Vec3>
      rest_positions;  ///< positions of the masses in the undeformed body, body lengths at birth; see GrowthObserver
  std::vector<std::uint32_t> numbers;  ///< numbers of the masses (MassNumbers)
  std::size_t born = 0;                ///< number of masses at birth; these masses have the numbers 0 to born-1

  /// Returns whether a mass was added after birth.
  bool came_later(std::size_t mass) const { return numbers[mass] >= born; }
};

/// Maps a position in the present, deformed body to the undeformed body, m. `positions` are the present positions of
/// the masses, `rest_positions` those in the undeformed body. The map is the rotation and translation that best map
/// `positions` to `rest_positions`, weighted by distance^-4, so that near masses outweigh all far ones in three
/// dimensions (rigid moving least squares: Schaefer, McPhail and Warren 2006). Returns `position` if there are no
/// masses.
Vec3 undeformed(Vec3 position, std::span<const Vec3> positions, std::span<const Vec3> rest_positions);

/// Follows one life and keeps the rest position of every mass. For a mass that exists at birth, this is its rest
/// position at birth. For a mass that is added later, undeformed() computes it from the position at which the mass was
/// added and from the masses that were in the body before. Rest positions are relative to the lower corner of the
/// body's bounding box at birth, in units of the longest side of that box, because each scene puts the body at another
/// position.
class GrowthObserver {
 public:
  explicit GrowthObserver(const Body& born);

  /// Returns the body after a cycle. Must be called after every cycle, because new masses are at the positions at which
  /// they were added only until the simulation continues.
  GrownBody after_cycle(const Life& life);

 private:
  Vec3 corner_;        ///< lower corner of the bounding box at birth, m
  double length_ = 1;  ///< body length at birth, m; 1 if the body has no extent
  std::size_t born_;
  std::map<std::uint32_t, Vec3> rest_;  ///< rest positions by the numbers of the masses, m
};

}  // namespace evodevo
