// How much energy a body can have, as the host and the GPU work it out: guard.hpp says why.
#pragma once

#include "physics/arithmetic.hpp"

namespace evodevo {

/// What bounds the energy of a body during a run, settled where the run begins.
struct EnergyBound {
  double start = 0;      ///< height + kinetic + elastic energy at the beginning, at most, J
  double drive = 0;      ///< how fast muscles can raise the square root of the energy, J^(1/2)/s
  double allowance = 0;  ///< for what steps, rounding and masses that sag into the floor bring, J

  /// What muscles can have added to height + kinetic + elastic energy `time` s after the beginning, J. `fallen`: the
  /// most that falling below the origin has set free until then, J.
  EVODEVO_HD double added(double time, double fallen) const {
    const double root = drive * time, before = physics::maximum(start, 0.0) + fallen;
    return root * (root + 2 * physics::square_root(before));
  }

  /// What kinetic + elastic energy must not pass then, J: ten times what there can be, for what the steps do.
  EVODEVO_HD double limit(double time, double fallen) const {
    return 10 * (physics::maximum(start, 0.0) + added(time, fallen) + fallen + allowance);
  }
};

}  // namespace evodevo
