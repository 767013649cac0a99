#include "guard.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace evodevo {
namespace {

double epsilon(Precision precision) {
  return precision == Precision::float32 ? std::numeric_limits<float>::epsilon()
                                         : std::numeric_limits<double>::epsilon();
}

/// The largest distance from the origin along an axis, m.
double extent(const State& state) {
  double largest = 0;
  for (const Vec3& p : state.position) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return largest;
}

/// The strain of all muscles from full extension to full contraction, and of all springs by rounding, J.
double strain_allowance(const Body& body, double rounding, double places) {
  double sum = 0;
  for (const Spring& spring : body.springs) {
    const Material& material = body.materials[spring.material];
    const double stroke = 2 * material.amplitude * spring.rest_length;
    const double noise = rounding * (spring.rest_length + places);
    sum += 0.5 * material.stiffness * (stroke * stroke + noise * noise);
  }
  return sum;
}

double sag_allowance(const Body& body, const Scene& scene, double dt) {
  if (!scene.gravity || !scene.floor || scene.floor->stiffness <= 0) return 0;
  const double g = scene.gravity->downwards();
  double sum = 0;
  for (const Mass& mass : body.masses) sum += mass.mass * g * (mass.mass * g / scene.floor->stiffness + g * dt * dt);
  return sum;
}

std::string with_number(const char* format, double a, double b) {
  char text[128];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

}  // namespace

EnergyGuard::EnergyGuard(const Body& body, const State& state, const Scene& scene, Precision precision, double dt)
    : bound_(10 * (std::max(state.start_energy, 0.0) +
                   strain_allowance(body, 16384 * epsilon(precision), extent(state)) + sag_allowance(body, scene, dt))),
      acceleration_(scene.gravity ? scene.gravity->downwards() : 0) {}

std::string EnergyGuard::verdict(double kinetic, double elastic, double moment, bool finite) const {
  const double energy = kinetic + elastic;
  if (!finite || !std::isfinite(energy)) return "non-finite place, velocity or energy";
  const double bound = bound_ + 10 * std::max(0.0, -acceleration_ * moment);
  if (energy > bound) return with_number("energy of %.3g J above the bound of %.3g J", energy, bound);
  return {};
}

}  // namespace evodevo
