// The progress of a run that is simulated in several pieces.
#pragma once

#include <cstdint>
#include <vector>

#include "evodevo/body.hpp"
#include "physics/energy_bound.hpp"

namespace evodevo {

/// The range of forces on devices that represent forces as integers (GPU).
struct ForceRange {
  double resolution = 1;  ///< force of one unit, N; a power of two
  double largest = 0;     ///< largest force that a spring may have, N
};

/// The progress of a run, and values that were computed at its beginning. Times, checks and bounds refer to the
/// beginning of the whole run, so that a run in pieces gives results that are bit-identical to those of an undivided
/// run.
struct Course {
  double origin = 0;        ///< State::time at the beginning of the run, s
  std::uint64_t steps = 0;  ///< number of steps since the beginning of the run
  EnergyBound bound;
  double fallen = 0;        ///< largest energy lost by falling below the origin so far, J
  ForceRange forces;        ///< range of forces, on devices that limit forces
  bool left_range = false;  ///< whether a force has left that range since the last check
  /// [masses] the velocities at which dashpots act next (m/s), with velocity-verlet, which has predicted them; empty if
  /// these are the velocities of the masses
  std::vector<Vec3> dashpot_velocity;

  double elapsed(double dt) const { return static_cast<double>(steps) * dt; }        ///< time since the beginning, s
  double time(double dt) const { return origin + static_cast<double>(steps) * dt; }  ///< time since birth, s
};

}  // namespace evodevo
