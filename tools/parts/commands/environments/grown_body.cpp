#include "environments/grown_body.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "life/body_building.hpp"

namespace evodevo {
namespace {

Eigen::Vector3d vector(Vec3 v) { return {v.x, v.y, v.z}; }

/// Returns the best rotation without reflection (Kabsch 1976). `covariance` is the weighted sum of to * from^T.
Eigen::Matrix3d best_rotation(const Eigen::Matrix3d& covariance) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
  return u * svd.matrixV().transpose();
}

}  // namespace

Vec3 undeformed(Vec3 position, std::span<const Vec3> positions, std::span<const Vec3> rest_positions) {
  if (positions.empty()) return position;
  constexpr double closest = 1e-9;  // m; keeps the weight of a mass at the same position finite
  std::vector<double> weights;
  double sum = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero(), rest_centre = centre;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const double distance = std::max(norm(positions[i] - position), closest);
    weights.push_back(std::pow(distance, -4));
    sum += weights[i];
    centre += weights[i] * vector(positions[i]);
    rest_centre += weights[i] * vector(rest_positions[i]);
  }
  centre /= sum, rest_centre /= sum;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < positions.size(); ++i)
    covariance +=
        weights[i] / sum * (vector(rest_positions[i]) - rest_centre) * (vector(positions[i]) - centre).transpose();
  const Eigen::Vector3d rest = rest_centre + best_rotation(covariance) * (vector(position) - centre);
  return {rest.x(), rest.y(), rest.z()};
}

GrowthObserver::GrowthObserver(const Body& born) : born_(born.masses.size()) {
  const Box box = bounding_box(rest_positions(born));
  corner_ = box.low;
  if (box.longest_side() > 0) length_ = box.longest_side();
  for (const Mass& mass : born.masses) rest_.emplace(rest_.size(), mass.rest);
}

GrownBody GrowthObserver::after_cycle(const Life& life) {
  GrownBody grown{life.living.body, life.living.state.position, {}, life.living.numbers.numbers(), born_};
  std::vector<Vec3> positions, rest_positions;  // of the masses that were in the body before this cycle's changes
  for (std::size_t i = 0; i < grown.numbers.size(); ++i)
    if (const auto known = rest_.find(grown.numbers[i]); known != rest_.end()) {
      positions.push_back(grown.positions[i]);
      rest_positions.push_back(known->second);
    }
  for (std::size_t i = 0; i < grown.numbers.size(); ++i) {
    const std::uint32_t number = grown.numbers[i];
    if (!rest_.contains(number)) rest_.emplace(number, undeformed(grown.positions[i], positions, rest_positions));
    grown.rest_positions.push_back(1 / length_ * (rest_.at(number) - corner_));
  }
  return grown;
}

}  // namespace evodevo
