// How far bodies that come of one genome are from each other.
#pragma once

#include "environments/grown_body.hpp"

namespace evodevo {

/// Masses that came later are the same in two lives where their rest positions are nearer than this, body lengths at
/// birth: as near as operators let masses come to each other by default, 0.02 m, in a body that fills the cube of the
/// neural encoding. Which and how many masses came before them says nothing of what they are.
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
