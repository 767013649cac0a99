#include <cmath>

#include "scenes.hpp"
#include "studies.hpp"
#include "threads/parallel.hpp"

namespace evodevo::tools::accuracy {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double edge = 0.1, mass = 0.2, stiffness = 5000;  // m, kg, N/m
constexpr Setting setting{Method::velocity_verlet, Precision::float64, 0.0005};

double end_height(const State& state, std::uint32_t voxels) { return state.position[voxels].z; }

/// Simulates the beam until it rests under gravity of `acceleration` (m/s^2); returns how far its free end has sagged,
/// m. The caller chooses an acceleration at which theory predicts a thousandth of the length.
double deflection(std::uint32_t voxels, const EulerBernoulli& theory, double acceleration) {
  const Body body = cantilever(voxels, edge, mass, stiffness);
  const double frequency = 2 * pi * theory.first_frequency();
  const Scene scene{Gravity{acceleration}, {}, {}, Damping{2 * frequency}, {}};  // critical damping
  const State start = resting(body, scene);
  const Traveller settled = simulate(body, start, scene, setting, 15 / frequency);
  return end_height(start, voxels) - end_height(settled.state, voxels);
}

/// The shape of the first mode of a beam that is clamped at x = 0; x is relative to the length of the beam.
double first_mode(double x) {
  constexpr double root = 1.8751040687119611;
  const double part = (std::cosh(root) + std::cos(root)) / (std::sinh(root) + std::sin(root));
  return std::cosh(root * x) - std::cos(root * x) - part * (std::sinh(root * x) - std::sin(root * x));
}

/// The frequency at which the free end oscillates about its position at rest, Hz. The beam starts with velocities in
/// the shape of the first mode.
double frequency(std::uint32_t voxels, const EulerBernoulli& theory) {
  const Body body = cantilever(voxels, edge, mass, stiffness);
  State start = resting(body, {});
  const double speed = 1e-3 * theory.length * theory.first_frequency();
  for (std::size_t i = 0; i < start.velocity.size(); ++i)
    start.velocity[i].z = speed * first_mode(start.position[i].x / theory.length);
  Traveller beam{&body, with_energy(body, start, {})};
  Simulation simulation({}, setting, {"cpu", 1});
  const double interval = std::round(0.005 / theory.first_frequency() / setting.dt) * setting.dt;
  double before = 0, first = 0, last = 0;
  int passes = 0;
  for (int i = 1; passes < 21; ++i) {
    simulation.advance({&beam, 1}, interval);
    const double now = end_height(beam.state, voxels) - end_height(start, voxels);
    if (before * now < 0) {
      last = (i - now / (now - before)) * interval;
      if (passes++ == 0) first = last;
    }
    before = now;
  }
  return (passes - 1) / (last - first) / 2;
}

}  // namespace

std::vector<Table> beam(const Settings& settings) {
  const std::vector<std::uint32_t> sizes =
      settings.quick ? std::vector<std::uint32_t>{5, 10, 20} : std::vector<std::uint32_t>{5, 10, 15, 20, 30, 40};
  std::vector<std::vector<Cell>> rows(sizes.size());
  Workers(settings.device.threads).for_each(sizes.size(), [&](std::size_t i) {
    const EulerBernoulli theory = euler_bernoulli(sizes[i], edge, mass, stiffness);
    const double acceleration = 1e-3 * theory.length / theory.end_deflection(1);
    rows[i] = {static_cast<double>(sizes[i]), deflection(sizes[i], theory, acceleration),
               theory.end_deflection(acceleration), frequency(sizes[i], theory), theory.first_frequency()};
  });
  Table table("beam", {"length (voxels)", "deflection (m)", "Euler-Bernoulli deflection (m)", "first frequency (Hz)",
                       "Euler-Bernoulli first frequency (Hz)"});
  for (auto& row : rows) table.add(std::move(row));
  return {table};
}

}  // namespace evodevo::tools::accuracy
