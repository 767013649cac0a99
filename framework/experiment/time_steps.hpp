// How long a body's time steps are.
#pragma once

#include <optional>
#include <string>

#include "core/method.hpp"
#include "core/scene.hpp"
#include "evodevo/body.hpp"

namespace evodevo {

/// What an experiment says of the time step.
struct StepRule {
  std::optional<double> dt = 0.0005;  ///< s; none: as long as each body bears (safe_dt())
  std::int64_t refine = 1;            ///< what every step is divided by
  bool run_unstable = false;          ///< whether a body that cannot bear `dt` runs all the same

  /// The dt of all bodies, s; none where each has its own.
  std::optional<double> fixed() const;

  bool operator==(const StepRule&) const = default;
};

/// Some steps, one after the other.
struct Pace {
  double dt = 0;  ///< s
  std::uint64_t steps = 0;
};

/// The longest step (s, before it is refined) of a body whose masses are at `positions`, or why it cannot be simulated.
struct LongestStep {
  double dt = 0;
  std::string failure;  ///< "unstable dt: ..."; empty where there is none
};
LongestStep longest_step(const StepRule& rule, const Body& body, std::span<const Vec3> positions, const Scene& scene,
                         Method method);

/// The steps that a duration (s) takes: with a fixed dt the nearest whole number, else the fewest equal ones that are
/// no longer than `longest`; either refined.
Pace pace_over(double duration, const StepRule& rule, double longest);

/// Whether a duration can be told from a whole number of steps.
bool is_whole_number_of_steps(double duration, double dt);

}  // namespace evodevo
