#include <cmath>

#include "analysis/stability.hpp"
#include "base/text.hpp"
#include "experiment/accuracy.hpp"
#include "experiment/tables/declarations.hpp"
#include "experiment/tables/tables.hpp"

namespace evodevo {
namespace {

/// Throws KeyError if dt is too long for contact with the floor, for a single spring, or to sample the actuation of a
/// muscle.
void check_step(const TomlReader& t, const Settings& settings) {
  const double mass = settings.mass, dt = *settings.step.fixed();
  const Method method = settings.stepping.method;
  const auto refuse = [&](const std::string& what, double largest) {
    t.fail(
        "dt",
        "the time step " + to_text(dt) + " s is too long for " + what + "; expected at most " + to_text(largest) + " s",
        {"simulation", "scene", "materials", "encoding"});
  };
  const std::string on_masses = " N/m on masses of " + to_text(mass) + " kg";
  const double contact = largest_contact_dt(settings.scene, mass, method);
  if (dt > contact) refuse("scene.floor.stiffness = " + to_text(settings.scene.floor->stiffness) + on_masses, contact);
  for (const auto& [name, material] : settings.materials) {
    const std::string key = "materials." + name;
    const double spring = largest_spring_dt(material, mass, method), muscle = largest_muscle_dt(material);
    const std::string damped = material.damping > 0 ? " with damping = " + to_text(material.damping) : "";
    if (dt > spring) refuse(key + ".stiffness = " + to_text(material.stiffness) + on_masses + damped, spring);
    if (dt > muscle) refuse(key + ".frequency = " + to_text(material.frequency) + " Hz", muscle);
  }
}

/// Throws KeyError if settings of the simulation do not go together.
void check_combination(const TomlReader& t, const Settings& settings, Bodies bodies) {
  const Stepping& stepping = settings.stepping;
  if (stepping.materials == Materials::computed &&
      (stepping.precision != Precision::float32 || !is_explicit(stepping.method)))
    t.fail("materials",
           "only explicit methods in single precision can compute materials; set \"table\", or choose another method, "
           "precision or accuracy",
           {"simulation"});
  const StepRule& step = settings.step;
  if (step.dt && bodies == Bodies::grown && !step.run_unstable) check_step(t, settings);
  if (!step.dt && !is_explicit(stepping.method))
    t.fail("dt",
           "\"" + std::string(name(stepping.method)) +
               "\" is stable at any time step, so stability gives no time step; set dt to a number of seconds",
           {"simulation"});
}

}  // namespace

void read_simulation(TomlReader& top, Settings& settings, Bodies bodies) {
  const toml::table* given = nullptr;
  top.attempt([&] { given = top.table("simulation"); });
  const toml::table defaults = top.empty_table();
  TomlReader t(given != nullptr ? *given : defaults, "simulation", {}, top.errors());
  declare_accuracy(t, settings);
  const Steps steps = steps_of(settings.accuracy);
  settings.stepping = steps.stepping;
  settings.step = steps.step;
  declare_simulation(t, settings);
  t.finish();
  t.attempt([&] { check_combination(t, settings, bodies); });
}

void check_duration(const TomlReader& t, std::string_view name, double duration, const StepRule& step) {
  if (!step.dt || is_whole_number_of_steps(duration, *step.dt)) return;
  const double dt = *step.dt, steps = std::max(1.0, std::round(duration / dt));
  const double nearest = std::round(steps * dt * 1e12) / 1e12;  // without the digits of rounding errors
  t.report(name,
           to_text(duration) + " s is not a whole number of steps of " + to_text(dt) + " s; the nearest one is " +
               to_text(nearest) + " s; or choose another simulation.dt, such as \"auto\"",
           {"simulation"});
}

}  // namespace evodevo
