// The physics: every force, the parts of a time step and the energies, as small functions of an arithmetic type T.
//
// kernels/README.md states the equations, and where they differ from the paper. A time step uses these functions as
// follows:
//
//   positions, velocities ─► separation, length ─► spring_factor ─► force on both ends        (once per spring)
//   position, velocity ─► weight, floor_force, drag_factor, damping_factor ─► force on the mass (once per mass)
//   force, velocity ─► advanced_velocity, drag_retention, friction_factor ─► new velocity      (once per mass)
//   new velocity, position ─► advanced_position ─► new position                                (once per mass)
//
// Scalar code (CUDA threads, tests) includes this file once and finds the functions in evodevo::physics; T is float or
// double. The CPU's vector code is compiled once per instruction set: it includes this file each time, and finds the
// functions in that instruction set's namespace; T is a SIMD vector.
#if defined(EVODEVO_PHYSICS_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef EVODEVO_PHYSICS_HPP
#undef EVODEVO_PHYSICS_HPP
#else
#define EVODEVO_PHYSICS_HPP
#endif

#include <cstdint>

#ifdef HWY_TARGET_INCLUDE
#include "physics/vectors-inl.hpp"
HWY_BEFORE_NAMESPACE();
namespace evodevo::HWY_NAMESPACE {
#else
#include "physics/arithmetic.hpp"
namespace evodevo::physics {
#endif

template <class T>
struct Triple {
  T x, y, z;
};

/// The position of a spring's end b relative to its end a.
template <class T>
struct Separation {
  Triple<T> d;  ///< from a to b, m
  T squared;    ///< |d|^2 + vanishing_square(), m^2
};

template <class T>
EVODEVO_HD Separation<T> separation(const Triple<T>& a, const Triple<T>& b) {
  const Triple<T> d{b.x - a.x, b.y - a.y, b.z - a.z};
  // vanishing_square is added first, so that it changes no ordinary distance, even in the last bit; it keeps d/|d|
  // finite where two masses coincide
  return {d, multiply_add(d.z, d.z, multiply_add(d.y, d.y, multiply_add(d.x, d.x, vanishing_square<T>())))};
}

/// |d|, m; greater than zero even if the masses coincide.
template <class T>
EVODEVO_HD T length(const Separation<T>& s) {
  return square_root(s.squared);
}

/// The factor k (|d| - L)/|d| (N/m) of a spring of stiffness k (N/m) and actuated rest length L (m). The force on the
/// spring's end a is this factor times d (paper, section IV-C); where |d| = 0 the force is zero, never NaN.
template <class T>
EVODEVO_HD T spring_factor(T distance, T stiffness, T spring_length) {
  return stiffness - stiffness * spring_length / distance;
}

/// 1/|d|, 1/m; always finite.
template <class T>
EVODEVO_HD T inverse_length(const Separation<T>& s) {
  return inverse_square_root(s.squared);
}

/// |d| (m) from 1/|d|. It is exactly zero where the masses coincide, and so is the tension.
template <class T>
EVODEVO_HD T length_by_inverse(const Separation<T>& s, T inverse_distance) {
  return (s.squared - vanishing_square<T>()) * inverse_distance;
}

/// The same factor as spring_factor(), without a division: from 1/|d| and `rest_force` = k L (N).
template <class T>
EVODEVO_HD T spring_factor_by_inverse(T inverse_distance, T stiffness, T rest_force) {
  return negative_multiply_add(rest_force, inverse_distance, stiffness);
}

/// A spring's tension k (|d| - L), N: positive where the spring pulls its ends together, negative where it pushes them
/// apart, zero where |d| = 0. `factor` is spring_factor().
template <class T>
EVODEVO_HD T spring_tension(const Separation<T>& s, T distance, T factor) {
  return zero_unless_greater(s.squared, vanishing_square<T>(), factor * distance);
}

/// The power (W) that a muscle puts into the body while its rest length L changes at `rate` (m/s). If the muscle takes
/// energy from the body, the power counts as 0.
template <class T>
EVODEVO_HD T actuation_power(T tension, T rate) {
  return maximum(negative_multiply_add(tension, rate, constant<T>(0)), constant<T>(0));
}

/// The factor c (d.v)/|d|^2 (N/m) of a dashpot with the coefficient c (N s/m) whose end b moves with `velocity` (m/s)
/// relative to its end a. The force on the end a is this factor times d: along the spring, positive if it gets longer.
template <class T>
EVODEVO_HD T dashpot_factor(const Separation<T>& s, T coefficient, const Triple<T>& velocity) {
  const T along = multiply_add(s.d.z, velocity.z, multiply_add(s.d.y, velocity.y, s.d.x * velocity.x));
  return coefficient * along / s.squared;
}

/// The same factor, without a division: from 1/|d|.
template <class T>
EVODEVO_HD T dashpot_factor_by_inverse(const Separation<T>& s, T inverse_distance, T coefficient,
                                       const Triple<T>& velocity) {
  const T along = multiply_add(s.d.z, velocity.z, multiply_add(s.d.y, velocity.y, s.d.x * velocity.x));
  return coefficient * along * (inverse_distance * inverse_distance);
}

/// A spring's stiffness matrix transverse I + along along^T, N/m.
template <class T>
struct SpringStiffness {
  T transverse;     ///< N/m
  Triple<T> along;  ///< (N/m)^1/2
};

/// The derivative of a spring's force with respect to the relative position of its ends (N/m):
/// k (n n^T + max(0, 1 - L/|d|)(I - n n^T)) with n = d/|d|. The transverse stiffness of a compressed spring is
/// negative; it is replaced by zero, so that the matrix is positive semidefinite (Choi and Ko, Stable but responsive
/// cloth, 2002). `factor` is spring_factor(). Where |d| = 0 the matrix is zero.
template <class T>
EVODEVO_HD SpringStiffness<T> spring_stiffness(const Separation<T>& s, T distance, T stiffness, T factor) {
  const T transverse = maximum(factor, constant<T>(0));
  const T scale = square_root(stiffness - transverse) / distance;
  return {transverse, {scale * s.d.x, scale * s.d.y, scale * s.d.z}};
}

/// The matrix `k` times the vector `v`.
template <class T>
EVODEVO_HD Triple<T> times(const SpringStiffness<T>& k, const Triple<T>& v) {
  const T pull = multiply_add(k.along.z, v.z, multiply_add(k.along.y, v.y, k.along.x * v.x));
  return {multiply_add(k.along.x, pull, k.transverse * v.x), multiply_add(k.along.y, pull, k.transverse * v.y),
          multiply_add(k.along.z, pull, k.transverse * v.z)};
}

/// The rate of change (N/s) of a spring's force on its end a while its end b moves with `velocity` (m/s) relative to a:
/// (factor (I - n n^T) + k n n^T) velocity. The transverse part may be negative (compressed springs), but not below -k,
/// its value for a spring at half its length L; where |d| = 0 there is no transverse part.
template <class T>
EVODEVO_HD Triple<T> spring_force_rate(const Separation<T>& s, T stiffness, T factor, const Triple<T>& velocity) {
  const T sideways = maximum(factor, constant<T>(0) - stiffness);
  const T transverse = zero_unless_greater(s.squared, vanishing_square<T>(), sideways);
  const T along = multiply_add(s.d.z, velocity.z, multiply_add(s.d.y, velocity.y, s.d.x * velocity.x)) / s.squared;
  const T pull = (stiffness - transverse) * along;
  return {multiply_add(pull, s.d.x, transverse * velocity.x), multiply_add(pull, s.d.y, transverse * velocity.y),
          multiply_add(pull, s.d.z, transverse * velocity.z)};
}

/// The force (N) that a constraint of stiffness k exerts at the end of a step: k violation/(1 + k dt damped_dt w).
/// `violation` (m) is how far the length would be from the rest length at the end of the step if the constraint did not
/// act, w (`inverse_mass`, 1/kg) is the sum of the inverse masses that the constraint moves, and `dt_squared` is dt
/// damped_dt (s^2; damped_dt as in drag_retention()). This is lambda/dt^2 of a constraint of compliance 1/k (Macklin et
/// al., XPBD, 2016, equation 18).
template <class T>
EVODEVO_HD T compliant_force(T stiffness, T violation, T dt_squared, T inverse_mass) {
  return stiffness * violation / multiply_add(stiffness * dt_squared, inverse_mass, constant<T>(1));
}

/// The same for a constraint beside a dashpot of the coefficient c (N s/m): (k violation + c rate)/(1 + (k dt + c)
/// damped_dt w), with the `rate` (m/s) at which the length would change at the end of the step if the constraint did
/// not act. This is Macklin's damped constraint (XPBD, 2016, equation 26) for the velocity at the end of the step.
template <class T>
EVODEVO_HD T damped_force(T stiffness, T coefficient, T violation, T rate, T dt, T damped_dt, T inverse_mass) {
  const T resistance = multiply_add(stiffness, dt, coefficient) * damped_dt;
  return multiply_add(coefficient, rate, stiffness * violation) /
         multiply_add(resistance, inverse_mass, constant<T>(1));
}

/// A spring's elastic energy k (|d| - L)^2 / 2, J.
template <class T>
EVODEVO_HD T elastic_energy(const Separation<T>& s, T stiffness, T spring_length) {
  const T stretch = length(s) - spring_length;
  return constant<T>(0.5) * stiffness * stretch * stretch;
}

/// A mass's kinetic energy, J.
template <class T>
EVODEVO_HD T kinetic_energy(T mass, const Triple<T>& velocity) {
  const T squared = multiply_add(velocity.z, velocity.z, multiply_add(velocity.y, velocity.y, velocity.x * velocity.x));
  return constant<T>(0.5) * mass * squared;
}

/// The height (m) of a point above a slope through the origin that descends by `grade` metres for each metre along x.
/// Gravitational energy is proportional to this height.
template <class T>
EVODEVO_HD T height(T x, T z, T grade) {
  return negative_multiply_add(grade, x, z);
}

/// The weight of a mass as a force along +z, N (negative: it points down; paper, section IV-C).
template <class T>
EVODEVO_HD T weight(T mass, T acceleration) {
  return constant<T>(0) - mass * acceleration;
}

/// The downhill component of gravity, along +x (N), on a mass whose weight() along z is `weight` (N).
template <class T>
EVODEVO_HD T downhill_force(T weight, T grade) {
  return constant<T>(0) - grade * weight;
}

/// The floor's normal force k max(0, -z), N along +z (paper, section IV-C1).
template <class T>
EVODEVO_HD T floor_force(T stiffness, T z) {
  return stiffness * maximum(constant<T>(0) - z, constant<T>(0));
}

/// Rough ground: random heights in [-roughness, roughness] at the corners of square cells, interpolated in between.
template <class T>
struct Roughness {
  T roughness;         ///< m
  T cells;             ///< per metre, 1/m: two for each wavelength
  std::uint32_t seed;  ///< Floor::first_line()
};

/// The ground under a point.
template <class T>
struct Ground {
  T height;            ///< m
  T slope_x, slope_y;  ///< derivatives of the height along x and y, 1
};

/// The interpolation p^3 (10 - 15 p + 6 p^2) between one corner (p = 0) and the next (p = 1), and its derivative. Slope
/// and curvature are zero at both corners, so the ground has no edges (Perlin, Improving noise, 2002).
template <class T>
struct Fade {
  T value, derivative;

  EVODEVO_HD explicit Fade(T p)
      : value(p * p * p * multiply_add(p, multiply_add(p, constant<T>(6), constant<T>(-15)), constant<T>(10))),
        derivative(constant<T>(30) * (p * (constant<T>(1) - p)) * (p * (constant<T>(1) - p))) {}
};

/// The height and slope of rough ground at (x, y), m. The ground has no border and no period.
template <class T>
EVODEVO_HD Ground<T> ground_at(T x, T y, const Roughness<T>& shape) {
  const T one = constant<T>(1), u = x * shape.cells, v = y * shape.cells, i = round_down(u), j = round_down(v);
  const Fade<T> p(u - i), q(v - j);
  const T here = random_of(i, j, shape.seed), right = random_of(i + one, j, shape.seed);
  const T behind = random_of(i, j + one, shape.seed), across = random_of(i + one, j + one, shape.seed);
  const T near = multiply_add(p.value, right - here, here), far = multiply_add(p.value, across - behind, behind);
  const T along_x = multiply_add(q.value, (across - behind) - (right - here), right - here);
  const T steepness = shape.roughness * shape.cells;
  return {shape.roughness * multiply_add(q.value, far - near, near), steepness * p.derivative * along_x,
          steepness * q.derivative * (far - near)};
}

/// The scalar product of a velocity (m/s) with the ground's normal (-slope_x, -slope_y, 1), which is not a unit vector:
/// the rate at which the clearance above the ground grows. The code of rigid floors calls it the rise.
template <class T>
EVODEVO_HD T along_normal(const Ground<T>& ground, const Triple<T>& v) {
  return negative_multiply_add(ground.slope_x, v.x, negative_multiply_add(ground.slope_y, v.y, v.z));
}

/// The squared length of the normal (-slope_x, -slope_y, 1), 1.
template <class T>
EVODEVO_HD T normal_squared(const Ground<T>& ground) {
  return multiply_add(ground.slope_x, ground.slope_x, multiply_add(ground.slope_y, ground.slope_y, constant<T>(1)));
}

/// Adds the x and y components of the vector up (-slope_x, -slope_y, 1), which is parallel to the ground's normal, to a
/// force (N) or velocity (m/s). A floor whose force along z is up = k depth has the potential k depth^2/2.
template <class T>
EVODEVO_HD Triple<T> add_horizontal_part(const Ground<T>& ground, const Triple<T>& v, T up) {
  return {negative_multiply_add(ground.slope_x, up, v.x), negative_multiply_add(ground.slope_y, up, v.y), v.z};
}

/// Adds the vector up (-slope_x, -slope_y, 1), parallel to the ground's normal, to a force (N) or velocity (m/s).
template <class T>
EVODEVO_HD Triple<T> add_along_normal(const Ground<T>& ground, const Triple<T>& v, T up) {
  const Triple<T> sum = add_horizontal_part(ground, v, up);
  return {sum.x, sum.y, sum.z + up};
}

/// The lowest rise (along_normal(), m/s) that a rigid floor lets a mass have in a step of dt seconds. `clearance` is
/// the height of the mass above the ground at the beginning of the step, m. A mass above the ground may come down to
/// it, and not further. A mass below the ground comes out slowly, so that it is not thrown: in 0.1 s, but at most at 1
/// m/s.
template <class T>
EVODEVO_HD T lowest_rise(T clearance, T dt) {
  const T slowest_exit = maximum(clearance / constant<T>(0.1), constant<T>(-1));
  return constant<T>(0) - maximum(clearance / dt, slowest_exit);
}

/// The speed (m/s) that the forces of a step give a mass towards a rigid floor, from its rises before and after them.
template <class T>
EVODEVO_HD T press(T before, T after) {
  return maximum(before - after, constant<T>(0));
}

/// The rise (m/s) with which a mass bounces off a rigid floor if its rise before is `arrival`; 0 if it does not arrive,
/// or not faster than the forces of one step would bring it back (`pressed`, press()): it rests then.
template <class T>
EVODEVO_HD T bounce(T restitution, T arrival, T pressed) {
  const T speed = constant<T>(0) - arrival;
  return zero_unless_greater(speed, pressed, restitution * speed);
}

/// The rise (m/s) of a mass after its contact with a rigid floor: a mass that arrives bounces, and one that rests or
/// does not bounce gets the lowest rise. The rise is never more than -arrival (except that of a mass that comes out of
/// the ground), so that contact adds no energy; kernels/README.md says for which methods that is proved.
template <class T>
EVODEVO_HD T rise_after_contact(T lowest, T bounce) {
  return choose(bounce, constant<T>(0), maximum(bounce, lowest), lowest);
}

/// Quadratic drag as a factor (kg/s) of the velocity: the force is -coefficient |v| v, with the coefficient in kg/m.
template <class T>
EVODEVO_HD T drag_factor(T coefficient, const Triple<T>& velocity) {
  const T squared = multiply_add(velocity.z, velocity.z, multiply_add(velocity.y, velocity.y, velocity.x * velocity.x));
  return constant<T>(0) - coefficient * square_root(squared);
}

/// Uniform damping as a factor (kg/s) of the velocity: the force is -rate m v, with the rate in 1/s.
template <class T>
EVODEVO_HD T damping_factor(T rate, T mass) {
  return constant<T>(0) - rate * mass;
}

/// The fraction 1/(1 + damped_dt c |v|/m) of a velocity that quadratic drag of coefficient c leaves after a time dt;
/// `coefficient` is damped_dt c/m (s/m). damped_dt is dt without damping, and (1 - decay)/rate with damping, where
/// decay = exp(-rate dt). Then v <- drag_retention decay v solves v' = -rate v - c |v| v/m (Bernoulli's equation)
/// exactly, and v <- drag_retention (decay v + damped_dt F/m) keeps the terminal velocity, F = (rate m + c |v|) v, at
/// any dt.
template <class T>
EVODEVO_HD T drag_retention(T coefficient, const Triple<T>& velocity) {
  const T squared = multiply_add(velocity.z, velocity.z, multiply_add(velocity.y, velocity.y, velocity.x * velocity.x));
  return constant<T>(1) / multiply_add(coefficient, square_root(squared), constant<T>(1));
}

/// The velocity v + dt F/m (m/s) after a force has acted for a time dt. `dt_over_mass` is dt/m (s/kg).
template <class T>
EVODEVO_HD T advanced_velocity(T velocity, T force, T dt_over_mass) {
  return multiply_add(force, dt_over_mass, velocity);
}

/// The fraction, from 0 to 1, of a tangential velocity (vx, vy; m/s) that Coulomb friction leaves (paper, section
/// IV-C1). Friction reduces the speed by at most `loss` = mu N dt/m (m/s) and never reverses the velocity, so a mass
/// inside the friction cone sticks.
template <class T>
EVODEVO_HD T friction_factor(T vx, T vy, T loss) {
  const T speed = square_root(multiply_add(vy, vy, vx * vx));
  // exactly 1 without contact; the lower bound of the divisor avoids 0/0 at rest
  return quotient_if_positive(speed - loss, maximum(speed, constant<T>(1e-30)));
}

/// The fraction that static friction leaves of a tangential velocity (vx, vy; m/s), of which sliding would leave
/// `kept`: a mass that is not faster than `held`, which is `loss` with the coefficient of static friction (m/s),
/// sticks.
template <class T>
EVODEVO_HD T kept_unless_held(T vx, T vy, T held, T kept) {
  return zero_unless_greater(square_root(multiply_add(vy, vy, vx * vx)), held, kept);
}

/// The velocity (m/s) of a mass after the friction of the floor has acted on its part along the ground. `push` is the
/// velocity that the floor has added along its unit normal, N dt/m (m/s). What `pressed` (m/s) is less than that comes
/// from an impact, in which a mass slides, so that static friction holds by min(push, pressed) alone.
/// `static_coefficient` may be 0 if it is not higher than `coefficient`, since the friction of sliding then stops every
/// mass that it would hold.
template <class T>
EVODEVO_HD Triple<T> after_friction(const Ground<T>& ground, const Triple<T>& v, T push, T pressed, T coefficient,
                                    T static_coefficient) {
  const T up = along_normal(ground, v) / normal_squared(ground);
  const Triple<T> along = add_along_normal(ground, v, constant<T>(0) - up);
  // the ground's slope may give the tangential velocity a third component
  const T across = square_root(multiply_add(along.y, along.y, along.z * along.z));
  const T sliding = friction_factor(along.x, across, coefficient * push);
  const T holding = push - maximum(push - pressed, constant<T>(0));
  const T lost = constant<T>(1) - kept_unless_held(along.x, across, static_coefficient * holding, sliding);
  // exactly v without contact
  return {negative_multiply_add(lost, along.x, v.x), negative_multiply_add(lost, along.y, v.y),
          negative_multiply_add(lost, along.z, v.z)};
}

/// The position x + dt v (m) after a time dt (s) at the velocity v (m/s).
template <class T>
EVODEVO_HD T advanced_position(T position, T velocity, T dt) {
  return multiply_add(dt, velocity, position);
}

#ifdef HWY_TARGET_INCLUDE
}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#else
}  // namespace evodevo::physics
#endif

#endif  // per-target include guard
