// The time-stepping methods: their names, and whether they are explicit. kernels/README.md compares them.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace evodevo {

/// The method that computes a time step.
///
/// The first four methods are explicit: they diverge if the step is longer than a limit that depends on the body
/// (analysis/stability.hpp). implicit is stable at any step; it damps oscillations that are faster than the step.
///
/// xpbd damps these oscillations as well. At steps longer than about three times the explicit methods' limit, bodies
/// sag under their weight; at steps longer than about seven times the limit, one Gauss-Seidel pass leaves such a large
/// residual that bodies with few springs gain energy. At any step, xpbd rotates bodies with active muscles by an angle
/// of order dt^2, because later springs in the pass use velocities that earlier springs have changed. Reversing the
/// order in every second step would reduce the angle to order dt^4, but then bodies would gain energy even at twice the
/// explicit methods' limit.
enum class Method {
  paper_euler,       ///< semi-implicit Euler, the new velocity multiplied by exp(-rate dt); order 1
  symplectic_euler,  ///< semi-implicit Euler with damping and drag that give the exact terminal velocity; order 1
  velocity_verlet,   ///< kick, drift, kick between half steps of damping and drag; order 2
  rk4,               ///< the classical Runge-Kutta method; order 4
  implicit,          ///< backward Euler, linearised, by conjugate gradients; order 1
  xpbd,              ///< springs as compliant constraints, one coloured Gauss-Seidel pass a step; order 1
};

/// The names that users know, in the order of the enumerators.
inline constexpr std::array<std::string_view, 6> method_names = {"paper-euler", "symplectic-euler", "velocity-verlet",
                                                                 "rk4",         "implicit",         "xpbd"};

constexpr std::string_view name(Method method) { return method_names[static_cast<std::size_t>(method)]; }

/// The method called `name`, which must be one of method_names; otherwise throws std::out_of_range.
constexpr Method method_of(std::string_view name) {
  std::size_t i = 0;
  while (method_names.at(i) != name) ++i;
  return static_cast<Method>(i);
}

constexpr bool is_explicit(Method method) { return method != Method::implicit && method != Method::xpbd; }

}  // namespace evodevo
