// The progress of a run that is made in several pieces.
#pragma once

#include <cstdint>

#include "physics/energy_bound.hpp"

namespace evodevo {

/// The range of forces where a device represents them as integers (GPU).
struct ForceRange {
  double resolution = 1;  ///< force of one unit, N; a power of two
  double largest = 0;     ///< largest force that a spring may have, N
};

/// How far a run has come, and what was computed at its beginning. Times, checks and bounds count from the beginning of
/// the whole run, so that a run made in pieces ends in the same bits as one made at once.
struct Course {
  double origin = 0;        ///< State::time at the beginning of the run, s
  std::uint64_t steps = 0;  ///< steps made since the beginning
  EnergyBound bound;
  double fallen = 0;        ///< most energy that falling below the origin has released so far, J
  ForceRange forces;        ///< on devices that limit forces
  bool left_range = false;  ///< whether a force has left that range since the last check

  double elapsed(double dt) const { return static_cast<double>(steps) * dt; }        ///< s
  double time(double dt) const { return origin + static_cast<double>(steps) * dt; }  ///< since birth, s
};

}  // namespace evodevo
