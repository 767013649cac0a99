// Robots as data: point masses joined by springs. Shared by the simulation core, the host and every plugin.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace evodevo {

/// A position (m), velocity (m/s) or direction (1).
struct Vec3 {
  double x = 0, y = 0, z = 0;

  /// The coordinate along an axis: x for 0, y for 1, z for 2. The index is not checked; any other gives z.
  double& operator[](std::size_t axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  double operator[](std::size_t axis) const { return axis == 0 ? x : axis == 1 ? y : z; }

  friend Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3 operator*(double s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
  friend Vec3 operator*(Vec3 a, double s) { return s * a; }
  friend Vec3 operator/(Vec3 a, double s) { return {a.x / s, a.y / s, a.z / s}; }
  friend Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
  Vec3& operator+=(Vec3 b) { return *this = *this + b; }
  Vec3& operator-=(Vec3 b) { return *this = *this - b; }
  Vec3& operator*=(double s) { return *this = s * *this; }
  Vec3& operator/=(double s) { return *this = *this / s; }
  friend bool operator==(Vec3 a, Vec3 b) = default;
};

inline double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline double norm(Vec3 a) { return std::sqrt(dot(a, a)); }
/// The vector of length 1 in the same direction; a vector of length 0, which has no direction, stays as it is.
inline Vec3 normalised(Vec3 a) {
  const double length = norm(a);
  return length == 0 ? a : a / length;
}
inline Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

/// An axis-aligned box (m).
struct Box {
  Vec3 low, high;

  /// The box's longest side, m.
  double longest_side() const { return std::max({high.x - low.x, high.y - low.y, high.z - low.z}); }
};

/// The largest amplitude of a material: its springs never shrink to less than a tenth of their rest length.
inline constexpr double largest_amplitude = 0.9;

/// The material of a spring. The actuated rest length is L(t) = L0 (1 + amplitude sin(2 pi frequency t + phase)), and
/// the force is stiffness (|d| - L(t)). Paper, section IV-A and Table I. A dashpot beside the spring resists changes of
/// its length (Body::damping()).
struct Material {
  double stiffness = 0;  ///< N/m; a spring of stiffness 0 is air and is never created
  double amplitude = 0;  ///< relative change of length, from 0 to largest_amplitude, 1
  double frequency = 0;  ///< Hz
  double phase = 0;      ///< rad
  double damping = 0;    ///< ratio of critical damping of the two masses that a spring joins, 1

  friend bool operator==(const Material&, const Material&) = default;

  /// The material's relative length L(t)/L0 at time t (s). The phase is reduced before the sine.
  double relative_length(double time) const {
    const double turns = frequency * time;
    return 1 + amplitude * std::sin(2 * 3.14159265358979323846 * (turns - std::floor(turns)) + phase);
  }
};

/// Whether the material is air; no springs are made of air.
inline bool is_air(const Material& material) { return !(material.stiffness > 0); }

/// The material of a spring between a mass of `a` and a mass of `b`: the mean of all parameters
/// ("interpolation", paper, section IV-A1).
inline Material mean(const Material& a, const Material& b) {
  return {(a.stiffness + b.stiffness) / 2, (a.amplitude + b.amplitude) / 2, (a.frequency + b.frequency) / 2,
          (a.phase + b.phase) / 2, (a.damping + b.damping) / 2};
}

/// The value of Mass::material for a mass without a material (in encodings that give materials to springs, not to
/// masses).
inline constexpr std::int32_t no_material = -1;

struct Mass {
  Vec3 rest;                            ///< position in the undeformed body, m
  double mass = 0;                      ///< kg
  std::int32_t material = no_material;  ///< index into Body::materials, or no_material
  std::uint32_t air_contacts = 0;       ///< number of neighbours to which no spring was made because it would be air
  double payload = 0;                   ///< part of `mass` that is payload of the scene, kg
};

struct Spring {
  std::uint32_t a = 0, b = 0;   ///< indices into Body::masses, a != b
  double rest_length = 0;       ///< L0, m
  std::uint32_t material = 0;   ///< index into Body::materials
  double first_length = 0;      ///< L0 when the spring was made, at birth or later, m; set by the host
  double stiffness_factor = 1;  ///< stiffness relative to that of the material, 1; above 0
};

/// A body without its motion. Springs that join the same pair of masses act in parallel; only encodings that ask for
/// it make such springs (Blueprint::parallel).
struct Body {
  std::vector<Mass> masses;
  std::vector<Spring> springs;
  std::vector<Material> materials;
  /// The number of materials that come from the experiment; they are the first ones in the list. Set by the host at
  /// birth. These materials are always kept; every other material is removed when no spring or mass uses it any more.
  std::uint32_t base_materials = 0;

  /// The stiffness of a spring of this body, N/m.
  double stiffness(const Spring& spring) const {
    return spring.stiffness_factor * materials[spring.material].stiffness;
  }

  /// The coefficient c of a spring's dashpot, N s/m: 2 zeta sqrt(k m) with the damping ratio zeta of the material and
  /// the reduced mass m of the two masses. A mass of 0 kg never moves; then m is the other mass.
  double damping(const Spring& spring) const {
    const double a = masses[spring.a].mass, b = masses[spring.b].mass;
    const double reduced = a > 0 && b > 0 ? a * b / (a + b) : std::max(a, b);
    return 2 * materials[spring.material].damping * std::sqrt(stiffness(spring) * reduced);
  }

  /// Returns the index of `material` in `materials`, and appends it if it is new. Searches linearly.
  std::uint32_t material_index(const Material& material) {
    const auto found = std::find(materials.begin(), materials.end(), material);
    if (found != materials.end()) return static_cast<std::uint32_t>(found - materials.begin());
    materials.push_back(material);
    return static_cast<std::uint32_t>(materials.size() - 1);
  }
};

/// The motion of a body: one entry for each of its masses.
struct State {
  std::vector<Vec3> position;  ///< m
  std::vector<Vec3> velocity;  ///< m/s
  double time = 0;             ///< time since birth, s
  double start_energy = 0;     ///< upper bound of gravitational + kinetic + elastic energy, for the energy guard:
                               ///< energy at birth, plus what development and muscles can have added since, J
};

/// The smallest box around `positions`; all zero if there are none.
inline Box bounding_box(std::span<const Vec3> positions) {
  if (positions.empty()) return {};
  Box box{positions[0], positions[0]};
  for (const Vec3& p : positions) {
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
  }
  return box;
}

/// The centre of mass, m; zero for a body without masses.
inline Vec3 centre_of_mass(const Body& body, std::span<const Vec3> positions) {
  Vec3 sum;
  double total = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    sum = sum + body.masses[i].mass * positions[i];
    total += body.masses[i].mass;
  }
  return total > 0 ? (1 / total) * sum : Vec3{};
}

/// How an evaluation ended, or what verification then found: `artefact`, `lucky` or `passive`. Only individuals with
/// the status `ok` have a fitness.
enum class Status : std::uint8_t { ok, invalid, diverged, artefact, passive, lucky };

inline const char* name(Status status) {
  switch (status) {
    case Status::ok:
      return "ok";
    case Status::invalid:
      return "invalid";
    case Status::diverged:
      return "diverged";
    case Status::artefact:
      return "artefact";
    case Status::passive:
      return "passive";
    case Status::lucky:
      return "lucky";
  }
  return "?";
}

}  // namespace evodevo
