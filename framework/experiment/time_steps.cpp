#include "experiment/time_steps.hpp"

#include <cmath>

#include "analysis/stability.hpp"
#include "base/text.hpp"

namespace evodevo {
namespace {

constexpr double shortest_dt = 1e-7;  ///< s; with shorter time steps, the simulation of a life would take too long

LongestStep failed(const std::string& why) { return {0, "unstable dt: " + why}; }

LongestStep longest_fixed_step(const StepRule& rule, const Body& body, const Scene& scene, Method method) {
  const double dt = *rule.fixed();
  if (rule.run_unstable) return {*rule.dt, ""};
  if (dt > largest_contact_dt(scene, body, method))
    return failed(to_text(dt) + " s is too long for the body's lightest mass on this floor");
  if (dt > largest_muscle_dt(body)) return failed(to_text(dt) + " s is too long for the body's fastest muscles");
  if (!is_stable(body, scene, method, dt))
    return failed(to_text(dt) + " s is too long for the body's springs" +
                  (method == Method::rk4 && scene.damping ? " and the scene's damping" : ""));
  return {*rule.dt, ""};
}

}  // namespace

std::optional<double> StepRule::fixed() const {
  if (!dt) return std::nullopt;
  return *dt / static_cast<double>(refine);
}

LongestStep longest_step(const StepRule& rule, const Body& body, const Scene& scene, Method method) {
  if (rule.dt) return longest_fixed_step(rule, body, scene, method);
  const double dt = safe_dt(body, scene, method);
  if (!(dt > 0)) return failed("the body is too stiff or too light for a time step to be computed");
  if (dt < shortest_dt)
    return failed("the body would need steps of " + to_text(dt) + " s, less than " + to_text(shortest_dt) + " s");
  return {dt, ""};
}

std::uint64_t Pace::steps_to(double time) const {
  const auto undivided = static_cast<std::uint64_t>(std::llround(time / (dt * static_cast<double>(refine))));
  return undivided * static_cast<std::uint64_t>(refine);
}

Pace pace_of(double duration, const StepRule& rule, double longest) {
  const auto refine = static_cast<double>(rule.refine);
  Pace pace{rule.dt ? *rule.fixed() : rule.unit / (std::ceil(rule.unit / longest) * refine), 0, rule.refine};
  pace.steps = pace.steps_to(duration);
  return pace;
}

bool is_whole_number_of_steps(double duration, double dt) {
  const double steps = duration / dt;
  return std::abs(steps - std::round(steps)) <= 1e-6 * std::max(1.0, steps);
}

}  // namespace evodevo
