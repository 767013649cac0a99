// The largest time step that a scene, a material or a body bears.
#pragma once

#include <limits>
#include <span>

#include "core/scene.hpp"
#include "core/simulator.hpp"
#include "evodevo/body.hpp"

namespace evodevo {

/// The largest dt times angular frequency at which an undamped oscillation stays bounded: 2 for the semi-implicit Euler
/// methods and velocity-verlet, 2 sqrt(2) for rk4, infinite for the others. Damping raises the limit of the Euler
/// methods and leaves that of velocity-verlet; rk4 takes it for a force, so that rate dt must stay below 2.78.
double oscillation_limit(Method method);

/// The largest dt (s) at which the floor does not throw a mass of `mass` kg back faster than it came:
/// dt sqrt(stiffness / mass) <= 1.2; infinite without a floor and for methods that are not explicit.
double largest_contact_dt(const Scene& scene, double mass, Method method);
/// The same for the lightest of a body's masses.
double largest_contact_dt(const Scene& scene, const Body& body, Method method);

/// The largest dt (s) for one spring of `material` between two masses of `mass` kg: dt sqrt(2 k / m) within the limit.
double largest_spring_dt(const Material& material, double mass, Method method);

/// The largest dt (s) at which the muscles of `material` are seen at all, whatever the method: half a period of their
/// actuation. Beyond it they move as muscles of another, slower actuation would; infinite where nothing is actuated.
double largest_muscle_dt(const Material& material);
/// The same for all springs of a body; what else is among its materials does not count.
double largest_muscle_dt(const Body& body);

/// The largest dt (s) at which `body`, its masses at `positions`, is stable, or `wanted` (s) where it bears that: dt
/// times the highest angular frequency of the undamped body within the limit; infinite where nothing swings or the
/// method is not explicit. A bound of the frequency decides where it can: for random robots 1.35 times the true one on
/// average and 1.40 at most. Else Lanczos' iteration finds it: at most 2 % below the true limit, and above it only for
/// bodies whose highest frequencies lie close together, such as long chains, by half a percent at most.
double largest_dt(const Body& body, std::span<const Vec3> positions, Method method,
                  double wanted = std::numeric_limits<double>::infinity());

/// What a step chosen by largest_dt() leaves to what it does not know: positions and the directions of springs change
/// before anybody looks again, and springs under tension resist turning as well.
inline constexpr double spring_margin = 0.9;

/// The largest dt (s) for a body of an explicit method in a scene, at most 0.01 s: spring_margin of largest_dt(); the
/// contact limit, which holds a margin of its own; a twentieth of the fastest muscle's period, so that it is seen; and
/// 2/rate where damping is a force (rk4). NaN where a position is not finite.
double safe_dt(const Body& body, std::span<const Vec3> positions, const Scene& scene, Method method);

/// Whether `dt` is at most largest_dt().
bool is_stable(const Body& body, std::span<const Vec3> positions, Method method, double dt);

}  // namespace evodevo
