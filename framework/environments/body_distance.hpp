// Distances between bodies that grow from the same genome.
#pragma once

#include "environments/grown_body.hpp"

namespace evodevo {

/// Masses that were added after birth in two lives count as the same mass if their rest positions are closer than this,
/// in body lengths at birth. The value is the smallest distance that operators keep between masses by default, 0.02 m,
/// in a body that fills the cube of the neural encoding. The number and identity of the masses added before a mass do
/// not help to identify it.
inline constexpr double same_position = 0.01;

/// The part of all springs of two bodies that only one of them has (Jaccard's distance); a spring is named by its two
/// masses, those of birth by their numbers, later ones by their positions, the nearest pairs first. 0 for equal bodies,
/// 1 where no spring is in both.
double spring_distance(const GrownBody& a, const GrownBody& b);

/// How far mass has to be moved to make one body's distribution that of the other, body lengths at birth: the
/// Wasserstein distance of the rest positions' coordinates along an axis, mean of the three axes. Both bodies count as
/// one kilogram, the payload of the scene as none. A metric of the three distributions: 0 for bodies whose masses have
/// the same rest positions, numbers or not. Poses do not count: soft bodies lie and bend otherwise in each scene, by
/// more than development moves. Each body has a mass at least.
double mass_distance(const GrownBody& a, const GrownBody& b);

}  // namespace evodevo
