// The largest stable time step, in theory and as measured.
#pragma once

#include "core/method.hpp"
#include "evodevo/body.hpp"

namespace evodevo::tools::accuracy {

/// Whether a method keeps the motion of a spring bounded, according to the characteristic polynomial of one step. The
/// spring oscillates with the angular frequency `phase` / dt and is damped at the rate `damping_step` / dt.
bool is_bounded(Method method, double phase, double damping_step);

/// The interval of angular frequency times dt in which the motion stays bounded. Its lower end is not always 0: with
/// strong damping, rk4 is unstable for slow springs too.
struct Band {
  double low = 0, high = 0;
};
Band bounded_phases(Method method, double damping_step);

/// The largest stable dt (s) for a spring with the angular frequency `frequency` (1/s) that is damped at `rate` (1/s);
/// infinity if every dt is stable.
double predicted_limit(Method method, double frequency, double rate);

/// A spring between two equal masses.
struct Oscillator {
  double stiffness, mass, rate;  ///< stiffness [N/m], each mass [kg], damping rate [1/s]
  double frequency() const;      ///< angular frequency without damping [1/s]
};

/// Simulates a slightly stretched spring in double precision for 1500 steps; returns whether it has not diverged.
bool stays_bounded(const Oscillator& oscillator, Method method, double dt);

/// The largest dt at which stays_bounded() is true, s; infinity if it is still true at 100 / frequency.
double measured_limit(const Oscillator& oscillator, Method method);

/// The largest dt at which a body does not diverge if its masses start up to 1e-5 m from their rest positions, s. The
/// search covers the range from `low` to `high` (s).
double measured_limit(const Body& body, Method method, double low, double high);

/// The ratio of a mass's energy after a bounce on an elastic floor to its energy before the bounce; the largest ratio
/// for impacts at 64 different instants within a time step. The time step follows from dt sqrt(floor stiffness / mass)
/// = `contact_phase`.
double contact_gain(Method method, double contact_phase);
/// The same for a rigid floor with a restitution, with steps of `dt` s. Infinity if a mass does not meet the floor.
double rigid_contact_gain(Method method, double restitution, double dt);

}  // namespace evodevo::tools::accuracy
