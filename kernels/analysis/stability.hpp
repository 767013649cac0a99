// The largest stable time step for a scene, a material or a body.
#pragma once

#include <limits>
#include <span>

#include "core/scene.hpp"
#include "core/simulator.hpp"
#include "evodevo/body.hpp"

namespace evodevo {

/// The largest product of dt and angular frequency (1) at which an undamped oscillation stays bounded: 2 for the
/// semi-implicit Euler methods and velocity-verlet, 2 sqrt(2) for rk4, infinite for implicit and xpbd. Uniform damping
/// raises the limit of the Euler methods and does not change that of velocity-verlet. In rk4 it is a force, so that in
/// addition rate dt must stay below 2.78. Dashpots lower the limits (kernels/README.md).
double oscillation_limit(Method method);

/// The largest dt (s) for contact of a mass of `mass` kg with an elastic floor: dt sqrt(stiffness / mass) <= 1.2. With
/// longer steps, masses can leave the floor much faster than they hit it (kernels/README.md). Infinite without a floor,
/// with a rigid floor, and for methods that are not explicit.
double largest_contact_dt(const Scene& scene, double mass, Method method);
/// The same for the lightest mass of a body.
double largest_contact_dt(const Scene& scene, const Body& body, Method method);

/// The largest dt (s) for one spring of `material` between two masses of `mass` kg. Without a dashpot, dt sqrt(2 k / m)
/// is at most oscillation_limit(). With one, the semi-implicit Euler methods need dt w <= 2 (sqrt(1 + z^2) - z), with w
/// = sqrt(2 k / m) and the damping ratio z.
double largest_spring_dt(const Material& material, double mass, Method method);

/// The largest dt (s) that samples the actuation of `material` correctly, with any method: half a period. Longer steps
/// alias it to a slower actuation. Infinite if the material is not actuated.
double largest_muscle_dt(const Material& material);
/// The same for all springs of a body; materials that no spring has do not count.
double largest_muscle_dt(const Body& body);

/// The largest stable dt (s) of small oscillations of `body` about unstrained springs, with its masses at `positions`
/// (m): without dashpots, dt times the highest angular frequency of the body is at most oscillation_limit(). With
/// dashpots the result is up to 5 % below the true limit; it does not consider uniform damping. Infinite if the body
/// has no springs or the method is not explicit. NaN if a position is not finite.
///
/// The Lanczos iteration finds the frequency. The result is at most 2 % below the true limit; only for bodies whose
/// highest frequencies are close together, such as long chains, is it above the limit, by at most half a percent.
double largest_dt(const Body& body, std::span<const Vec3> positions, Method method);

/// The largest dt (s) at which `body` is stable with an explicit method in whatever shape, whatever the tension of its
/// springs, while all of its masses touch the scene's elastic floor. A spring of stiffness k and length L whose ends
/// are |d| apart resists by k along its direction and by k (1 - L/|d|), which is less than k, across it. This function
/// assumes k in all directions, so that without dashpots the result is at most sqrt(3) times smaller than necessary in
/// any one shape. Returns `wanted` (s) if the body is stable at that step, which is cheaper to determine by an upper
/// bound, and also if it has no springs or the method is not explicit. NaN if springs are too stiff for the
/// computation. Otherwise the accuracy is that of largest_dt().
double largest_dt_in_any_shape(const Body& body, const Scene& scene, Method method,
                               double wanted = std::numeric_limits<double>::infinity());

/// The safety factor for steps chosen by largest_dt_in_any_shape().
inline constexpr double spring_margin = 0.98;
/// The same for the Euler methods and velocity-verlet, if a spring has a damping ratio below least_damping. Near the
/// largest stable step, these methods conserve the energy of an oscillation only while no spring turns and nothing
/// touches the floor. What nothing damps then gains energy in the long run (kernels/README.md). rk4 damps fast
/// oscillations itself.
inline constexpr double undamped_margin = 2.0 / 3;
inline constexpr double least_damping = 0.05;

/// A safe dt (s) for a body with an explicit method in a scene, whatever shape the body takes: the minimum of
/// largest_dt_in_any_shape() times its safety factor, largest_contact_dt() (which includes a margin), a twentieth of
/// the fastest muscle's period, 0.01 s and, if uniform damping is a force (rk4), 2/rate; if there are dashpots as well,
/// both rates count together. NaN if springs are too stiff for the computation.
double safe_dt(const Body& body, const Scene& scene, Method method);

/// Whether `dt` is at most largest_dt_in_any_shape() and, if uniform damping is a force (rk4), the body is stable with
/// it, too: without dashpots, for rate dt up to 2.58; with dashpots, both dampings count together.
bool is_stable(const Body& body, const Scene& scene, Method method, double dt);

}  // namespace evodevo
