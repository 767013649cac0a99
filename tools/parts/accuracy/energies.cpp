#include <cmath>

#include "analysis/energy.hpp"
#include "common/bodies.hpp"
#include "studies.hpp"
#include "threads/parallel.hpp"

namespace evodevo::tools::accuracy {
namespace {

constexpr double dt = 0.0005;  // time step, s

/// The body at its rest positions; each mass has a velocity of its own, with up to 1 m/s along each axis.
State shaken(const Body& body) {
  State state = resting(body, {});
  for (std::size_t i = 0; i < state.velocity.size(); ++i) {
    const double angle = 1 + 12.9898 * static_cast<double>(i);
    state.velocity[i] = {std::sin(angle), std::sin(2 * angle), std::sin(3 * angle)};
  }
  return with_energy(body, std::move(state), {});
}

/// Simulates `steps` steps in `parts` equal parts; returns the energy after each part, relative to the initial energy.
std::vector<double> course(const Body& body, const Setting& setting, double steps, int parts) {
  Traveller traveller{&body, shaken(body)};
  Simulation simulation({}, setting, {"cpu", 1});
  std::vector<double> energies;
  for (int part = 0; part < parts && traveller.alive(); ++part) {
    simulation.advance({&traveller, 1}, steps / parts * setting.dt);
    energies.push_back(total_energy(body, traveller.state, {}) / traveller.state.start_energy);
  }
  return energies;
}

}  // namespace

std::vector<Table> energies(const Settings& settings) {
  const Body body = without_actuation(random_ball(30));
  const double steps = settings.quick ? 3e4 : 1e6;
  constexpr int parts = 200;
  std::vector<Setting> runs;
  for (const Method method : all_methods())
    for (const Precision precision : {Precision::float32, Precision::float64}) runs.push_back({method, precision, dt});
  std::vector<std::vector<double>> courses(runs.size());
  Workers(settings.device.threads).for_each(runs.size(), [&](std::size_t i) {
    courses[i] = course(body, runs[i], steps, parts);
  });
  Table table("energy", {"method", "precision", "steps", "energy (of the first)"});
  for (std::size_t i = 0; i < runs.size(); ++i)
    for (std::size_t part = 0; part < courses[i].size(); ++part)
      table.add({std::string(name(runs[i].method)), name(runs[i].precision),
                 static_cast<double>(part + 1) * steps / parts, courses[i][part]});
  return {table};
}

}  // namespace evodevo::tools::accuracy
