// The evolution strategy with covariance matrix adaptation (CMA-ES: Hansen and Ostermeier 2001), as Hansen's tutorial
// defines it (arXiv 1604.00772v2). Needs Eigen 3.4.
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "evodevo/rng.hpp"

namespace evodevo {

/// The default settings for `children` points in n dimensions (tutorial, Table 1). The weights are those of the points
/// from best to worst; they are negative for the worse half (active CMA-ES).
struct CmaSettings {
  CmaSettings(std::size_t children, double n) {
    const std::size_t parents = children / 2;
    double sum[2] = {}, squares[2] = {};  // of the weights of parents, and of the others
    for (std::size_t i = 0; i < children; ++i) {
      const double weight = std::log((static_cast<double>(children) + 1) / 2) - std::log(static_cast<double>(i) + 1);
      weights.push_back(weight);
      sum[i >= parents] += weight;
      squares[i >= parents] += weight * weight;
    }
    effective = sum[0] * sum[0] / squares[0];
    const double others = squares[1] > 0 ? sum[1] * sum[1] / squares[1] : 0;
    step_rate = (effective + 2) / (n + effective + 5);
    damping = 1 + 2 * std::max(0.0, std::sqrt((effective - 1) / (n + 1)) - 1) + step_rate;
    path_rate = (4 + effective / n) / (n + 4 + 2 * effective / n);
    rank_one = 2 / ((n + 1.3) * (n + 1.3) + effective);
    rank_mu = std::min(1 - rank_one, 2 * (0.25 + effective + 1 / effective - 2) / ((n + 2) * (n + 2) + effective));
    const double negative =
        std::min({1 + rank_one / rank_mu, 1 + 2 * others / (effective + 2), (1 - rank_one - rank_mu) / (n * rank_mu)});
    for (double& weight : weights) weight *= weight >= 0 ? 1 / sum[0] : negative / -sum[1];
  }

  /// Gives points with equal ranks, which follow each other, the mean of their weights. The positive weights sum to 1
  /// afterwards, and `effective` is adapted to them; it is 0 if there are none.
  void share(const std::vector<std::uint32_t>& ranks) {
    double sum = 0, squares = 0;
    for (std::size_t first = 0, last = 0; first < weights.size(); first = last) {
      double group = 0;
      for (last = first; last < weights.size() && ranks[last] == ranks[first]; ++last) group += weights[last];
      const double mean = group / static_cast<double>(last - first), better = std::max(group, 0.0);
      for (std::size_t i = first; i < last; ++i) weights[i] = mean;
      sum += better;
      squares += better * mean;
    }
    for (double& weight : weights)
      if (weight > 0) weight /= sum;
    effective = sum > 0 ? sum * sum / squares : 0;
  }

  std::vector<double> weights;
  double effective;  ///< number of parents if all had the same weight; adapted by share()
  double step_rate, damping, path_rate, rank_one, rank_mu;
};

/// A normal distribution that learns from the points that were drawn from it. All points lie in the unit cube: a
/// coordinate that is drawn outside is reflected at its bounds. The distribution learns from one of the images that may
/// have been reflected, drawn by how likely they are; if it took the reflected points themselves, it would shrink too
/// early wherever the best points lie on bounds.
///
/// It may also learn from points that were not drawn from it. A step to a point that is so far away that it could not
/// have been drawn is shortened, and the step size grows at most by a factor of e in an update (Hansen 2011: injecting
/// external solutions into CMA-ES).
class CmaEs {
 public:
  /// Starts in the middle of the cube with the given step size in each dimension.
  CmaEs(std::size_t dimension, double step)
      : step_(step),
        mean_(Vector::Constant(static_cast<Eigen::Index>(dimension), 0.5)),
        step_path_(Vector::Zero(mean_.size())),
        path_(Vector::Zero(mean_.size())),
        covariance_(Matrix::Identity(mean_.size(), mean_.size())) {}

  /// Continues from what state() has returned. Throws std::runtime_error if it has another dimension.
  CmaEs(std::size_t dimension, std::span<const double> state) : CmaEs(dimension, 1) {
    if (state.size() != (dimension + 1) * (dimension + 2))
      throw std::runtime_error("the memory has " + std::to_string(state.size()) + " numbers; expected " +
                               std::to_string((dimension + 1) * (dimension + 2)) + " for " + std::to_string(dimension) +
                               " genes");
    updates_ = state[0];
    step_ = state[1];
    const double* next = state.data() + 2;
    for (Vector* vector : {&mean_, &step_path_, &path_}) {
      std::copy_n(next, dimension, vector->data());
      next += dimension;
    }
    std::copy_n(next, dimension * dimension, covariance_.data());
  }

  /// Returns everything that the distribution has learned: (n + 1)(n + 2) numbers in n dimensions.
  std::vector<double> state() const {
    std::vector<double> numbers{updates_, step_};
    for (const Vector* vector : {&mean_, &step_path_, &path_})
      numbers.insert(numbers.end(), vector->begin(), vector->end());
    numbers.insert(numbers.end(), covariance_.data(), covariance_.data() + covariance_.size());
    return numbers;
  }

  /// Draws points from the distribution.
  std::vector<std::vector<double>> sample(std::size_t count, Rng& rng) const {
    const Axes axes(covariance_);
    std::vector<std::vector<double>> points;
    for (std::size_t i = 0; i < count; ++i) {
      Vector normal(mean_.size());
      for (double& coordinate : normal) coordinate = rng.normal();
      const Vector point = mean_ + step_ * axes.directions.lazyProduct(axes.lengths.cwiseProduct(normal));
      std::vector<double>& drawn = points.emplace_back();
      for (const double coordinate : point) drawn.push_back(reflected(coordinate));
    }
    return points;
  }

  /// Learns from points, of which the best comes first. Points with equal ranks, which must follow each other, are
  /// equally good, and share their weights. Nothing is learned from fewer than two points, or if all points, or nearly
  /// all with the best one among them, are equally good.
  void update(const std::vector<std::vector<double>>& points, const std::vector<std::uint32_t>& ranks, Rng& rng) {
    if (points.size() < 2) return;
    const auto n = static_cast<double>(mean_.size());
    CmaSettings s(points.size(), n);
    s.share(ranks);
    if (ranks.front() == ranks.back() || s.effective == 0) return;
    const Axes axes(covariance_);
    Matrix steps = unreflected_steps(points, rng);
    shorten(steps, axes);
    Vector mean_step = Vector::Zero(mean_.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      mean_step += std::max(s.weights[i], 0.0) * steps.col(static_cast<Eigen::Index>(i));

    mean_ += step_ * mean_step;
    step_path_ = (1 - s.step_rate) * step_path_ +
                 std::sqrt(s.step_rate * (2 - s.step_rate) * s.effective) * axes.whitened(mean_step);
    const double expected = std::sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n * n));  // length of a normal vector
    const double length = step_path_.norm() / expected;
    const double settled = std::sqrt(1 - std::pow(1 - s.step_rate, 2 * (updates_ + 1)));
    const bool moves_on = length / settled < 1.4 + 2 / (n + 1);  // else the step size is far too small
    path_ = (1 - s.path_rate) * path_ +
            (moves_on ? std::sqrt(s.path_rate * (2 - s.path_rate) * s.effective) : 0) * mean_step;

    double kept = 1 - s.rank_one * (moves_on ? 1 : 1 - s.path_rate * (2 - s.path_rate));
    for (const double weight : s.weights) kept -= s.rank_mu * weight;
    covariance_ = kept * covariance_ + s.rank_one * path_ * path_.transpose();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto step = steps.col(static_cast<Eigen::Index>(i));
      const double squared = s.weights[i] < 0 ? axes.whitened(step).squaredNorm() : n;
      if (squared > 0) covariance_ += s.rank_mu * s.weights[i] * n / squared * step * step.transpose();
    }
    step_ *= std::exp(std::min(1.0, s.step_rate / s.damping * (length - 1)));
    stay_near_the_cube();
    normalise();
    ++updates_;
  }

  /// The middle of the distribution.
  std::vector<double> mean() const { return {mean_.begin(), mean_.end()}; }

 private:
  using Vector = Eigen::VectorXd;
  using Matrix = Eigen::MatrixXd;

  /// The main axes of a covariance matrix.
  struct Axes {
    explicit Axes(const Matrix& covariance) {
      // Eigen cuts large products according to the sizes of the caches; with fixed sizes, they have the same bits on
      // all machines
      static const bool fixed = (Eigen::setCpuCacheSizes(32 << 10, 256 << 10, 2 << 20), true);
      (void)fixed;
      const Eigen::SelfAdjointEigenSolver<Matrix> solver(covariance);
      const double least = 1e-14 * solver.eigenvalues().maxCoeff();  // rounding may leave negative eigenvalues
      directions = solver.eigenvectors();
      lengths = solver.eigenvalues().cwiseMax(least).cwiseSqrt();
    }
    /// Returns a vector that has a standard normal distribution if `vector` has this covariance.
    Vector whitened(const Vector& vector) const {
      return directions.lazyProduct(directions.transpose().lazyProduct(vector).cwiseQuotient(lengths));
    }

    Matrix directions;  ///< as columns
    Vector lengths;     ///< standard deviations along them
  };

  static double reflected(double coordinate) {
    const double folded = std::fmod(std::abs(coordinate), 2.0);
    return folded > 1 ? 2 - folded : folded;
  }

  double deviation(Eigen::Index axis) const { return step_ * std::sqrt(covariance_(axis, axis)); }

  /// Returns the steps from the mean to the points, as columns, in units of the step size.
  Matrix unreflected_steps(const std::vector<std::vector<double>>& points, Rng& rng) const {
    Matrix steps(mean_.size(), static_cast<Eigen::Index>(points.size()));
    for (Eigen::Index i = 0; i < steps.cols(); ++i)
      for (Eigen::Index axis = 0; axis < steps.rows(); ++axis)
        steps(axis, i) =
            (image(points[static_cast<std::size_t>(i)][static_cast<std::size_t>(axis)], axis, rng) - mean_[axis]) /
            step_;
    return steps;
  }

  /// Shortens steps that no drawn point makes: hardly any standard normal vector is that long.
  static void shorten(Matrix& steps, const Axes& axes) {
    const double longest = std::sqrt(static_cast<double>(steps.rows())) + 5;
    for (Eigen::Index i = 0; i < steps.cols(); ++i)
      if (const double length = axes.whitened(steps.col(i)).norm(); length > longest) steps.col(i) *= longest / length;
  }

  /// Draws one of the images of a coordinate, with the chances that the distribution along this axis gives them. Other
  /// images are too far away, since the mean lies in the cube and the standard deviation is limited.
  double image(double coordinate, Eigen::Index axis, Rng& rng) const {
    const double images[] = {coordinate, -coordinate, 2 - coordinate};
    double weights[3], sum = 0;
    const double unit = std::max(deviation(axis), 1e-150);
    for (int i = 0; i < 3; ++i) {  // relative to the first one, which is the most likely
      const double distance = (images[i] - mean_[axis]) / unit, least = (coordinate - mean_[axis]) / unit;
      sum += weights[i] = std::exp((least * least - distance * distance) / 2);
    }
    double drawn = rng.uniform() * sum;
    int i = 0;
    for (; i < 2 && drawn >= weights[i]; ++i) drawn -= weights[i];
    return images[i];
  }

  /// Replaces the distribution by its image whose mean lies in the cube. Along each axis, limits the standard deviation
  /// to a third of the cube, as Hansen's pycma does: images of a wider one would overlap.
  void stay_near_the_cube() {
    for (Eigen::Index axis = 0; axis < mean_.size(); ++axis) {
      double factor = std::min(1.0, 1.0 / 3 / deviation(axis));
      if (const double mean = reflected(mean_[axis]); mean != mean_[axis]) {
        mean_[axis] = mean;
        step_path_[axis] *= -1;
        factor *= -1;
      }
      path_[axis] *= factor;
      covariance_.row(axis) *= factor;
      covariance_.col(axis) *= factor;
    }
  }

  /// Moves a common factor of the covariances into the step size, so that neither can become too large or too small for
  /// a double.
  void normalise() {
    const double largest = covariance_.diagonal().maxCoeff();
    covariance_ /= largest;
    path_ /= std::sqrt(largest);
    step_ = std::max(step_ * std::sqrt(largest), 1e-15);  // smaller steps are lost when they are added to the mean
  }

  double updates_ = 0;  ///< number of updates so far
  double step_;
  Vector mean_, step_path_, path_;
  Matrix covariance_;
};

}  // namespace evodevo
