// Distances between bodies that developed from the same genome.
#pragma once

#include "environments/grown_body.hpp"

namespace evodevo {

/// Masses that were added after birth in two lives count as the same mass if their rest positions are closer than this,
/// in body lengths at birth. By default, operators keep masses at least 0.02 m apart; in a body that fills the cube of
/// the neural encoding, whose sides are 2 m long, that is 0.01 body lengths. The numbers of such masses cannot identify
/// them, because a number depends on how many masses were added before this one.
inline constexpr double same_position = 0.01;

/// Returns the Jaccard distance between the springs of two bodies: of all springs that either body has, the fraction
/// that only one body has. It is 0 if both bodies have the same springs, and 1 if they have none in common. A spring is
/// identified by its two masses. Masses that the bodies have had since birth are identified by their numbers; masses
/// that were added later are matched by their rest positions, the closest pairs first.
double spring_distance(const GrownBody& a, const GrownBody& b);

/// Returns how far mass has to be moved to turn the mass distribution of one body into that of the other, in body
/// lengths at birth: the Wasserstein distance between the coordinates of the rest positions along one axis, averaged
/// over the three axes. The total mass of each body counts as 1; the scene's payload does not count. The numbers of
/// masses do not matter: the distance is 0 if the masses of both bodies have the same rest positions. Rest positions
/// are compared rather than present positions, because the poses of soft bodies differ between scenes by more than
/// development moves masses. Each body must have at least one mass.
double mass_distance(const GrownBody& a, const GrownBody& b);

}  // namespace evodevo
