// The range of a body's forces, on which their unit as integers depends (fixed_point.hpp).
#pragma once

#include "core/course.hpp"
#include "core/scene.hpp"
#include "evodevo/body.hpp"

namespace evodevo::cuda {

/// The range of forces for a body. The largest force is the maximum of: the force of its strongest spring at twice its
/// rest length, or at three times its rest length if muscles drive the body (in resonance, springs stretch by more than
/// their rest length); twice the largest current force of a spring; the force that stops the masses' motion; and the
/// body's weight. The last three can be the maximum if springs are soft or short. Dashpots add to each the share 2
/// zeta, with the largest damping ratio zeta: that is the largest force of a dashpot relative to that of its spring
/// while both swing freely. If that is more, they add the force with which a dashpot stops a fall by the body's own
/// size in a landing. The body's weight is that of all masses, if they are at most 1,000. Otherwise it is the largest
/// weight of a piece whose masses are joined to each other, but at most 1,000 times that of its heaviest mass unless
/// the piece hangs from a mass of 0 kg. A larger range would make the unit of forces too coarse.
template <class T>
ForceRange force_range(const Body& body, const State& state, const Scene& scene);

}  // namespace evodevo::cuda
