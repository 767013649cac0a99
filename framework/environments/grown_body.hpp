// Bodies as they grow, in a frame in which what grows of one genome can be compared.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "life/evaluation.hpp"

namespace evodevo {

/// What a life has made of a body so far.
struct GrownBody {
  Body body;
  std::vector<Vec3> positions;  ///< of its masses, m
  std::vector<Vec3>
      rest_positions;  ///< of its masses in the undeformed body, body lengths at birth; see GrowthObserver
  std::vector<std::uint32_t> numbers;  ///< of its masses (MassNumbers)
  std::size_t born = 0;                ///< how many masses it had at birth; those have the numbers below

  bool came_later(std::size_t mass) const { return numbers[mass] >= born; }
};

/// Where `place` lies in the undeformed body, m, if masses that now are at `positions` belong to `rest_positions`;
/// where it is if there are none. It goes along with the masses around it: by the rotation and shift that best take
/// them back, weighted by distance^-4, so that near ones outweigh all far ones in three dimensions (rigid moving least
/// squares: Schaefer, McPhail and Warren 2006).
Vec3 undeformed(Vec3 position, std::span<const Vec3> positions, std::span<const Vec3> rest_positions);

/// Follows one life and knows the rest position of every mass: that which it has at birth, or else undeformed() of
/// where it comes, by the masses that were there before. Rest positions are measured from the lower corner of the
/// body's box at birth, in the longest sides of that box, since each scene puts the body elsewhere.
class GrowthObserver {
 public:
  explicit GrowthObserver(const Body& born);

  /// The body after a cycle; to be called after each, since masses are where they came only then.
  GrownBody after_cycle(const Life& life);

 private:
  Vec3 corner_;        ///< m
  double length_ = 1;  ///< at birth, m; without any, the unit
  std::size_t born_;
  std::map<std::uint32_t, Vec3> rest_;  ///< by the numbers of the masses, m
};

}  // namespace evodevo
