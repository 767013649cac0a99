// The forces of the world and how time is stepped. A force that a scene does not hold is not computed.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

namespace evodevo {

struct Gravity {
  double acceleration = 9.81;  ///< m/s^2
  double slope = 0;            ///< degrees; the floor stays level and gravity leans instead, so that +x is downhill

  /// The acceleration along -z, m/s^2.
  double downwards() const { return acceleration * std::cos(radians()); }
  /// How much the ground falls for each metre along x.
  double grade() const { return std::tan(radians()); }

 private:
  double radians() const { return slope * (3.14159265358979323846 / 180); }
};
/// The plane z = 0, or rough ground about it, that pushes a mass below it up with `stiffness` times its depth (paper,
/// section IV-C1).
struct Floor {
  double stiffness = 1e6;  ///< N/m
  double roughness = 0;    ///< the largest height and depth of hills and hollows, m
  double wavelength = 1;   ///< from one hill to the next, where a hollow is between, m
  std::int64_t seed = 1;   ///< of the heights

  bool rough() const { return roughness > 0; }
  /// What the heights are drawn by. Each line of heights along x has a number, counted from this one: were it the seed,
  /// the ground of the next seed would be the same one, moved by half a wavelength.
  std::uint32_t first_line() const { return static_cast<std::uint32_t>(seed) * 2654435769u; }  // 2^32/golden ratio
  /// The most that the ground rises for each metre: between heights half a wavelength apart.
  double steepest() const { return 7.5 * roughness / wavelength; }
};
/// Coulomb friction on the floor.
struct Friction {
  double coefficient = 0.5;  ///< 1
};
/// Uniform damping v' = -rate v. The paper's factor of 0.99 every 0.5 ms is a rate of -ln(0.99)/0.5 ms.
struct Damping {
  double rate = 20.100671707002873;  ///< 1/s
};
/// Quadratic drag on every mass: force = -coefficient |v| v.
struct Drag {
  double coefficient = 1.0;  ///< kg/m
};

struct Scene {
  std::optional<Gravity> gravity;
  std::optional<Floor> floor;
  std::optional<Friction> friction;  ///< acts only where there is a floor
  std::optional<Damping> damping;
  std::optional<Drag> drag;
};

}  // namespace evodevo
