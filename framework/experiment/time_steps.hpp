// The length and number of the time steps of a body.
#pragma once

#include <optional>
#include <string>

#include "core/method.hpp"
#include "core/scene.hpp"
#include "evodevo/body.hpp"

namespace evodevo {

inline constexpr double shortest_cycle = 0.001;  ///< the shortest cycle of development, s

/// The settings of an experiment for the time step.
struct StepRule {
  std::optional<double> dt = 0.0005;  ///< time step, s; none: safe_dt() of each body
  std::int64_t refine = 1;            ///< number by which every time step is divided
  bool run_unstable = false;          ///< whether to simulate bodies for which `dt` is too long
  double unit =
      1;  ///< s; a whole number of the steps that a body has of its own: a cycle of development, if there is one

  /// The time step of all bodies after the division by `refine`, s; none if each body has its own.
  std::optional<double> fixed() const;

  bool operator==(const StepRule&) const = default;
};

/// A number of time steps of equal length.
struct Pace {
  double dt = 0;  ///< time step, s
  std::uint64_t steps = 0;
  std::int64_t refine = 1;  ///< StepRule::refine

  /// The number of steps to a time (s) since the beginning, rounded to a step before the division by `refine`, so that
  /// finer steps end at the same times.
  std::uint64_t steps_to(double time) const;
};

/// The time step of a body, or the reason why the body cannot be simulated.
struct LongestStep {
  double dt = 0;        ///< s, before the division by StepRule::refine
  std::string failure;  ///< "unstable dt: ..."; empty if the body can be simulated
};
/// Returns the time step for a body, at which it is stable in any shape: `rule.dt` if it is fixed, otherwise safe_dt().
LongestStep longest_step(const StepRule& rule, const Body& body, const Scene& scene, Method method);

/// Returns the time steps of a body for a duration (s). Their length does not depend on the duration, so that a life
/// moves alike however it is divided: with a fixed dt, it is that; otherwise `rule.unit` is the smallest whole number
/// of equal steps no longer than `longest` (s). The duration is rounded to such a step. Each of them is then divided by
/// `rule.refine`.
Pace pace_of(double duration, const StepRule& rule, double longest);

/// Whether a duration (s) is a whole number of steps of `dt` (s), apart from rounding.
bool is_whole_number_of_steps(double duration, double dt);

}  // namespace evodevo
