// The guard against bodies that gain energy from nothing.
#pragma once

#include "evodevo/body.hpp"
#include "scene.hpp"
#include "simulator.hpp"

namespace evodevo {

/// Decides whether a body's energy can still come from its height, its start and its muscles. A healthy body stays
/// below a fifth of the bound, a diverged one passes 1e20 times it, so all allowances are generous.
class EnergyGuard {
 public:
  /// Steps between two checks.
  static constexpr std::uint64_t interval = 100;

  /// The bound for one run is ten times the sum of State::start_energy, all muscles' strain sum k (2 amplitude L0)^2/2,
  /// what falling below z = 0, where no floor is or down a slope, sets free and, so that a body for which all these are
  /// zero may rest, what rounding (16,384 units in the last place of each spring and its place) and the sagging of
  /// masses into the floor (m g (m g/k + g dt^2) each) can bring.
  EnergyGuard(const Body& body, const State& state, const Scene& scene, Precision precision, double dt);

  /// What kinetic plus elastic energy must not pass, J; falling below the origin raises it tenfold of what it sets
  /// free.
  double bound() const { return bound_; }

  /// Why the body has diverged; empty where it has not. `kinetic` and `elastic` in J; `moment`: the sum of mass times
  /// physics::height(), kg m; `finite`: whether all places and velocities are.
  std::string verdict(double kinetic, double elastic, double moment, bool finite) const;

 private:
  double bound_;
  double acceleration_;
};

}  // namespace evodevo
