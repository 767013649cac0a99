// The energy of a body.
#pragma once

#include <vector>

#include "core/scene.hpp"
#include "evodevo/body.hpp"
#include "physics/physics.hpp"

namespace evodevo {

/// The sum of a body's kinetic energy, elastic energy and, in a scene with gravity, gravitational energy relative to
/// the origin, J. This value is the start_energy of a State that is not made by state_at_birth().
double total_energy(const Body& body, const State& state, const Scene& scene);

/// The elastic energy of a body for different rest lengths of its springs, while everything else stays as it is.
class ElasticEnergy {
 public:
  ElasticEnergy(const Body& body, const State& state);

  /// The energy with the rest lengths that the body has now, J.
  double operator()() const;

 private:
  struct Stretch {
    physics::Separation<double> separation;
    double relative_length;  ///< of the spring's material, 1
    double stiffness;        ///< N/m
  };
  const Body& body_;
  std::vector<Stretch> stretches_;  ///< of each spring
};

}  // namespace evodevo
