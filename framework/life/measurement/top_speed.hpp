// What a scene allows: the speed that friction on the floor can keep up against damping.
#pragma once

#include "core/scene.hpp"

namespace evodevo {

/// Whether robots can push themselves along by nothing but friction on a level floor. It is false without gravity, a
/// floor or friction, in a fluid (drag also pushes), and on rough ground (hills also push).
bool moves_by_friction(const Scene& scene);

/// Returns the highest speed (m/s) that a robot can keep up along a horizontal direction if moves_by_friction(). The
/// cosine of the angle between the direction and the way downhill (+x) is `downhill`: 1 downhill, -1 uphill. The speed
/// is infinite without damping, because then only the muscles limit it. It is negative if every robot slides down.
///
/// This is the balance of forces on the centre of mass. The forces of springs, with their dashpots, cancel in the sum
/// over a body, so that m dv/dt = friction + m g sin(theta) downhill - m rate v. As long as the body neither rises nor
/// sinks, the floor carries its weight m g cos(theta) on average, and friction is at most mu times that. A speed that
/// lasts is therefore at most (mu g cos(theta) + g sin(theta) downhill)/rate, whatever the body and its gait. Over a
/// short time a robot can be faster, for example while it topples. With long time steps, simulated robots can be faster
/// by a share of about rate dt/2.
double top_speed(const Scene& scene, double downhill);

}  // namespace evodevo
