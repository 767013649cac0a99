#include "analysis/stability.hpp"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "analysis/stiffness_bounds.hpp"

namespace evodevo {
namespace {

bool is_damped(const Body& body) {
  // a look at the few materials saves one at the many springs
  const auto damps = [](const Material& material) { return material.damping != 0; };
  return std::ranges::any_of(body.materials, damps) &&
         std::any_of(body.springs.begin(), body.springs.end(),
                     [&](const Spring& spring) { return body.materials[spring.material].damping != 0; });
}

/// The mass-weighted matrix A = M^-1/2 K M^-1/2 of a body; K is the sum of k e e^T over the springs, with k the
/// resistance and e the direction of a spring. If k is the stiffness, the eigenvalues are the squares of the body's
/// angular frequencies, 1/s^2. The resistance can be changed, since directions take longest to compute.
class StiffnessMatrix {
 public:
  StiffnessMatrix(const Body& body, std::span<const Vec3> positions)
      : size_(3 * static_cast<Eigen::Index>(body.masses.size())) {
    for (const Mass& mass : body.masses) weight_.push_back(mass.mass > 0 ? 1 / std::sqrt(mass.mass) : 0);
    const bool damped = is_damped(body);
    for (const Spring& spring : body.springs) {
      const Vec3 d = positions[spring.b] - positions[spring.a];
      const double length = norm(d);
      if (length != 0) {
        add(body, spring, {d.x / length, d.y / length, d.z / length}, damped);
        continue;
      }
      // a spring without a direction is treated as resisting in every direction: an upper bound for any direction
      for (int axis = 0; axis < 3; ++axis) add(body, spring, Eigen::Vector3d::Unit(axis), damped);
    }
  }

  Eigen::Index size() const { return size_; }

  const StiffnessMatrix& with(Resistance resistance) {
    resistance_.resize(links_.size());
    for (std::size_t i = 0; i < links_.size(); ++i)
      resistance_[i] = resistance.of_length * stiffness_[i] + resistance.of_rate * damping_[i];
    return *this;
  }

  /// A v
  Eigen::VectorXd times(const Eigen::VectorXd& v) const {
    const Eigen::VectorXd weighted = with_weights(v);
    Eigen::VectorXd forces = Eigen::VectorXd::Zero(size_);
    for (std::size_t i = 0; i < links_.size(); ++i) {
      const Link& link = links_[i];
      const Eigen::Vector3d difference = weighted.segment<3>(link.b) - weighted.segment<3>(link.a);
      const Eigen::Vector3d force = resistance_[i] * link.direction.dot(difference) * link.direction;
      forces.segment<3>(link.a) -= force;
      forces.segment<3>(link.b) += force;
    }
    return with_weights(forces);
  }

 private:
  struct Link {
    std::uint32_t a, b;  ///< index of the first coordinate of the masses
    Eigen::Vector3d direction;
  };

  void add(const Body& body, const Spring& spring, const Eigen::Vector3d& direction, bool damped) {
    links_.push_back({3 * spring.a, 3 * spring.b, direction});
    stiffness_.push_back(body.stiffness(spring));
    damping_.push_back(damped ? body.damping(spring) : 0);
  }

  Eigen::VectorXd with_weights(const Eigen::VectorXd& v) const {
    Eigen::VectorXd result(size_);
    for (std::size_t i = 0; i < weight_.size(); ++i) {
      const auto at = 3 * static_cast<Eigen::Index>(i);
      result.segment<3>(at) = weight_[i] * v.segment<3>(at);
    }
    return result;
  }

  Eigen::Index size_;
  std::vector<double> weight_;  ///< of each mass, 1/sqrt(kg); 0 for a fixed mass
  std::vector<Link> links_;
  std::vector<double> stiffness_, damping_, resistance_;  ///< of each link; N/m, N s/m, N/m
};

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

  /// The largest eigenvalue, and its eigenvector. The eigenvector's last component times the next off-diagonal element
  /// is the residual in the full matrix.
  std::pair<double, Eigen::VectorXd> largest() const {
    const auto size = static_cast<Eigen::Index>(diagonal_.size());
    const Eigen::Map<const Eigen::VectorXd> d(diagonal_.data(), size), o(off_diagonal_.data() + 1, size - 1);
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
    solver.computeFromTridiagonal(d, o);
    return {solver.eigenvalues()[size - 1], solver.eigenvectors().col(size - 1)};
  }

 private:
  std::vector<double> diagonal_, off_diagonal_;  // the first off-diagonal element is outside the matrix
};

struct Eigenpair {
  double value;            ///< 1/s^2
  Eigen::VectorXd vector;  ///< of unit length
};

/// The largest eigenvalue of `matrix` with its eigenvector, by the Lanczos iteration; if the eigenvalue is above
/// `enough`, some number between `enough` and the eigenvalue. The estimates rise towards the eigenvalue. The iteration
/// ends when the residual is below 1 % of the estimate (after about 15 iterations for a body of a thousand masses) or
/// after 60 iterations; a margin of 2 %, which is 1 % in frequency, covers the remaining error.
Eigenpair largest_eigenpair(const StiffnessMatrix& matrix, double enough) {
  constexpr int iterations = 60, between_looks = 3;
  constexpr double margin = 1.02, residual = 0.01;
  Tridiagonal small;
  std::vector<Eigen::VectorXd> basis;
  Eigen::VectorXd v = scattered(matrix.size());
  std::pair<double, Eigen::VectorXd> estimate;
  double beta = 0;
  for (int i = 1; i <= iterations && i <= matrix.size(); ++i) {
    Eigen::VectorXd next = matrix.times(v);
    if (i > 1) next -= beta * basis.back();
    const double diagonal = next.dot(v);
    small.add_row(diagonal, beta);
    next -= diagonal * v;
    basis.push_back(std::move(v));
    const double bound = std::max(std::abs(diagonal), beta);
    beta = next.norm();
    const bool exhausted = beta <= 1e-12 * bound;
    if (exhausted || i % between_looks == 0 || i == iterations || i == matrix.size()) {
      estimate = small.largest();
      const double last = std::abs(estimate.second[i - 1]);
      if (exhausted || estimate.first > enough || beta * last <= residual * estimate.first) break;
    }
    v = next / beta;
  }
  Eigen::VectorXd vector = Eigen::VectorXd::Zero(matrix.size());
  for (std::size_t i = 0; i < basis.size(); ++i) vector += estimate.second[static_cast<Eigen::Index>(i)] * basis[i];
  return {margin * estimate.first, std::move(vector)};
}

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The highest frequency among the springs that are muscles, Hz; 0 if there is none.
double fastest_muscle(const Body& body) {
  const auto frequency = [](const Material& material) {
    return material.amplitude != 0 ? std::abs(material.frequency) : 0;
  };
  // a look at the few materials shows that most of the many springs need no look
  double limit = 0, fastest = 0;
  for (const Material& material : body.materials) limit = std::max(limit, frequency(material));
  for (auto spring = body.springs.begin(); spring != body.springs.end() && fastest < limit; ++spring)
    fastest = std::max(fastest, frequency(body.materials[spring->material]));
  return fastest;
}

/// The rate of uniform damping that acts as a force, 1/s; the other methods damp exactly.
double uniform_damping(const Scene& scene, Method method) {
  return method == Method::rk4 && scene.damping ? scene.damping->rate : 0;
}

/// A method is stable at a step dt if dt^2 lambda <= oscillation (oscillation - damped), with the largest eigenvalue
/// lambda of K + (rate/dt) C for the stiffness matrix K and the damping matrix C. For one oscillation of the angular
/// frequency w and the damping ratio z, without uniform damping, this is dt w <= oscillation (sqrt(1 + y^2) - y) with y
/// = z rate/oscillation.
struct Limit {
  double oscillation, rate, damped = 0;
  bool has_dashpots;

  /// `uniform` is the product of dt and uniform_damping(), 1.
  Limit(Method method, bool has_dashpots_, double uniform = 0)
      : oscillation(oscillation_limit(method)), rate(oscillation), has_dashpots(has_dashpots_) {
    // dashpots act at predicted velocities
    if (method == Method::velocity_verlet) rate = 2 * oscillation;
    // The largest half disc in rk4's region of stability has the radius 2.58. Uniform damping alone leaves the limit of
    // undamped oscillations as it is up to a rate of 1.7/dt.
    if (method == Method::rk4 && (has_dashpots || uniform > 1.5)) oscillation = rate = 2.58;
    // the rates of dashpots and of uniform damping add up; without dashpots, each has the whole half disc
    if (has_dashpots || uniform > oscillation) damped = uniform;
  }

  /// The largest eigenvalue lambda at a step dt, 1/s^2.
  double eigenvalue(double dt) const { return oscillation * (oscillation - damped) / (dt * dt); }
  Resistance at(double dt) const { return {1, has_dashpots ? rate / dt : 0}; }

  /// The largest dt for bounds of the eigenvalues of K and of C.
  double dt(double stiffness, double damping) const {
    const double half = rate * damping / 2;
    return oscillation * oscillation / (half + std::sqrt(half * half + stiffness * oscillation * oscillation));
  }
};

/// The largest stable dt of a body with dashpots, s.
///
/// With f(dt) = dt^2 lambda, a dt is stable if f(dt) <= oscillation^2. Because K and C have no negative eigenvalues,
/// f(s dt) <= s f(dt) if s < 1, and f(s dt) <= s^2 f(dt) if s > 1. So lambda at any dt leads to a dt that is safe, and
/// the nearer the first one was to the limit, the nearer is the second. On the other side, the eigenvector x of one dt
/// is a bound for all: no dt is stable for which dt^2 x^T (K + (rate/dt) C) x is above oscillation^2.
double largest_damped_dt(const Body& body, std::span<const Vec3> positions, const Limit& limit) {
  constexpr int looks = 10;
  constexpr double near_enough = 0.96;  // with the 1 % of the margin, 5 % below the true limit
  double dt = limit.dt(StiffnessBounds(body, positions, {1, 0}).of_blocks(),
                       StiffnessBounds(body, positions, {0, 1}).of_blocks());
  StiffnessMatrix matrix(body, positions);
  for (int i = 0; i < looks; ++i) {
    const auto [eigenvalue, vector] = largest_eigenpair(matrix.with(limit.at(dt)), infinity);
    const double damping = vector.dot(matrix.with({0, 1}).times(vector));
    const double most = limit.dt(std::max(0.0, eigenvalue - limit.rate / dt * damping), damping);
    const double reach = limit.eigenvalue(dt) / eigenvalue;
    dt *= reach < 1 ? reach : std::sqrt(reach);
    if (!(dt < near_enough * most)) break;
  }
  return dt;
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
  if (!is_explicit(method) || !scene.floor || scene.floor->rigid() || scene.floor->stiffness <= 0) return infinity;
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
  const double stiffness = 2 * material.stiffness / mass;
  return Limit(method, material.damping != 0).dt(stiffness, 2 * material.damping * std::sqrt(stiffness));
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
  const bool damped = is_damped(body);
  const Limit limit(method, damped);
  const StiffnessBounds bounds(body, positions, limit.at(wanted));
  if (wanted * std::sqrt(bounds.of_discs()) <= limit.oscillation) return wanted;
  const double bound = bounds.of_blocks();
  if (bound == 0 || wanted * std::sqrt(bound) <= limit.oscillation) return wanted;
  const auto undamped = [&] {
    StiffnessMatrix matrix(body, positions);
    return limit.oscillation / std::sqrt(largest_eigenpair(matrix.with({}), infinity).value);
  };
  const double largest = damped ? largest_damped_dt(body, positions, limit) : undamped();
  return largest >= wanted ? wanted : largest;  // NaN stays NaN
}

double safe_dt(const Body& body, std::span<const Vec3> positions, const Scene& scene, Method method) {
  constexpr double longest = 0.01, steps_of_a_stroke = 20;
  double other = std::min(longest, largest_contact_dt(scene, body, method));
  if (const double frequency = fastest_muscle(body); frequency > 0)
    other = std::min(other, 1 / (steps_of_a_stroke * frequency));
  const double rate = uniform_damping(scene, method);
  if (rate > 0) other = std::min(other, 2 / rate);
  const double wanted = other / spring_margin;
  double springs = largest_dt(body, positions, method, wanted);
  if (rate > 0 && is_damped(body)) springs = 1 / (1 / springs + rate / Limit(method, true).rate);  // the rates add up
  return springs == wanted ? other : spring_margin * springs;
}

bool is_stable(const Body& body, std::span<const Vec3> positions, const Scene& scene, Method method, double dt) {
  if (!is_explicit(method)) return true;
  const Limit of_method(method, is_damped(body), uniform_damping(scene, method) * dt);
  const double limit = of_method.eigenvalue(dt);
  const Resistance resistance = of_method.at(dt);
  const StiffnessBounds bounds(body, positions, resistance);
  if (bounds.of_discs() <= limit || bounds.blocks_are_below(limit)) return true;
  StiffnessMatrix matrix(body, positions);
  return largest_eigenpair(matrix.with(resistance), limit).value <= limit;
}

}  // namespace evodevo
