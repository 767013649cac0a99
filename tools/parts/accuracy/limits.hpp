// How far a step may go, in theory and as measured.
#pragma once

#include "core/method.hpp"
#include "evodevo/body.hpp"

namespace evodevo::tools::accuracy {

/// Whether an explicit method keeps a spring bounded that swings with omega = `phase` / dt and is damped with a rate of
/// `damping_step` / dt: from the characteristic polynomial of one step.
bool is_bounded(Method method, double phase, double damping_step);

/// Between which omega dt that is so; with much damping, rk4 does not bear slow springs either.
struct Band {
  double low = 0, high = 0;
};
Band bounded_phases(Method method, double damping_step);

/// The largest dt (s) for a spring that swings with `frequency` (1/s) and is damped with `rate` (1/s); infinite where
/// damping keeps up with any.
double predicted_limit(Method method, double frequency, double rate);

/// A spring between two masses.
struct Oscillator {
  double stiffness, mass, rate;  ///< N/m, kg, 1/s
  double frequency() const;      ///< undamped, 1/s
};

/// Whether a spring that swings a little still does so after many steps, in double.
bool stays_bounded(const Oscillator& oscillator, Method method, double dt);

/// Where that ends, s; infinite if not below a hundred times 1/frequency.
double measured_limit(const Oscillator& oscillator, Method method);

/// The same for a body that trembles at its rest positions, between `low` and `high` s.
double measured_limit(const Body& body, Method method, double low, double high);

/// The largest ratio of the energies after and before a mass hits the floor, of all phases of the step at the impact:
/// dt sqrt(floor stiffness / mass) = `contact_phase`.
double contact_gain(Method method, double contact_phase);

}  // namespace evodevo::tools::accuracy
