#include "limits.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "perturbation.hpp"
#include "simulation.hpp"

namespace evodevo::tools::accuracy {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double bounced_mass = 0.2;  // kg

/// The factor by which one step of rk4, with dt = 1, changes the magnitude of a solution exp(z t).
double rk4_amplification(std::complex<double> z) {
  return std::abs(1.0 + z + z * z / 2.0 + z * z * z / 6.0 + z * z * z * z / 24.0);
}

bool rk4_is_bounded(double phase, double damping_step) {
  const std::complex<double> root = std::sqrt(std::complex<double>(damping_step * damping_step / 4 - phase * phase));
  const double largest =
      std::max(rk4_amplification(-damping_step / 2 + root), rk4_amplification(-damping_step / 2 - root));
  return largest <= 1 + 1e-12;
}

/// Whether both roots of z^2 - trace z + determinant lie in the closed unit disc (Jury's criterion).
bool roots_are_bounded(double trace, double determinant) {
  return determinant <= 1 && std::abs(trace) <= 1 + determinant;
}

/// Finds, by bisection, the value at which `holds` becomes false, given that it is true at `low` and false at `high`.
/// The relative tolerance is 1e-4.
template <class F>
double border(double low, double high, const F& holds) {
  while (high - low > 1e-4 * low) {
    const double middle = (low + high) / 2;
    (holds(middle) ? low : high) = middle;
  }
  return low;
}

/// Finds the first value above `start` at which `holds` becomes false: tries values that grow by `factor`, then
/// bisects. Returns infinity if `holds` is still true above `end`.
template <class F>
double first_border(double start, double end, double factor, const F& holds) {
  double low = start;
  while (holds(low * factor)) {
    low *= factor;
    if (low > end) return infinity;
  }
  return border(low, low * factor, holds);
}

/// Raises the initial energy that the divergence guard compares with: near the stability limit, the energy of a bounded
/// motion varies by a factor of 50.
State with_headroom(const Body& body, State state, const Scene& scene) {
  state = with_energy(body, std::move(state), scene);
  state.start_energy *= 100;
  return state;
}

bool stays_bounded(const Body& body, const State& start, const Scene& scene, Method method, double dt, int steps) {
  return simulate(body, start, scene, {method, Precision::float64, dt}, steps * dt).alive();
}

/// The largest gain of a mass of `bounced_mass` that bounces on a floor, without any other force; the contact takes at
/// most `steps` steps.
double largest_gain(const Floor& floor, Method method, double dt, double steps) {
  constexpr int phases = 64;
  constexpr double speed = 1;  // m/s
  const Scene scene{{}, floor, {}, {}, {}};
  Body body;
  body.masses = {{{}, bounced_mass}};
  std::vector<Traveller> masses;
  for (int i = 0; i < phases; ++i) {
    State start = resting(body, scene);
    start.position[0].z = (i + 0.5) / phases * speed * dt;
    start.velocity[0].z = -speed;
    masses.push_back({&body, with_headroom(body, std::move(start), scene)});
  }
  Simulation(scene, {method, Precision::float64, dt}, {"cpu", 1}).advance(masses, steps * dt);
  double largest = 0;
  for (const Traveller& m : masses) {
    const double rise = m.state.velocity[0].z / speed;
    largest = std::max(largest, rise < 0 ? infinity : rise * rise);  // a mass that still falls has not met the floor
  }
  return largest;
}

}  // namespace

bool is_bounded(Method method, double phase, double damping_step) {
  const double squared = phase * phase, decay = std::exp(-damping_step);
  const double push = damping_step > 0 ? -std::expm1(-damping_step) / damping_step : 1;
  switch (method) {
    case Method::paper_euler:
      return roots_are_bounded(1 + decay - decay * squared, decay);
    case Method::symplectic_euler:
      return roots_are_bounded(1 + decay - push * squared, decay);
    case Method::velocity_verlet:
      return roots_are_bounded((1 + decay) * (1 - squared / 2), decay);
    case Method::rk4:
      return rk4_is_bounded(phase, damping_step);
    case Method::implicit:
    case Method::xpbd:
      return true;
  }
  return false;
}

Band bounded_phases(Method method, double damping_step) {
  constexpr double lowest = 1e-3, highest = 100, factor = 1.01;
  const auto bounded = [&](double phase) { return is_bounded(method, phase, damping_step); };
  if (bounded(lowest)) return {0, first_border(lowest, highest, factor, bounded)};
  const double low = first_border(lowest, highest, factor, [&](double phase) { return !bounded(phase); });
  return {low, first_border(low * factor, highest, factor, bounded)};
}

double predicted_limit(Method method, double frequency, double rate) {
  return first_border(1e-3 / frequency, 100 / frequency, 1.02,
                      [&](double dt) { return is_bounded(method, frequency * dt, rate * dt); });
}

double Oscillator::frequency() const { return std::sqrt(2 * stiffness / mass); }

bool stays_bounded(const Oscillator& oscillator, Method method, double dt) {
  Body body;
  body.materials = {{oscillator.stiffness, 0, 0, 0}};
  body.masses = {{{0, 0, 0}, oscillator.mass}, {{1.001, 0, 0}, oscillator.mass}};
  body.springs = {{0, 1, 1.0, 0}};
  Scene scene;
  if (oscillator.rate > 0) scene.damping = Damping{oscillator.rate};
  return stays_bounded(body, with_headroom(body, resting(body, scene), scene), scene, method, dt, 1500);
}

double measured_limit(const Oscillator& oscillator, Method method) {
  const double unit = 1 / oscillator.frequency();
  return first_border(0.1 * unit, 100 * unit, 1.1, [&](double dt) { return stays_bounded(oscillator, method, dt); });
}

double measured_limit(const Body& body, Method method, double low, double high) {
  const State start = with_headroom(body, perturbed(resting(body, {}), 1e-5), {});
  return border(low, high, [&](double dt) { return stays_bounded(body, start, {}, method, dt, 10000); });
}

double contact_gain(Method method, double contact_phase) {
  const Floor elastic;
  // the contact lasts half a period of the mass on the floor's spring; that is several steps if the floor is soft
  return largest_gain(elastic, method, contact_phase * std::sqrt(bounced_mass / elastic.stiffness),
                      std::ceil(10 + 20 / contact_phase));
}

double rigid_contact_gain(Method method, double restitution, double dt) {
  return largest_gain({.restitution = restitution}, method, dt, 10);
}

}  // namespace evodevo::tools::accuracy
