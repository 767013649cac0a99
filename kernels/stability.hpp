// The largest time step that a scene, a material or a body bears.
#pragma once

#include <span>

#include "evodevo/body.hpp"
#include "scene.hpp"
#include "simulator.hpp"

namespace evodevo {

/// The largest dt (s) at which the floor does not throw a mass of `mass` kg back faster than it came:
/// dt sqrt(stiffness / mass) <= 1.2; infinite without a floor.
double largest_contact_dt(const Scene& scene, double mass);

/// The largest dt (s) for one spring of `material` between two masses of `mass` kg: dt sqrt(2 k / m) <= 2.
double largest_spring_dt(const Material& material, double mass);

/// Whether the springs of `body`, its masses at `places`, are stable at the step: dt times the highest angular
/// frequency of the undamped body at most 2. Gershgorin's bound decides where it can, power iteration where it cannot.
bool is_stable(const Body& body, std::span<const Vec3> places, const Stepping& stepping);

}  // namespace evodevo
