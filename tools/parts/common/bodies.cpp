#include "common/bodies.hpp"

#include <iomanip>
#include <random>
#include <sstream>
#include <utility>

#include "analysis/neighbours.hpp"
#include "evodevo/lattice.hpp"
#include "life/body_json.hpp"

namespace evodevo::tools {
namespace {

constexpr double mass_of_each = 0.2;  // each point mass, kg

/// The paper's materials except air (Table I).
std::vector<Material> paper_materials() {
  const double half_turn = 3.14159265358979323846;
  return {{5000, 0.14, 1, 0}, {4000, 0, 0, 0}, {5000, 0.14, 1, half_turn}, {10000, 0, 0, 0}};
}

Body body_of(const std::vector<Vec3>& positions, const std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs) {
  Body body;
  body.materials = paper_materials();
  for (const Vec3& position : positions) body.masses.push_back({position, mass_of_each});
  for (const auto& [a, b] : pairs) {
    const auto material = static_cast<std::uint32_t>(body.springs.size() % body.materials.size());
    body.springs.push_back({a, b, norm(positions[b] - positions[a]), material});
  }
  return body;
}

/// Replaces a body's materials with `count` materials with evenly spaced phases, through which the springs cycle.
void give_materials(Body& body, std::uint32_t count) {
  body.materials.clear();
  for (std::uint32_t i = 0; i < count; ++i) {
    const double part = static_cast<double>(i) / count;
    body.materials.push_back({4000 + 1000 * part, 0.14 * part, 1, 2 * 3.14159265358979323846 * part});
  }
  for (std::size_t i = 0; i < body.springs.size(); ++i)
    body.springs[i].material = static_cast<std::uint32_t>(i % count);
}

Body cube10() {
  const Lattice lattice = make_lattice({10, 10, 10}, 0.1);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const LatticeSpring& spring : lattice.springs) pairs.emplace_back(spring.a, spring.b);
  return body_of(lattice.corners, pairs);
}

}  // namespace

std::vector<Vec3> points_in_ball(std::uint32_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto coordinate = [&] { return static_cast<double>(random() >> 11) * 0x1p-52 - 1; };
  std::vector<Vec3> positions;
  while (positions.size() < count) {
    const double x = coordinate(), y = coordinate(), z = coordinate();
    if (dot({x, y, z}, {x, y, z}) <= 1) positions.push_back({x, y, z});
  }
  return positions;
}

Body random_ball(std::uint32_t masses) {
  const std::vector<Vec3> positions = points_in_ball(masses, 1);
  return body_of(positions, nearest_pairs(positions, 25));
}

NamedBody body_named(const std::string& name, std::uint32_t masses, std::uint32_t materials) {
  NamedBody named{name, {}};
  if (name == "cube10") {
    named.body = cube10();
  } else if (name == "knn1000") {
    named.body = random_ball(masses);
    if (masses != 1000) named.name += " with " + std::to_string(masses) + " masses";
  } else {
    named.body = read_body(name).body;
  }
  if (materials > 0) give_materials(named.body, materials);
  return named;
}

Body without_actuation(Body body) {
  for (Material& material : body.materials) material.amplitude = 0;
  return body;
}

Scene walking_scene() { return {Gravity{}, Floor{}, Friction{}, Damping{}, std::nullopt}; }

std::string description(const Scene& scene) {
  std::ostringstream text;
  text << std::setprecision(4);
  const auto add = [&](const char* force, double value, const char* unit) {
    text << (text.tellp() > 0 ? ", " : "") << force << ' ' << value << unit;
  };
  if (scene.gravity) add("gravity", scene.gravity->acceleration, " m/s^2");
  if (scene.gravity && scene.gravity->slope != 0) add("slope", scene.gravity->slope, " degrees");
  if (scene.floor) add("floor", scene.floor->stiffness, " N/m");
  if (scene.friction) add("friction", scene.friction->coefficient, "");
  if (scene.damping) add("damping", scene.damping->rate, " 1/s");
  if (scene.drag) add("drag", scene.drag->coefficient, " kg/m");
  return text.str();
}

}  // namespace evodevo::tools
