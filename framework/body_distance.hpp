// How far bodies that come of one genome are from each other.
#pragma once

#include "life_record.hpp"

namespace evodevo {

/// A body and what it takes to compare it.
struct GrownBody {
  Body body;
  std::vector<Vec3> places;            ///< of its masses, m
  std::vector<std::uint32_t> numbers;  ///< of its masses, by which they are the same in another life (MassNumbers)
};

/// The part of all springs of two bodies that only one of them has (Jaccard's distance); a spring is named by the
/// numbers of its two masses. 0 for equal bodies, 1 where no spring is in both.
double spring_distance(const GrownBody& a, const GrownBody& b);

/// The part of a body's mass that would have to go elsewhere to be distributed as the other's, loads included: half the
/// sum of |difference| over cells whose edge is a tenth of the larger body's longest side, both bodies with their
/// centre of mass in the origin. A mass counts for the eight nearest cells, more for the nearer, so that the distance
/// has no jumps. 0 for equal bodies, 1 where no cell is filled by both.
double mass_distance(const GrownBody& a, const GrownBody& b);

}  // namespace evodevo
