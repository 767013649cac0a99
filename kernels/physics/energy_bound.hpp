// The largest energy that a body can have at a given time, computed by the same code on the host and on the GPU. The
// derivation is in analysis/guard.hpp.
#pragma once

#include "physics/arithmetic.hpp"

namespace evodevo {

/// The numbers from which the bound on a body's energy during a run is computed. They are set once, at the beginning of
/// the run.
struct EnergyBound {
  double start = 0;      ///< upper bound of gravitational + kinetic + elastic energy at the beginning, J
  double drive = 0;      ///< largest rate at which muscles can raise the square root of the energy, J^(1/2)/s
  double allowance = 0;  ///< allowance for muscle strain, rounding, and masses that sink into the floor, J

  /// The largest energy (J) that muscles can have added to the gravitational + kinetic + elastic energy by `time`
  /// seconds after the beginning. `fallen` is the largest gravitational energy (J) lost so far by falling below the
  /// origin.
  EVODEVO_HD double added(double time, double fallen) const {
    const double root = drive * time, before = physics::maximum(start, 0.0) + fallen;
    return root * (root + 2 * physics::square_root(before));
  }

  /// The limit (J) of kinetic + elastic energy at that time: ten times the energy that exact motion can have, because
  /// with finite steps the computed energy oscillates around that of the exact motion.
  EVODEVO_HD double limit(double time, double fallen) const {
    return 10 * (physics::maximum(start, 0.0) + added(time, fallen) + fallen + allowance);
  }
};

}  // namespace evodevo
