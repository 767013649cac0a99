#include "analysis/stability.hpp"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace evodevo {
namespace {

/// The mass-weighted stiffness matrix A = M^-1/2 K M^-1/2 of a body, 1/s^2; K is the sum of k e e^T over the springs,
/// with e the direction of a spring. Its eigenvalues are the squares of the body's angular frequencies.
class StiffnessMatrix {
 public:
  StiffnessMatrix(const Body& body, std::span<const Vec3> positions)
      : size_(3 * static_cast<Eigen::Index>(body.masses.size())) {
    for (const Mass& mass : body.masses) weight_.push_back(mass.mass > 0 ? 1 / std::sqrt(mass.mass) : 0);
    for (const Spring& spring : body.springs) {
      const Vec3 d = positions[spring.b] - positions[spring.a];
      const double length = norm(d);
      const double stiffness = body.stiffness(spring);
      const Eigen::Vector3d direction =
          Eigen::Vector3d(d.x, d.y, d.z).normalized();  // zero for a spring of zero length
      links_.push_back({spring.a, spring.b, stiffness, length != 0, direction});
    }
  }

  Eigen::Index size() const { return size_; }

  /// A v
  Eigen::VectorXd times(const Eigen::VectorXd& v) const {
    Eigen::VectorXd result = Eigen::VectorXd::Zero(size_);
    for (const Link& link : links_) {
      const double wa = weight_[link.a], wb = weight_[link.b];
      const Eigen::Vector3d across = wb * v.segment<3>(3 * link.b) - wa * v.segment<3>(3 * link.a);
      // a spring without a direction is treated as resisting in every direction: an upper bound for any direction
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

/// An upper bound of the matrix's largest eigenvalue, 1/s^2. Because |xb - xa|^2 <= 2 |xa|^2 + 2 |xb|^2, K is at most
/// twice its diagonal blocks. The bound is therefore the maximum of 2 lambda/m over the masses, where lambda is the
/// largest eigenvalue of the sum of k e e^T over the mass's springs. Gershgorin's bound, 2 sum(k)/m, is larger because
/// it ignores that springs have different directions.
double eigenvalue_bound(const Body& body, std::span<const Vec3> positions) {
  std::vector<Eigen::Matrix3d> block(body.masses.size(), Eigen::Matrix3d::Zero());
  for (const Spring& spring : body.springs) {
    const Vec3 d = positions[spring.b] - positions[spring.a];
    const double stiffness = body.stiffness(spring), square = dot(d, d);
    const Eigen::Vector3d e(d.x, d.y, d.z);
    const Eigen::Matrix3d k = square != 0 ? (stiffness / square * e * e.transpose()).eval()
                                          : (stiffness * Eigen::Matrix3d::Identity()).eval();
    block[spring.a] += k;
    block[spring.b] += k;
  }
  double largest = 0;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  for (std::size_t i = 0; i < block.size(); ++i) {
    if (!(body.masses[i].mass > 0)) continue;
    // the trace is an upper bound of lambda that costs nothing
    if (2 * block[i].trace() <= largest * body.masses[i].mass) continue;
    solver.computeDirect(block[i], Eigen::EigenvaluesOnly);
    const double bound = 2 * solver.eigenvalues()[2] / body.masses[i].mass;
    if (std::isnan(bound)) return bound;
    largest = std::max(largest, bound);
  }
  return largest;
}

/// A unit vector to start an iteration from: always the same, and not an eigenvector of any regular body.
Eigen::VectorXd scattered(Eigen::Index size) {
  Eigen::VectorXd v(size);
  for (Eigen::Index i = 0; i < size; ++i) v[i] = std::sin(1 + 12.9898 * static_cast<double>(i + 1) * (i % 7 + 1));
  return v.normalized();
}

/// The tridiagonal matrix that the Lanczos iteration builds, one row per step.
class Tridiagonal {
 public:
  void add_row(double diagonal, double off_diagonal) {
    diagonal_.push_back(diagonal);
    off_diagonal_.push_back(off_diagonal);
  }

  /// The largest eigenvalue, and the absolute last component of its eigenvector. That component times the next
  /// off-diagonal element is the residual of the eigenvector in the full matrix.
  std::pair<double, double> largest() const {
    const auto size = static_cast<Eigen::Index>(diagonal_.size());
    const Eigen::Map<const Eigen::VectorXd> d(diagonal_.data(), size), o(off_diagonal_.data() + 1, size - 1);
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
    solver.computeFromTridiagonal(d, o);
    return {solver.eigenvalues()[size - 1], std::abs(solver.eigenvectors()(size - 1, size - 1))};
  }

 private:
  std::vector<double> diagonal_, off_diagonal_;  // the first off-diagonal element is outside the matrix
};

/// The largest eigenvalue (1/s^2) of `matrix` by the Lanczos iteration; if the eigenvalue is above `enough`, some
/// number between `enough` and the eigenvalue. The estimates rise towards the eigenvalue. The iteration ends when the
/// residual is below 1 % of the estimate (after about 15 iterations for a body of a thousand masses) or after 60
/// iterations; a margin of 2 %, which is 1 % in frequency, covers the remaining error.
double largest_eigenvalue(const StiffnessMatrix& matrix, double enough) {
  constexpr int iterations = 60, between_looks = 3;
  constexpr double margin = 1.02, residual = 0.01;
  Tridiagonal small;
  Eigen::VectorXd previous = Eigen::VectorXd::Zero(matrix.size());
  Eigen::VectorXd v = scattered(matrix.size());
  double beta = 0, estimate = 0;
  for (int i = 1; i <= iterations && i <= matrix.size(); ++i) {
    Eigen::VectorXd next = matrix.times(v) - beta * previous;
    const double diagonal = next.dot(v);
    small.add_row(diagonal, beta);
    next -= diagonal * v;
    const double bound = std::max(std::abs(diagonal), beta);
    beta = next.norm();
    const bool exhausted = beta <= 1e-12 * bound;
    if (exhausted || i % between_looks == 0 || i == iterations || i == matrix.size()) {
      const auto [eigenvalue, last] = small.largest();
      estimate = eigenvalue;
      if (exhausted || estimate > enough || beta * last <= residual * estimate) break;
    }
    previous = std::move(v);
    v = next / beta;
  }
  return margin * estimate;
}

/// The cheapest upper bound of the largest eigenvalue (1/s^2), by Gershgorin discs on blocks of one mass: the largest 2
/// sum(k)/m. NaN if a position is not finite.
double disc_bound(const Body& body, std::span<const Vec3> positions) {
  std::vector<double> sum(body.masses.size());
  for (const Spring& spring : body.springs) {
    const double stiffness = body.stiffness(spring);
    sum[spring.a] += stiffness;
    sum[spring.b] += stiffness;
  }
  double largest = 0, not_finite = 0;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    if (body.masses[i].mass > 0) largest = std::max(largest, 2 * sum[i] / body.masses[i].mass);
    not_finite += 0 * (positions[i].x + positions[i].y + positions[i].z);
  }
  return largest + not_finite;
}

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The highest frequency among the springs that are muscles, Hz; 0 if there is none.
double fastest_muscle(const Body& body) {
  double fastest = 0;
  for (const Spring& spring : body.springs)
    if (const Material& material = body.materials[spring.material]; material.amplitude != 0)
      fastest = std::max(fastest, std::abs(material.frequency));
  return fastest;
}

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
  // rough ground has horizontal force components too
  const double stiffness = scene.floor->stiffness * (1 + std::pow(scene.floor->steepest(), 2));
  return 1.2 * std::sqrt(mass / stiffness);
}

double largest_contact_dt(const Scene& scene, const Body& body, Method method) {
  double lightest = infinity;
  for (const Mass& mass : body.masses)
    if (mass.mass > 0) lightest = std::min(lightest, mass.mass);
  return largest_contact_dt(scene, lightest, method);
}

double largest_spring_dt(const Material& material, double mass, Method method) {
  if (!is_explicit(method) || material.stiffness <= 0) return infinity;
  return oscillation_limit(method) / std::sqrt(2 * material.stiffness / mass);
}

double largest_muscle_dt(const Material& material) {
  if (material.amplitude == 0 || material.frequency == 0) return infinity;
  return 0.5 / std::abs(material.frequency);
}

double largest_muscle_dt(const Body& body) {
  const double frequency = fastest_muscle(body);
  return frequency > 0 ? 0.5 / frequency : infinity;
}

double largest_dt(const Body& body, std::span<const Vec3> positions, Method method, double wanted) {
  if (!is_explicit(method)) return wanted;
  const double limit = oscillation_limit(method);
  if (wanted * std::sqrt(disc_bound(body, positions)) <= limit) return wanted;
  const double bound = eigenvalue_bound(body, positions);
  if (bound == 0 || wanted * std::sqrt(bound) <= limit) return wanted;
  const double largest = limit / std::sqrt(largest_eigenvalue(StiffnessMatrix(body, positions), infinity));
  return largest >= wanted ? wanted : largest;  // NaN stays NaN
}

double safe_dt(const Body& body, std::span<const Vec3> positions, const Scene& scene, Method method) {
  constexpr double longest = 0.01, steps_of_a_stroke = 20;
  double other = std::min(longest, largest_contact_dt(scene, body, method));
  if (const double frequency = fastest_muscle(body); frequency > 0)
    other = std::min(other, 1 / (steps_of_a_stroke * frequency));
  if (method == Method::rk4 && scene.damping && scene.damping->rate > 0)
    other = std::min(other, 2 / scene.damping->rate);
  const double wanted = other / spring_margin;
  const double springs = largest_dt(body, positions, method, wanted);
  return springs == wanted ? other : spring_margin * springs;
}

bool is_stable(const Body& body, std::span<const Vec3> positions, Method method, double dt) {
  if (!is_explicit(method)) return true;
  const double limit = std::pow(oscillation_limit(method) / dt, 2);
  return disc_bound(body, positions) <= limit || eigenvalue_bound(body, positions) <= limit ||
         largest_eigenvalue(StiffnessMatrix(body, positions), limit) <= limit;
}

}  // namespace evodevo
