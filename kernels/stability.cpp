#include "stability.hpp"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace evodevo {
namespace {

/// The mass-weighted stiffness matrix A = M^-1/2 K M^-1/2 of a body, 1/s^2; K is the sum of k e e^T
/// over the springs, e a spring's direction. Its eigenvalues are the squares of the body's angular frequencies.
class StiffnessMatrix {
 public:
  StiffnessMatrix(const Body& body, std::span<const Vec3> places)
      : size_(3 * static_cast<Eigen::Index>(body.masses.size())) {
    for (const Mass& mass : body.masses) weight_.push_back(mass.mass > 0 ? 1 / std::sqrt(mass.mass) : 0);
    for (const Spring& spring : body.springs) {
      const Vec3 d = places[spring.b] - places[spring.a];
      const double length = norm(d);
      const double stiffness = body.materials[spring.material].stiffness;
      const Eigen::Vector3d direction = Eigen::Vector3d(d.x, d.y, d.z).normalized();  // of zero: zero
      links_.push_back({spring.a, spring.b, stiffness, length > 0, direction});
    }
  }

  Eigen::Index size() const { return size_; }

  /// A v
  Eigen::VectorXd times(const Eigen::VectorXd& v) const {
    Eigen::VectorXd result = Eigen::VectorXd::Zero(size_);
    for (const Link& link : links_) {
      const double wa = weight_[link.a], wb = weight_[link.b];
      const Eigen::Vector3d across = wb * v.segment<3>(3 * link.b) - wa * v.segment<3>(3 * link.a);
      // a spring without a direction resists in all of them, which bounds whatever it will do
      const Eigen::Vector3d force =
          link.stiffness * (link.directed ? (link.direction.dot(across) * link.direction).eval() : across);
      result.segment<3>(3 * link.a) -= wa * force;
      result.segment<3>(3 * link.b) += wb * force;
    }
    return result;
  }

 private:
  struct Link {
    Eigen::Index a, b;
    double stiffness;  ///< N/m
    bool directed;     ///< whether the spring has a length and so a direction
    Eigen::Vector3d direction;
  };

  Eigen::Index size_;
  std::vector<double> weight_;  ///< 1/sqrt(mass)
  std::vector<Link> links_;
};

/// A bound of the matrix's largest eigenvalue by Gershgorin's discs on blocks of one mass: 2 sum(k)/m, at most.
double eigenvalue_bound(const Body& body) {
  std::vector<double> sum(body.masses.size());
  for (const Spring& spring : body.springs) {
    const double stiffness = body.materials[spring.material].stiffness;
    sum[spring.a] += stiffness;
    sum[spring.b] += stiffness;
  }
  double largest = 0;
  for (std::size_t i = 0; i < sum.size(); ++i)
    if (body.masses[i].mass > 0) largest = std::max(largest, 2 * sum[i] / body.masses[i].mass);
  return largest;
}

/// A start for an iteration: no eigenvector of any regular body, and the same every time.
Eigen::VectorXd scattered(Eigen::Index size) {
  Eigen::VectorXd v(size);
  for (Eigen::Index i = 0; i < size; ++i) v[i] = std::sin(1 + 12.9898 * static_cast<double>(i + 1) * (i % 7 + 1));
  return v.normalized();
}

/// The largest eigenvalue of `matrix` or, where that is above `enough`, something between, by Lanczos' form of the
/// power iteration. Its estimates rise towards the eigenvalue; after 60 iterations (of a thousand-mass body they are
/// right to about 0.1 %) a margin of 2 %, one in frequency, covers what is missing.
double largest_eigenvalue(const StiffnessMatrix& matrix, double enough) {
  constexpr int iterations = 60;
  constexpr double margin = 1.02;
  std::vector<double> diagonal, off_diagonal;
  Eigen::VectorXd previous = Eigen::VectorXd::Zero(matrix.size());
  Eigen::VectorXd v = scattered(matrix.size());
  double beta = 0, estimate = 0;
  for (int i = 0; i < iterations && i < matrix.size(); ++i) {
    Eigen::VectorXd next = matrix.times(v) - beta * previous;
    diagonal.push_back(next.dot(v));
    next -= diagonal.back() * v;
    const Eigen::Map<Eigen::VectorXd> d(diagonal.data(), static_cast<Eigen::Index>(diagonal.size()));
    const Eigen::Map<Eigen::VectorXd> o(off_diagonal.data(), static_cast<Eigen::Index>(off_diagonal.size()));
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> small;
    small.computeFromTridiagonal(d, o, Eigen::EigenvaluesOnly);
    estimate = small.eigenvalues().maxCoeff();
    beta = next.norm();
    if (estimate > enough || beta <= 1e-12 * estimate) break;
    off_diagonal.push_back(beta);
    previous = v;
    v = next / beta;
  }
  return margin * estimate;
}

constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

double oscillation_limit(Method method) {
  switch (method) {
    case Method::paper_euler:
    case Method::symplectic_euler:
    case Method::velocity_verlet:
      return 2;
    case Method::rk4:
      return 2 * std::sqrt(2);
    case Method::implicit:
    case Method::xpbd:
      return infinity;
  }
  return 0;
}

double largest_contact_dt(const Scene& scene, double mass, Method method) {
  if (!is_explicit(method) || !scene.floor || scene.floor->stiffness <= 0) return infinity;
  return 1.2 * std::sqrt(mass / scene.floor->stiffness);
}

double largest_spring_dt(const Material& material, double mass, Method method) {
  if (!is_explicit(method) || material.stiffness <= 0) return infinity;
  return oscillation_limit(method) / std::sqrt(2 * material.stiffness / mass);
}

double largest_dt(const Body& body, std::span<const Vec3> places, Method method) {
  if (!is_explicit(method)) return infinity;
  const double eigenvalue = largest_eigenvalue(StiffnessMatrix(body, places), infinity);
  return eigenvalue > 0 ? oscillation_limit(method) / std::sqrt(eigenvalue) : infinity;
}

bool is_stable(const Body& body, std::span<const Vec3> places, const Stepping& stepping) {
  if (!is_explicit(stepping.method)) return true;
  const double frequency = oscillation_limit(stepping.method) / stepping.dt;
  const double limit = frequency * frequency;
  return eigenvalue_bound(body) <= limit || largest_eigenvalue(StiffnessMatrix(body, places), limit) <= limit;
}

}  // namespace evodevo
