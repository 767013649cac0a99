#include "analysis/stiffness_bounds.hpp"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace evodevo {

/// The diagonal block of one mass in the stiffness matrix, which is symmetric: sums over its springs, N/m.
struct StiffnessBounds::Block {
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;

  void add(const Block& other) {
    xx += other.xx, yy += other.yy, zz += other.zz;
    xy += other.xy, xz += other.xz, yz += other.yz;
  }

  double trace() const { return xx + yy + zz; }

  Eigen::Matrix3d matrix() const {
    Eigen::Matrix3d m;
    m << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    return m;
  }

  /// Whether all eigenvalues are below `limit`, N/m: whether limit I - block has a Cholesky decomposition.
  bool is_below(double limit) const {
    // written so that NaN fails
    const double first = limit - xx;
    if (!(first > 0)) return false;
    const double second = limit - yy - xy * xy / first;
    if (!(second > 0)) return false;
    const double mixed = -yz - xy * xz / first;
    return limit - zz - xz * xz / first - mixed * mixed / second > 0;
  }
};

StiffnessBounds::StiffnessBounds(const Body& body, std::span<const Vec3> positions, Resistance resistance)
    : body_(body), positions_(positions) {
  resistance_.reserve(body.springs.size());
  for (const Spring& spring : body.springs) resistance_.push_back(resistance(body, spring));
}

double StiffnessBounds::of_discs() const {
  std::vector<double> sum(body_.masses.size());
  for (std::size_t i = 0; i < resistance_.size(); ++i) {
    sum[body_.springs[i].a] += resistance_[i];
    sum[body_.springs[i].b] += resistance_[i];
  }
  double largest = 0, not_finite = 0;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    if (body_.masses[i].mass > 0) largest = std::max(largest, 2 * sum[i] / body_.masses[i].mass);
    not_finite += 0 * (positions_[i].x + positions_[i].y + positions_[i].z);
  }
  return largest + not_finite;
}

double StiffnessBounds::of_blocks() const {
  const std::vector<Block> blocks = blocks_of_masses();
  double largest = 0;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const double mass = body_.masses[i].mass;
    // the trace is an upper bound that costs nothing
    if (!(mass > 0) || 2 * blocks[i].trace() <= largest * mass) continue;
    solver.computeDirect(blocks[i].matrix(), Eigen::EigenvaluesOnly);
    const double bound = 2 * solver.eigenvalues()[2] / mass;
    if (std::isnan(bound)) return bound;
    largest = std::max(largest, bound);
  }
  return largest;
}

bool StiffnessBounds::blocks_are_below(double limit) const {
  const std::vector<Block> blocks = blocks_of_masses();
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const double mass = body_.masses[i].mass;
    if (mass > 0 && !blocks[i].is_below(limit * mass / 2)) return false;
  }
  return true;
}

std::vector<StiffnessBounds::Block> StiffnessBounds::blocks_of_masses() const {
  std::vector<Block> blocks(body_.masses.size());
  for (std::size_t i = 0; i < resistance_.size(); ++i) {
    const Spring& spring = body_.springs[i];
    const Vec3 d = positions_[spring.b] - positions_[spring.a];
    const double squared = dot(d, d), k = resistance_[i];
    Block block{.xx = k, .yy = k, .zz = k};
    // a spring without a direction is treated as resisting in every direction: an upper bound for any direction
    if (squared != 0) {
      const Vec3 kd = k / squared * d;
      block = {kd.x * d.x, kd.y * d.y, kd.z * d.z, kd.x * d.y, kd.x * d.z, kd.y * d.z};
    }
    blocks[spring.a].add(block);
    blocks[spring.b].add(block);
  }
  return blocks;
}

}  // namespace evodevo
