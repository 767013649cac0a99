// What is computed: every force, the time step and the energies, as small functions of any arithmetic type T.
//
// Scalar code (tests, CUDA threads) includes this file as it is and finds the functions in evodevo::physics. The vector
// code of the CPU is compiled once per instruction set, so it includes this file once per instruction set as well and
// finds them in its own namespace, on vectors.
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

/// What two joined masses are to each other.
template <class T>
struct Separation {
  Triple<T> d;  ///< from a to b, m
  T squared;    ///< |d|^2, m^2; never quite zero
};

template <class T>
EVODEVO_HD Separation<T> separation(const Triple<T>& a, const Triple<T>& b) {
  const Triple<T> d{b.x - a.x, b.y - a.y, b.z - a.z};
  // added first, it changes no real distance in its last bit and keeps d/|d| finite where two masses coincide
  return {d, multiply_add(d.z, d.z, multiply_add(d.y, d.y, multiply_add(d.x, d.x, vanishing_square<T>())))};
}

/// |d|, m; never quite zero.
template <class T>
EVODEVO_HD T length(const Separation<T>& s) {
  return square_root(s.squared);
}

/// A spring's force on its end a over d: k (|d| - L)/|d|, N/m. Times d it is the force, which is zero, never NaN, where
/// |d| = 0 (paper, section IV-C; README, What is simulated).
template <class T>
EVODEVO_HD T spring_factor(T distance, T stiffness, T spring_length) {
  return stiffness - stiffness * spring_length / distance;
}

/// 1/|d|, 1/m; finite.
template <class T>
EVODEVO_HD T inverse_length(const Separation<T>& s) {
  return inverse_square_root(s.squared);
}

/// |d| from 1/|d|, m; exactly zero where the masses coincide, and with it the tension.
template <class T>
EVODEVO_HD T length_by_inverse(const Separation<T>& s, T inverse_distance) {
  return (s.squared - vanishing_square<T>()) * inverse_distance;
}

/// The same as spring_factor(), from 1/|d| and the force k L that a length of zero would bring: no division.
template <class T>
EVODEVO_HD T spring_factor_by_inverse(T inverse_distance, T stiffness, T rest_force) {
  return negative_multiply_add(rest_force, inverse_distance, stiffness);
}

/// The spring's pull k (|d| - L), N; negative where it pushes, zero where |d| = 0.
template <class T>
EVODEVO_HD T spring_tension(const Separation<T>& s, T distance, T factor) {
  return zero_unless_greater(s.squared, vanishing_square<T>(), factor * distance);
}

/// The power (W) that an actuated spring puts into the body where its own length changes at `rate` (m/s); a brake is 0.
template <class T>
EVODEVO_HD T actuation_power(T tension, T rate) {
  return maximum(negative_multiply_add(tension, rate, constant<T>(0)), constant<T>(0));
}

/// A spring's stiffness as a matrix, transverse I + along along^T, N/m.
template <class T>
struct SpringStiffness {
  T transverse;     ///< N/m
  Triple<T> along;  ///< (N/m)^1/2
};

/// How a spring's force answers to its ends' places: k (n n^T + max(0, 1 - L/|d|)(I - n n^T)), n = d/|d|. A compressed
/// spring pushes sideways what has left its line, a negative stiffness; it is left out, so that the matrix is positive
/// semidefinite (Choi and Ko, Stable but responsive cloth, 2002). `factor` is spring_factor(); without length, zero.
template <class T>
EVODEVO_HD SpringStiffness<T> spring_stiffness(const Separation<T>& s, T distance, T stiffness, T factor) {
  const T transverse = maximum(factor, constant<T>(0));
  const T scale = square_root(stiffness - transverse) / distance;
  return {transverse, {scale * s.d.x, scale * s.d.y, scale * s.d.z}};
}

/// The matrix times a vector.
template <class T>
EVODEVO_HD Triple<T> times(const SpringStiffness<T>& k, const Triple<T>& v) {
  const T pull = multiply_add(k.along.z, v.z, multiply_add(k.along.y, v.y, k.along.x * v.x));
  return {multiply_add(k.along.x, pull, k.transverse * v.x), multiply_add(k.along.y, pull, k.transverse * v.y),
          multiply_add(k.along.z, pull, k.transverse * v.z)};
}

/// How fast a spring's force on its end a changes while its end b moves away from a with `velocity`, N/s:
/// (factor (I - n n^T) + k n n^T) velocity. That compressed springs push sideways is in it, but of no more than k, as
/// of a spring at half its length; of one without length there is none.
template <class T>
EVODEVO_HD Triple<T> spring_force_rate(const Separation<T>& s, T stiffness, T factor, const Triple<T>& velocity) {
  const T sideways = maximum(factor, constant<T>(0) - stiffness);
  const T transverse = zero_unless_greater(s.squared, vanishing_square<T>(), sideways);
  const T along = multiply_add(s.d.z, velocity.z, multiply_add(s.d.y, velocity.y, s.d.x * velocity.x)) / s.squared;
  const T pull = (stiffness - transverse) * along;
  return {multiply_add(pull, s.d.x, transverse * velocity.x), multiply_add(pull, s.d.y, transverse * velocity.y),
          multiply_add(pull, s.d.z, transverse * velocity.z)};
}

/// The force (N) of a stiffness as it will be at the end of a step: k violation/(1 + k dt push w), where `violation`
/// (m) is how far from its rest the step would lead without it and w the inverse masses (1/kg) that it moves. In terms
/// of forces, this is the constraint of compliance 1/k of extended position-based dynamics, lambda/dt^2 (Macklin et
/// al., XPBD, 2016); with damping the force adds push w to the velocity instead of dt w (see drag_retention()).
template <class T>
EVODEVO_HD T compliant_force(T stiffness, T violation, T dt_push, T inverse_mass) {
  return stiffness * violation / multiply_add(stiffness * dt_push, inverse_mass, constant<T>(1));
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

/// How high a place lies where the ground falls by `grade` for each metre along x, m: for energies.
template <class T>
EVODEVO_HD T height(T x, T z, T grade) {
  return negative_multiply_add(grade, x, z);
}

/// The weight of a mass, N along z (paper, section IV-C).
template <class T>
EVODEVO_HD T weight(T mass, T acceleration) {
  return constant<T>(0) - mass * acceleration;
}

/// What pulls a mass of `weight` (N along z) downhill, N along x.
template <class T>
EVODEVO_HD T downhill_force(T weight, T grade) {
  return constant<T>(0) - grade * weight;
}

/// The floor's push k max(0, -z), N along z (paper, section IV-C1).
template <class T>
EVODEVO_HD T floor_force(T stiffness, T z) {
  return stiffness * maximum(constant<T>(0) - z, constant<T>(0));
}

/// Rough ground: random heights, of at most `roughness`, at the corners of square cells.
template <class T>
struct Roughness {
  T roughness;         ///< m
  T cells;             ///< in a metre: two for each wavelength
  std::uint32_t seed;  ///< Floor::first_line()
};

/// The ground under a place.
template <class T>
struct Ground {
  T height;            ///< m
  T slope_x, slope_y;  ///< how much it rises for each metre
};

/// How the ground goes from one corner to the next, and its slope: p^3 (10 - 15 p + 6 p^2), level at both and without a
/// step in slope or curvature (Perlin, Improving noise, 2002).
template <class T>
struct Fade {
  T value, rise;

  EVODEVO_HD explicit Fade(T p)
      : value(p * p * p * multiply_add(p, multiply_add(p, constant<T>(6), constant<T>(-15)), constant<T>(10))),
        rise(constant<T>(30) * (p * (constant<T>(1) - p)) * (p * (constant<T>(1) - p))) {}
};

/// The height and slope of rough ground; it has no end and does not repeat.
template <class T>
EVODEVO_HD Ground<T> ground_at(T x, T y, const Roughness<T>& shape) {
  const T one = constant<T>(1), u = x * shape.cells, v = y * shape.cells, i = whole_below(u), j = whole_below(v);
  const Fade<T> p(u - i), q(v - j);
  const T here = random_of(i, j, shape.seed), right = random_of(i + one, j, shape.seed);
  const T behind = random_of(i, j + one, shape.seed), across = random_of(i + one, j + one, shape.seed);
  const T near = multiply_add(p.value, right - here, here), far = multiply_add(p.value, across - behind, behind);
  const T along_x = multiply_add(q.value, (across - behind) - (right - here), right - here);
  const T steepness = shape.roughness * shape.cells;
  return {shape.roughness * multiply_add(q.value, far - near, near), steepness * p.rise * along_x,
          steepness * q.rise * (far - near)};
}

/// The part of a velocity along the ground's normal (-slope_x, -slope_y, 1), m/s.
template <class T>
EVODEVO_HD T off_ground(const Ground<T>& ground, const Triple<T>& v) {
  return negative_multiply_add(ground.slope_x, v.x, negative_multiply_add(ground.slope_y, v.y, v.z));
}

/// The square of that normal.
template <class T>
EVODEVO_HD T normal_squared(const Ground<T>& ground) {
  return multiply_add(ground.slope_x, ground.slope_x, multiply_add(ground.slope_y, ground.slope_y, constant<T>(1)));
}

/// Adds to a force (N) or velocity (m/s) what a push along the ground's normal, `up` along z, has along x and y. With
/// a push of k times the depth along z the force has the potential k depth^2/2.
template <class T>
EVODEVO_HD Triple<T> leaned(const Ground<T>& ground, const Triple<T>& v, T up) {
  return {negative_multiply_add(ground.slope_x, up, v.x), negative_multiply_add(ground.slope_y, up, v.y), v.z};
}

/// What quadratic drag multiplies the velocity by: the force is -coefficient |v| v (README, What is simulated), kg/s.
template <class T>
EVODEVO_HD T drag_factor(T coefficient, const Triple<T>& velocity) {
  const T squared = multiply_add(velocity.z, velocity.z, multiply_add(velocity.y, velocity.y, velocity.x * velocity.x));
  return constant<T>(0) - coefficient * square_root(squared);
}

/// What uniform damping multiplies the velocity by where it is a force: -rate m v, kg/s.
template <class T>
EVODEVO_HD T damping_factor(T rate, T mass) {
  return constant<T>(0) - rate * mass;
}

/// What is left of a velocity after a time under quadratic drag: 1/(1 + push c |v|/m), `coefficient` = push c/m (s/m).
/// Without damping push is the time, with it push = (1 - decay)/rate, decay = exp(-rate time): then
/// v <- drag_retention * decay * v solves v' = -rate v - c |v| v/m (Bernoulli's equation) exactly, and
/// v <- drag_retention * (decay * v + push F/m) rests where F = (rate m + c |v|) v, whatever the time.
template <class T>
EVODEVO_HD T drag_retention(T coefficient, const Triple<T>& velocity) {
  const T squared = multiply_add(velocity.z, velocity.z, multiply_add(velocity.y, velocity.y, velocity.x * velocity.x));
  return constant<T>(1) / multiply_add(coefficient, square_root(squared), constant<T>(1));
}

/// The velocity after a step's forces: v + dt F/m. With damping it is multiplied by exp(-rate dt) next; together, the
/// reading of the paper's equations (section IV-C; README, What is simulated) that `paper-euler` names.
template <class T>
EVODEVO_HD T advanced_velocity(T velocity, T force, T dt_over_mass) {
  return multiply_add(force, dt_over_mass, velocity);
}

/// What Coulomb friction leaves of the tangential velocity: it takes at most `loss` = mu N dt/m (m/s) and never turns
/// it round, so a mass inside the cone sticks (paper, section IV-C1; README, What is simulated). In [0, 1].
template <class T>
EVODEVO_HD T friction_factor(T vx, T vy, T loss) {
  const T speed = square_root(multiply_add(vy, vy, vx * vx));
  // without contact exactly 1, and no 0/0 where nothing moves
  return maximum(speed - loss, constant<T>(0)) / maximum(speed, constant<T>(1e-30));
}

/// The place after a step: x + dt v, v the new velocity (semi-implicit Euler).
template <class T>
EVODEVO_HD T moved(T place, T velocity, T dt) {
  return multiply_add(dt, velocity, place);
}

#ifdef HWY_TARGET_INCLUDE
}  // namespace evodevo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#else
}  // namespace evodevo::physics
#endif

#endif  // per-target include guard
