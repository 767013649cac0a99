#include "analysis/stability.hpp"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace evodevo {
namespace {

bool is_damped(const Body& body) {
  // a look at the few materials saves one at the many springs
  const auto damps = [](const Material& material) { return material.damping != 0; };
  return std::ranges::any_of(body.materials, damps) &&
         std::any_of(body.springs.begin(), body.springs.end(),
                     [&](const Spring& spring) { return body.materials[spring.material].damping != 0; });
}

/// Whether every spring is damped enough for the longest steps.
bool is_damped_everywhere(const Body& body) {
  return std::ranges::all_of(body.springs, [&](const Spring& spring) {
    const Material& material = body.materials[spring.material];
    return material.damping >= least_damping || material.stiffness == 0;
  });
}

/// What springs resist with: their stiffness, the coefficient of their dashpot, or a sum of both.
struct Resistance {
  double of_length = 1;  ///< factor of the stiffness k, N/m
  double of_rate = 0;    ///< factor of the dashpot's coefficient c, N s/m

  double operator()(const Body& body, const Spring& spring) const {
    return of_length * body.stiffness(spring) + (of_rate != 0 ? of_rate * body.damping(spring) : 0);
  }
};

/// An upper bound of the largest eigenvalue of the mass-weighted stiffness matrix of a body in any shape, by Gershgorin
/// discs on blocks of one mass: the largest (2 sum(k) + held)/m, 1/s^2. `held` (N/m) resists the motion of each mass.
/// NaN if one of them is.
double disc_bound(const Body& body, Resistance resistance, double held) {
  std::vector<double> sum(body.masses.size(), held);
  for (const Spring& spring : body.springs) {
    const double k = resistance(body, spring);
    sum[spring.a] += 2 * k;
    sum[spring.b] += 2 * k;
  }
  double largest = 0;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const double disc = body.masses[i].mass > 0 ? sum[i] / body.masses[i].mass : 0;
    if (disc > largest || std::isnan(disc)) largest = disc;
  }
  return largest;
}

/// The mass-weighted matrix A = M^-1/2 K M^-1/2 of a body; K is the sum of k e e^T over the springs, with k the
/// resistance and e the direction of a spring. If k is the stiffness, the eigenvalues are the squares of the body's
/// angular frequencies, 1/s^2. The resistance can be changed, since directions take longest to compute.
///
/// A direction has D components: 3 in space, or 1, which is 1, for springs that resist in every direction alike. Then
/// the matrix of each axis is the same, and this is that of one axis.
template <int D>
class StiffnessMatrix {
 public:
  using Direction = Eigen::Vector<double, D>;

  explicit StiffnessMatrix(const Body& body)
      : size_(D * static_cast<Eigen::Index>(body.masses.size())), damped_(is_damped(body)) {
    for (const Mass& mass : body.masses) weight_.push_back(mass.mass > 0 ? 1 / std::sqrt(mass.mass) : 0);
  }

  void add(const Body& body, const Spring& spring, const Direction& direction) {
    links_.push_back({D * spring.a, D * spring.b, direction});
    stiffness_.push_back(body.stiffness(spring));
    damping_.push_back(damped_ ? body.damping(spring) : 0);
  }

  /// Lets every mass be held by a spring of this stiffness (N/m) in every direction.
  void hold(double stiffness) { held_ = stiffness; }

  Eigen::Index size() const { return size_; }

  const StiffnessMatrix& with(Resistance resistance) {
    resistance_.resize(links_.size());
    for (std::size_t i = 0; i < links_.size(); ++i)
      resistance_[i] = resistance.of_length * stiffness_[i] + resistance.of_rate * damping_[i];
    hold_ = resistance.of_length * held_;
    return *this;
  }

  /// A v
  Eigen::VectorXd times(const Eigen::VectorXd& v) const {
    const Eigen::VectorXd weighted = with_weights(v);
    Eigen::VectorXd forces = hold_ * weighted;
    for (std::size_t i = 0; i < links_.size(); ++i) {
      const Link& link = links_[i];
      const Direction difference = weighted.segment<D>(link.b) - weighted.segment<D>(link.a);
      const Direction force = resistance_[i] * link.direction.dot(difference) * link.direction;
      forces.segment<D>(link.a) -= force;
      forces.segment<D>(link.b) += force;
    }
    return with_weights(forces);
  }

 private:
  struct Link {
    std::uint32_t a, b;  ///< index of the first coordinate of the masses
    Direction direction;
  };

  Eigen::VectorXd with_weights(const Eigen::VectorXd& v) const {
    Eigen::VectorXd result(size_);
    for (std::size_t i = 0; i < weight_.size(); ++i) {
      const auto at = D * static_cast<Eigen::Index>(i);
      result.segment<D>(at) = weight_[i] * v.segment<D>(at);
    }
    return result;
  }

  Eigen::Index size_;
  bool damped_;
  std::vector<double> weight_;  ///< of each mass, 1/sqrt(kg); 0 for a fixed mass
  std::vector<Link> links_;
  std::vector<double> stiffness_, damping_, resistance_;  ///< of each link; N/m, N s/m, N/m
  double held_ = 0, hold_ = 0;                            ///< N/m
};

/// The matrix of a body in the shape that `positions` (m) give it. A spring without a direction is treated as resisting
/// in every direction: an upper bound for any direction.
StiffnessMatrix<3> matrix_in_shape(const Body& body, std::span<const Vec3> positions) {
  StiffnessMatrix<3> matrix(body);
  for (const Spring& spring : body.springs) {
    const Vec3 d = positions[spring.b] - positions[spring.a];
    const double length = norm(d);
    if (length != 0)
      matrix.add(body, spring, {d.x / length, d.y / length, d.z / length});
    else
      for (int axis = 0; axis < 3; ++axis) matrix.add(body, spring, Eigen::Vector3d::Unit(axis));
  }
  return matrix;
}

/// An upper bound of the matrices of a body in all shapes, with springs under any tension: a spring of stiffness k and
/// length L resists by k along its direction, and by k (1 - L/|d|) < k across. All masses touch a floor of the
/// stiffness `floor` (N/m).
StiffnessMatrix<1> matrix_in_any_shape(const Body& body, double floor) {
  StiffnessMatrix<1> matrix(body);
  for (const Spring& spring : body.springs) matrix.add(body, spring, StiffnessMatrix<1>::Direction::Ones());
  matrix.hold(floor);
  return matrix;
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
template <int D>
Eigenpair largest_eigenpair(const StiffnessMatrix<D>& matrix, double enough) {
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

/// The largest stable dt of a body with dashpots, s. `dt` is one that is known to be stable, s.
///
/// With f(dt) = dt^2 lambda, a dt is stable if f(dt) <= oscillation^2. Because K and C have no negative eigenvalues,
/// f(s dt) <= s f(dt) if s < 1, and f(s dt) <= s^2 f(dt) if s > 1. So lambda at any dt leads to a dt that is safe, and
/// the nearer the first one was to the limit, the nearer is the second. On the other side, the eigenvector x of one dt
/// is a bound for all: no dt is stable for which dt^2 x^T (K + (rate/dt) C) x is above oscillation^2.
template <int D>
double largest_damped_dt(StiffnessMatrix<D> matrix, const Limit& limit, double dt) {
  constexpr int looks = 10;
  constexpr double near_enough = 0.96;  // with the 1 % of the margin, 5 % below the true limit
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

/// The largest stable dt (s) of a body with this matrix. `known` is a stable dt (s), which a body with dashpots needs.
template <int D>
double largest_dt_of(StiffnessMatrix<D> matrix, const Limit& limit, double known) {
  if (limit.has_dashpots) return largest_damped_dt(std::move(matrix), limit, known);
  return limit.oscillation / std::sqrt(largest_eigenpair(matrix.with({}), infinity).value);
}

/// The smaller one; NaN if one of them is.
double at_most(double wanted, double largest) { return largest < wanted || std::isnan(largest) ? largest : wanted; }

/// The stiffness (N/m) with which the floor resists the motion of a mass in any direction; 0 if it is rigid.
double contact_stiffness(const Scene& scene) {
  if (!scene.floor || scene.floor->rigid()) return 0;
  // rough ground has horizontal force components too
  return scene.floor->stiffness * (1 + std::pow(scene.floor->steepest(), 2));
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
  const double stiffness = contact_stiffness(scene);
  return is_explicit(method) && stiffness > 0 ? 1.2 * std::sqrt(mass / stiffness) : infinity;
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

double largest_dt(const Body& body, std::span<const Vec3> positions, Method method) {
  const Limit limit(method, is_damped(body));
  const double stiffest = disc_bound(body, {1, 0}, 0);
  if (!is_explicit(method) || stiffest == 0) return infinity;
  return largest_dt_of(matrix_in_shape(body, positions), limit, limit.dt(stiffest, disc_bound(body, {0, 1}, 0)));
}

double largest_dt_in_any_shape(const Body& body, const Scene& scene, Method method, double wanted) {
  const Limit limit(method, is_damped(body));
  const double floor = contact_stiffness(scene);
  if (wanted * std::sqrt(disc_bound(body, limit.at(wanted), floor)) <= limit.oscillation) return wanted;
  const double known = limit.dt(disc_bound(body, {1, 0}, floor), disc_bound(body, {0, 1}, 0));
  return at_most(wanted, largest_dt_of(matrix_in_any_shape(body, floor), limit, known));
}

double safe_dt(const Body& body, const Scene& scene, Method method) {
  constexpr double longest = 0.01, steps_of_a_stroke = 20;
  double dt = std::min(longest, largest_contact_dt(scene, body, method));
  if (const double frequency = fastest_muscle(body); frequency > 0)
    dt = std::min(dt, 1 / (steps_of_a_stroke * frequency));
  const double rate = uniform_damping(scene, method);
  if (rate > 0) dt = std::min(dt, 2 / rate);
  if (!is_explicit(method)) return dt;
  const Limit limit(method, is_damped(body));
  const double margin = method == Method::rk4 || is_damped_everywhere(body) ? spring_margin : undamped_margin;
  const double wanted = dt / margin;
  double springs = largest_dt_in_any_shape(body, scene, method, wanted);
  if (limit.has_dashpots && rate > 0) springs = 1 / (1 / springs + rate / limit.rate);  // the rates add up
  return springs == wanted ? dt : margin * springs;
}

bool is_stable(const Body& body, const Scene& scene, Method method, double dt) {
  if (!is_explicit(method)) return true;
  const Limit limit(method, is_damped(body), uniform_damping(scene, method) * dt);
  const double largest = limit.eigenvalue(dt), floor = contact_stiffness(scene);
  const Resistance resistance = limit.at(dt);
  return disc_bound(body, resistance, floor) <= largest ||
         largest_eigenpair(matrix_in_any_shape(body, floor).with(resistance), largest).value <= largest;
}

}  // namespace evodevo
