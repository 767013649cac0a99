// The time-stepping methods.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace evodevo {

/// How a body is moved by one time step. All but the last two are explicit: beyond a step that depends on the body they
/// diverge. implicit bears any step and damps what swings faster than it. So does xpbd, but beyond some three times the
/// largest step of the explicit methods it lets bodies sag under their weight, and beyond some seven times one pass
/// leaves so much unsolved that sparse bodies gain energy. At any step it turns bodies whose muscles pull, by about
/// dt^2: springs that come later in the pass see what the earlier have changed. Passing backwards in every second step
/// would leave dt^4 of that, but bodies would gain energy from twice the explicit methods' largest step on.
enum class Method {
  paper_euler,       ///< semi-implicit Euler, the new velocity multiplied by exp(-rate dt); order 1
  symplectic_euler,  ///< semi-implicit Euler with damping and drag that end in the true terminal velocity; order 1
  velocity_verlet,   ///< kick, drift, kick between half steps of damping and drag; order 2
  rk4,               ///< the classical Runge-Kutta method; order 4
  implicit,          ///< backward Euler, linearised, by conjugate gradients; order 1
  xpbd,              ///< springs as compliant constraints, one coloured Gauss-Seidel pass a step; order 1
};

/// As `[simulation] method` calls them, in the enumerators' order.
inline constexpr std::array<std::string_view, 6> method_names = {"paper-euler", "symplectic-euler", "velocity-verlet",
                                                                 "rk4",         "implicit",         "xpbd"};

constexpr std::string_view name(Method method) { return method_names[static_cast<std::size_t>(method)]; }

/// The method called `name`, one of method_names.
constexpr Method method_of(std::string_view name) {
  std::size_t i = 0;
  while (method_names.at(i) != name) ++i;
  return static_cast<Method>(i);
}

constexpr bool is_explicit(Method method) { return method != Method::implicit && method != Method::xpbd; }

}  // namespace evodevo
