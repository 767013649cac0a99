// The largest time step that a scene, a material or a body bears.
#pragma once

#include <span>

#include "evodevo/body.hpp"
#include "scene.hpp"
#include "simulator.hpp"

namespace evodevo {

/// The largest dt times angular frequency at which an undamped oscillation stays bounded: 2 for the semi-implicit Euler
/// methods and velocity-verlet, 2 sqrt(2) for rk4, infinite for the others. Damping raises the limit of the Euler
/// methods and leaves that of velocity-verlet; rk4 takes it for a force, so that rate dt must stay below 2.78.
double oscillation_limit(Method method);

/// The largest dt (s) at which the floor does not throw a mass of `mass` kg back faster than it came:
/// dt sqrt(stiffness / mass) <= 1.2; infinite without a floor and for methods that are not explicit.
double largest_contact_dt(const Scene& scene, double mass, Method method);

/// The largest dt (s) for one spring of `material` between two masses of `mass` kg: dt sqrt(2 k / m) within the limit.
double largest_spring_dt(const Material& material, double mass, Method method);

/// The largest dt (s) at which `body`, its masses at `places`, is stable: dt times the highest angular frequency of the
/// undamped body within the limit. By power iteration, at most 2 % below the true limit, and above it only for bodies
/// whose highest frequencies lie close together, such as long chains, by half a percent at most; infinite where nothing
/// swings or the method is not explicit.
double largest_dt(const Body& body, std::span<const Vec3> places, Method method);

/// Whether the step is at most largest_dt(). Gershgorin's bound decides where it can, power iteration where it cannot.
bool is_stable(const Body& body, std::span<const Vec3> places, const Stepping& stepping);

}  // namespace evodevo
