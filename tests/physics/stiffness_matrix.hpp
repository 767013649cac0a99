// Dense matrices of small bodies, whose eigenvalues tell what the analysis must find.
#pragma once

#include <Eigen/Eigenvalues>
#include <cmath>
#include <span>

#include "evodevo/body.hpp"

namespace evodevo::test {

/// Returns M^-1/2 K M^-1/2 of a body at its rest positions, 1/s^2, where each spring resists with its own number, N/m.
inline Eigen::MatrixXd mass_weighted_matrix(const Body& body, std::span<const double> resistance) {
  const auto size = static_cast<Eigen::Index>(3 * body.masses.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
  for (std::size_t i = 0; i < body.springs.size(); ++i) {
    const Mass &a = body.masses[body.springs[i].a], &b = body.masses[body.springs[i].b];
    const Vec3 along = b.rest - a.rest;
    const Eigen::Vector3d direction = Eigen::Vector3d(along.x, along.y, along.z).normalized();
    Eigen::VectorXd edge = Eigen::VectorXd::Zero(size);
    edge.segment<3>(3 * body.springs[i].a) = -direction / std::sqrt(a.mass);
    edge.segment<3>(3 * body.springs[i].b) = direction / std::sqrt(b.mass);
    matrix += resistance[i] * edge * edge.transpose();
  }
  return matrix;
}

inline double largest_eigenvalue(const Eigen::MatrixXd& matrix) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
}

}  // namespace evodevo::test
