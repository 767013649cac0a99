// CMA-ES compared with the equations of Hansen's tutorial (arXiv 1604.00772v2).
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "evodevo/helpers/selection/cma_es.hpp"
#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// CMA-ES in one dimension, where all vectors and matrices are numbers, with the tutorial's symbols.
class InOneDimension {
 public:
  explicit InOneDimension(double step) : sigma_(step) {
    for (int i = 0; i < children; ++i) weights_[i] = std::log((children + 1) / 2.0) - std::log(i + 1.0);
    double sum[2] = {}, squares[2] = {};  // of the better and of the worse half
    for (int i = 0; i < children; ++i) {
      sum[i >= 3] += weights_[i];
      squares[i >= 3] += weights_[i] * weights_[i];
    }
    mu_eff_ = sum[0] * sum[0] / squares[0];
    c_sigma_ = (mu_eff_ + 2) / (1 + mu_eff_ + 5);  // d_sigma is 1 + c_sigma for so few children
    c_c_ = (4 + mu_eff_) / (1 + 4 + 2 * mu_eff_);
    c_1_ = 2 / (2.3 * 2.3 + mu_eff_);
    c_mu_ = 2 * (0.25 + mu_eff_ + 1 / mu_eff_ - 2) / (9 + mu_eff_);
    // alpha_mu_eff, which is the least bound of the negative weights here
    const double negative = 1 + 2 * (sum[1] * sum[1] / squares[1]) / (mu_eff_ + 2);
    for (int i = 0; i < children; ++i) weights_[i] *= i < 3 ? 1 / sum[0] : -negative / sum[1];
  }

  double deviation() const { return sigma_ * std::sqrt(c_); }

  /// Learns from points that lie so many standard deviations from the mean; returns h_sigma.
  bool update(const std::array<double, 6>& normals) {
    std::array<double, 6> y = normals;
    double y_w = 0, sum = 0, rank_mu = 0;
    for (double& one : y) one *= std::sqrt(c_);
    for (int i = 0; i < 3; ++i) y_w += weights_[i] * y[i];
    for (int i = 0; i < children; ++i) {
      sum += weights_[i];
      rank_mu += weights_[i] * (i < 3 ? y[i] * y[i] : c_);  // a worse point counts by its direction alone
    }
    mean += sigma_ * y_w;
    p_sigma_ = (1 - c_sigma_) * p_sigma_ + std::sqrt(c_sigma_ * (2 - c_sigma_) * mu_eff_) * y_w / std::sqrt(c_);
    const double expected = 1 - 1 / 4.0 + 1 / 21.0;
    const bool h = std::abs(p_sigma_) / std::sqrt(1 - std::pow(1 - c_sigma_, 2 * (g_ + 1))) < 2.4 * expected;
    p_c_ = (1 - c_c_) * p_c_ + h * std::sqrt(c_c_ * (2 - c_c_) * mu_eff_) * y_w;
    c_ = (1 + c_1_ * !h * c_c_ * (2 - c_c_) - c_1_ - c_mu_ * sum) * c_ + c_1_ * p_c_ * p_c_ + c_mu_ * rank_mu;
    sigma_ *= std::exp(c_sigma_ / (1 + c_sigma_) * (std::abs(p_sigma_) / expected - 1));
    ++g_;
    return h;
  }

  double mean = 0.5;

 private:
  static constexpr int children = 6;
  double weights_[children], mu_eff_, c_sigma_, c_c_, c_1_, c_mu_;
  double sigma_, c_ = 1, p_sigma_ = 0, p_c_ = 0;
  int g_ = 0;
};

/// The tutorial's summary of CMA-ES, with the settings of its Table 1.
TEST(CmaEs, InOneDimensionDoesWhatTheTutorialSays) {
  constexpr double step = 1e-6;  // far from the bounds, so that the images of points are those drawn
  InOneDimension expected(step);
  CmaEs strategy(1, step);
  Rng rng = stream(1);
  int moved_on = 0, updates = 0;
  for (const double middle : {0.2, 1.4, 1.4, -0.3, -0.5, 0.1, 1.0, 1.2, -1.5, -1.4, 0.0, 0.4}) {
    const std::array normals{middle + 0.1, middle - 0.3, middle + 0.5, middle - 0.9, middle + 1.1, middle - 1.6};
    std::vector<std::vector<double>> points;
    for (const double normal : normals) points.push_back({expected.mean + expected.deviation() * normal});
    moved_on += expected.update(normals);
    strategy.update(points, {0, 1, 2, 3, 4, 5}, rng);
    const auto state = strategy.state();
    const double deviation = state[1] * std::sqrt(state[5]);
    EXPECT_NEAR(deviation / expected.deviation(), 1, 1e-6) << "update " << updates;
    EXPECT_NEAR((strategy.mean()[0] - expected.mean) / deviation, 0, 1e-6) << "update " << updates;
    ++updates;
  }
  EXPECT_GT(moved_on, 2);
  EXPECT_LT(moved_on, updates - 1);
}

/// Tutorial, equation 53: with the default settings, the weights of the better half sum to 1, and the greatest is the
/// first.
TEST(CmaSettings, FulfilWhatTheTutorialSaysOfThem) {
  for (const std::size_t children : {2, 3, 7, 10, 100})
    for (const double n : {1, 2, 10, 500}) {
      const CmaSettings settings(children, n);
      double better = 0, worse = 0;
      for (const double weight : settings.weights) (weight > 0 ? better : worse) += weight;
      EXPECT_NEAR(better, 1, 1e-12);
      EXPECT_LE(worse, 0);
      EXPECT_TRUE(std::is_sorted(settings.weights.rbegin(), settings.weights.rend()));
      EXPECT_LE(settings.rank_one + settings.rank_mu, 1);
      // the covariance stays positive definite: what is taken away is less than what is kept
      EXPECT_GE(1 - settings.rank_one - settings.rank_mu + n * settings.rank_mu * worse, -1e-12);
    }
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
