// A scene: the forces that act on a body besides those of its springs. Forces that a scene does not have are not
// computed.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

namespace evodevo {

struct Gravity {
  double acceleration = 9.81;  ///< m/s^2
  double slope = 0;            ///< degrees; +x is downhill. The floor stays level; gravity is tilted instead

  /// The component of the acceleration along -z, m/s^2.
  double downwards() const { return acceleration * std::cos(radians()); }
  /// The descent of the ground along x, m per m.
  double grade() const { return std::tan(radians()); }

  bool operator==(const Gravity&) const = default;

 private:
  double radians() const { return slope * (3.14159265358979323846 / 180); }
};
/// The plane z = 0, or rough ground around it. An elastic floor pushes a mass below it upwards with a force of
/// `stiffness` times the depth (paper, section IV-C1). A rigid floor, which has a restitution, lets no mass sink into
/// it and has no stiffness.
struct Floor {
  double stiffness = 1e6;  ///< of an elastic floor, N/m
  double roughness = 0;    ///< largest height of hills and largest depth of hollows, m
  double wavelength = 1;   ///< distance between two hills with a hollow between them, m
  std::int64_t seed = 1;   ///< seed of the random heights
  /// The floor is rigid: the speed along its normal with which a mass bounces off, relative to the speed with which it
  /// arrives, from 0 to 1. Without a value, the floor is elastic.
  std::optional<double> restitution = {};

  bool rigid() const { return restitution.has_value(); }
  bool rough() const { return roughness > 0; }
  /// The number of the grid line at y = 0. A height at a grid point is a hash of the number of its line along x, which
  /// increases with y, and of its position on the line. If this number were the seed itself, the next seed would give
  /// the same ground moved by half a wavelength.
  std::uint32_t first_line() const { return static_cast<std::uint32_t>(seed) * 2654435769u; }  // 2^32/golden ratio
  /// The largest slope of the ground, m per m: that between a hollow and a hill half a wavelength apart.
  double steepest() const { return 7.5 * roughness / wavelength; }

  bool operator==(const Floor&) const = default;
};
/// Coulomb friction on the floor.
struct Friction {
  double coefficient = 0.5;                       ///< of a mass that slides, 1
  std::optional<double> static_coefficient = {};  ///< of a mass at rest, at least `coefficient`, 1; by default the same

  /// The coefficient that holds a mass at rest, 1.
  double holding() const { return static_coefficient.value_or(coefficient); }
  bool higher_at_rest() const { return holding() > coefficient; }

  bool operator==(const Friction&) const = default;
};
/// Uniform damping v' = -rate v. The default is the paper's factor of 0.99 per 0.5 ms: a rate of -ln(0.99)/0.5 ms.
struct Damping {
  double rate = 20.100671707002873;  ///< 1/s

  bool operator==(const Damping&) const = default;
};
/// Quadratic drag on every mass: the force is -coefficient |v| v.
struct Drag {
  double coefficient = 1.0;  ///< kg/m

  bool operator==(const Drag&) const = default;
};

struct Scene {
  std::optional<Gravity> gravity;
  std::optional<Floor> floor;
  std::optional<Friction> friction;  ///< acts only in a scene with a floor
  std::optional<Damping> damping;
  std::optional<Drag> drag;

  bool on_slope() const { return gravity && gravity->slope != 0; }

  bool operator==(const Scene&) const = default;
};

}  // namespace evodevo
