// What runs have in common that are one run made in several pieces.
#pragma once

#include <cstdint>

#include "physics/energy_bound.hpp"

namespace evodevo {

/// Forces as integers (GPU): how large they may be and how fine they are.
struct ForceRange {
  double resolution = 1;  ///< N, a power of two
  double largest = 0;     ///< N; no spring's force may be larger
};

/// How far a run has come, and what was settled where it began. Times, checks and bounds count from there, so that its
/// pieces end in the same bits as the whole.
struct Course {
  double origin = 0;        ///< State::time at its beginning, s
  std::uint64_t steps = 0;  ///< made since then
  EnergyBound bound;
  double fallen = 0;        ///< the most that falling below the origin has set free, J
  ForceRange forces;        ///< where a device has one
  bool left_range = false;  ///< whether a force has left it since the last check

  double elapsed(double dt) const { return static_cast<double>(steps) * dt; }        ///< s
  double time(double dt) const { return origin + static_cast<double>(steps) * dt; }  ///< since birth, s
};

}  // namespace evodevo
