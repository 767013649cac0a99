#include "cuda/layout/force_range.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "cuda/layout/fixed_point.hpp"

namespace evodevo::cuda {
namespace {

constexpr std::size_t few_masses = 1000;  // all of which may load a spring

/// The pieces of a body: masses that are joined by springs, directly or through others.
class Pieces {
 public:
  explicit Pieces(const Body& body) : root_(body.masses.size()) {
    std::iota(root_.begin(), root_.end(), 0u);
    for (const Spring& spring : body.springs) root_[root_of(spring.a)] = root_of(spring.b);
  }

  /// A mass that stands for the piece of a mass.
  std::uint32_t root_of(std::uint32_t mass) {
    for (; root_[mass] != mass; mass = root_[mass]) root_[mass] = root_[root_[mass]];
    return mass;
  }

 private:
  std::vector<std::uint32_t> root_;
};

/// The largest mass (kg) whose weight may load a spring.
double loading_mass(const Body& body) {
  struct Piece {
    double mass = 0, heaviest = 0;
    bool hangs = false;
  };
  if (body.masses.size() <= few_masses) {
    double sum = 0;
    for (const Mass& mass : body.masses) sum += mass.mass;
    return sum;
  }
  Pieces pieces(body);
  std::vector<Piece> piece(body.masses.size());  // at the mass that stands for it
  for (std::uint32_t i = 0; i < body.masses.size(); ++i) {
    auto& [mass, heaviest, hangs] = piece[pieces.root_of(i)];
    mass += body.masses[i].mass;
    heaviest = std::max(heaviest, body.masses[i].mass);
    hangs = hangs || body.masses[i].mass == 0;
  }
  double largest = 0;
  for (const auto& [mass, heaviest, hangs] : piece)
    largest = std::max(largest, hangs ? mass : std::min(mass, few_masses * heaviest));
  return largest;
}

/// An upper bound (N) of the force of a spring that stops two moving masses: 2 v sqrt(k m/2), with the largest speed v,
/// mass m and `stiffness` k (N/m) of the body.
double stopping_force(const Body& body, const State& state, double stiffness) {
  double speed = 0, mass = 0;
  for (const Vec3& v : state.velocity) speed = std::max(speed, norm(v));
  for (const Mass& m : body.masses) mass = std::max(mass, m.mass);
  return 2 * speed * std::sqrt(stiffness * mass / 2);
}

/// The force (N) of the strongest dashpot when one of its ends is stopped: at the largest speed of the state, or at
/// that of a fall by the body's own size. 0 without dashpots.
double landing_force(const Body& body, const State& state, const Scene& scene) {
  if (std::ranges::all_of(body.materials, [](const Material& material) { return material.damping == 0; })) return 0;
  double coefficient = 0, speed = 0;
  for (const Spring& spring : body.springs) coefficient = std::max(coefficient, body.damping(spring));
  if (coefficient == 0) return 0;
  for (const Vec3& v : state.velocity) speed = std::max(speed, norm(v));
  if (scene.gravity && scene.floor)
    speed += std::sqrt(2 * std::abs(scene.gravity->acceleration) * bounding_box(state.position).longest_side());
  return coefficient * speed;
}

}  // namespace

template <class T>
ForceRange force_range(const Body& body, const State& state, const Scene& scene) {
  const double weight = scene.gravity ? std::abs(scene.gravity->acceleration) * loading_mass(body) : 0;
  double largest = weight, doubled = 0, damping = 0, strongest = 0;
  bool driven = false;
  std::vector<std::uint32_t> degree(body.masses.size());
  for (const Spring& spring : body.springs) {
    const Material& material = body.materials[spring.material];
    const double stiffness = body.stiffness(spring);
    const double length = spring.rest_length * (1 + std::abs(material.amplitude));
    const double strain = norm(state.position[spring.b] - state.position[spring.a]) - spring.rest_length;
    strongest = std::max(strongest, stiffness);
    doubled = std::max(doubled, std::abs(stiffness) * length);
    largest = std::max(largest, std::abs(stiffness) * 2 * std::abs(strain));
    driven = driven || material.amplitude * material.frequency != 0;
    damping = std::max(damping, material.damping);
    ++degree[spring.a], ++degree[spring.b];
  }
  largest = std::max({largest, stopping_force(body, state, strongest), driven ? 2 * doubled : doubled});
  largest = std::max(largest * (1 + 2 * damping), largest + landing_force(body, state, scene));
  ForceRange range;
  const std::uint32_t terms = degree.empty() ? 1 : std::max(1u, *std::max_element(degree.begin(), degree.end()));
  // a margin of one percent for rounding of the force itself
  const double units = 0.99 * std::min(FixedPoint<T>::largest_term, FixedPoint<T>::largest_sum / terms);
  if (largest > 0 && std::isfinite(largest)) range.resolution = std::exp2(std::ceil(std::log2(largest / units)));
  range.largest = units * range.resolution;
  return range;
}

template ForceRange force_range<float>(const Body&, const State&, const Scene&);
template ForceRange force_range<double>(const Body&, const State&, const Scene&);

}  // namespace evodevo::cuda
