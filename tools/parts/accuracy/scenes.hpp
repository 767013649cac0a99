// The scenes in which methods are compared, each with the truth to compare with.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/scene.hpp"
#include "evodevo/body.hpp"

namespace evodevo::tools::accuracy {

/// A scene whose true outcome is known. Errors are those of positions: the largest of any mass after `duration`,
/// relative to the farthest way of any mass.
struct Trial {
  std::string name;
  std::string truth_by;  ///< where the truth is from, in words
  bool smooth;           ///< whether nothing touches a floor
  Body body;
  Scene scene;
  State start;
  double duration;  ///< s
  State truth;
  double ceiling = 0;  ///< the error that moving the start by 1e-9 m brings; 0 where the truth is no simulation

  double error(const State& state) const;
};

/// One muscle that swings while damping and drag slow it down.
Trial spring_trial();
/// A beam held at one end that swings from where it was straight to its weight's sag.
Trial beam_trial();
/// A turning lattice of muscles.
Trial lattice_trial();
/// A body of muscles in drag alone.
Trial swimmer_trial();
/// A lattice that falls on the floor and bounces, without friction.
Trial drop_trial();
/// A slab that slides on the floor until friction stops it.
Trial slide_trial();
/// A body of muscles on the floor; its truth takes steps of `dt` s.
Trial walker_trial(double dt);

/// A beam of n x 1 x 1 voxels of edge `edge` along x whose masses at x = 0 are held; those at its end have half of the
/// mass of the others, as a uniform beam's end has.
Body cantilever(std::uint32_t voxels, double edge, double mass, double stiffness);

/// Of the same beam, per voxel's edge a, stiffness k and mass m: the stiffness in bending E I = 5/4 k a^3 (N m^2) and
/// the mass per length 4 m / a (kg/m). In bending, the four edges along the beam are stretched, and so are the upper
/// and lower faces' diagonals, which draw in the edge between them until both are strained alike; all other springs
/// keep their length.
struct EulerBernoulli {
  double bending_stiffness, mass_per_length, length;
  /// Under the weight of `acceleration` m/s^2, m.
  double end_deflection(double acceleration) const;
  /// Hz
  double first_frequency() const;
};
EulerBernoulli euler_bernoulli(std::uint32_t voxels, double edge, double mass, double stiffness);

}  // namespace evodevo::tools::accuracy
