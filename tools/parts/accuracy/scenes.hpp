// The scenes in which methods are compared, each with its reference solution.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/scene.hpp"
#include "evodevo/body.hpp"

namespace evodevo::tools::accuracy {

/// A scene with a reference solution. The error of a state after `duration` is the largest distance of any mass from
/// its reference position, relative to the largest displacement of any mass from its start.
struct Trial {
  std::string name;
  std::string truth_by;  ///< origin of the reference solution, as text
  bool smooth;           ///< whether the motion is free of contact with a floor
  Body body;
  Scene scene;
  State start;
  double duration;  ///< simulated time [s]
  State truth;
  double ceiling = 0;  ///< error caused by moving the start by 1e-9 m; 0 if the reference is not simulated

  double error(const State& state) const;
};

/// One muscle, which oscillates and turns while damping and drag slow it down.
Trial spring_trial();
/// A beam that is clamped at one end, starts straight and oscillates under its own weight.
Trial beam_trial();
/// A rotating, falling lattice of muscles.
Trial lattice_trial();
/// A random body with muscles; drag is the only external force.
Trial swimmer_trial();
/// A lattice that falls on the floor and bounces, without friction.
Trial drop_trial();
/// A slab that slides on the floor until friction stops it.
Trial slide_trial();
/// A random body with muscles on the floor; its reference solution is simulated with steps of `dt` s.
Trial walker_trial(double dt);

/// A floor on which nothing bounces.
inline const Floor rigid_floor{.restitution = 0};
/// The scenes with contact again, on a rigid floor. Reference solutions that are not in closed form are simulated with
/// steps of `dt` s.
Trial rigid_drop_trial(double dt);
Trial rigid_slide_trial();
Trial rigid_walker_trial(double dt);

/// A beam of `voxels` x 1 x 1 voxels along x with edges of `edge` m. Its masses at x = 0 are held in place. The masses
/// at its free end have half the mass of the others, so that the beam's mass is uniform over its length.
Body cantilever(std::uint32_t voxels, double edge, double mass, double stiffness);

/// The Euler-Bernoulli beam that the cantilever approximates. With voxel edge a, spring stiffness k and mass m, its
/// bending stiffness is E I = 5/4 k a^3 (N m^2) and its mass per length 4 m / a (kg/m). In bending, the four edges
/// along the beam are stretched, and so are the diagonals of the upper and lower faces, which draw in the edge between
/// them until both are strained alike; all other springs keep their length.
struct EulerBernoulli {
  double bending_stiffness, mass_per_length, length;
  /// How far the free end sags under gravity of `acceleration` m/s^2, m.
  double end_deflection(double acceleration) const;
  /// The frequency of the first mode, Hz.
  double first_frequency() const;
};
EulerBernoulli euler_bernoulli(std::uint32_t voxels, double edge, double mass, double stiffness);

}  // namespace evodevo::tools::accuracy
