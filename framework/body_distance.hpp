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

/// The part of all masses of two bodies that only one of them has (Jaccard's distance). Masses that came later are the
/// same where as many had come before them. Places do not count: soft bodies lie and bend otherwise in each scene, by
/// more than development moves.
double mass_distance(const GrownBody& a, const GrownBody& b);

}  // namespace evodevo
