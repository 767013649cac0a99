// CMA-ES compared with the equations of Hansen's tutorial (arXiv 1604.00772v2) and, on functions with known optima,
// with published numbers of evaluations.
#include "evodevo/helpers/selection/cma_es.hpp"

#include <Eigen/QR>
#include <functional>
#include <numeric>

#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

// the equations of the tutorial -------------------------------------------------------------------------------------

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

// functions with known optima ----------------------------------------------------------------------------------------

using Point = std::vector<double>;
using Function = std::function<double(const Point&)>;

double sphere(const Point& x) { return std::inner_product(x.begin(), x.end(), x.begin(), 0.0); }

/// An ellipsoid whose axes differ by a factor of 1000.
double ellipsoid(const Point& x) {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    sum += std::pow(1e6, static_cast<double>(i) / static_cast<double>(x.size() - 1)) * x[i] * x[i];
  return sum;
}

double rosenbrock(const Point& x) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < x.size(); ++i)
    sum += 100 * std::pow(x[i] * x[i] - x[i + 1], 2) + std::pow(1 - x[i], 2);
  return sum;
}

/// A random rotation of a space.
Eigen::MatrixXd random_rotation(std::size_t dimension, Rng& rng) {
  Eigen::MatrixXd axes(dimension, dimension);
  for (double& one : axes.reshaped()) one = rng.normal();
  const Eigen::MatrixXd orthogonal = axes.householderQr().householderQ();
  return orthogonal.transpose();
}

/// Where a search begins, in a cube that is so large that its bounds do not matter.
struct Search {
  std::size_t dimension;
  double start, step, target;
};

void learn(CmaEs& strategy, const std::vector<Point>& points, const std::vector<double>& values, Rng& rng) {
  std::vector<std::uint32_t> order(points.size()), ranks;
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return values[a] < values[b]; });
  std::vector<Point> sorted;
  for (const std::uint32_t i : order) sorted.push_back(points[i]);
  for (std::uint32_t i = 0; i < order.size(); ++i)
    ranks.push_back(i > 0 && values[order[i]] == values[order[i - 1]] ? ranks.back() : i);
  strategy.update(sorted, ranks, rng);
}

/// Returns the number of evaluations until a value is below the target. More than 100,000 are a failure.
double evaluations(const Function& function, const Search& search, std::uint64_t seed) {
  const double side = 40;
  CmaEs strategy(search.dimension, search.step / side);
  Rng rng = stream(seed);
  const auto children = static_cast<std::size_t>(4 + std::floor(3 * std::log(search.dimension)));
  for (int count = 0; count < 100'000;) {
    const auto points = strategy.sample(children, rng);
    std::vector<double> values;
    for (Point x : points) {
      for (double& one : x) one = search.start + side * (one - 0.5);
      values.push_back(function(x));
      ++count;
      if (values.back() < search.target) return count;
    }
    learn(strategy, points, values, rng);
  }
  ADD_FAILURE() << "no value below " << search.target << " in dimension " << search.dimension;
  return 100'000;
}

double median_evaluations(const Function& function, const Search& search) {
  std::vector<double> counts;
  for (std::uint64_t seed = 0; seed < 11; ++seed) counts.push_back(evaluations(function, search, seed));
  std::sort(counts.begin(), counts.end());
  return counts[5];
}

// The published numbers are those that Hansen's own programs print in their documentation, at the same function,
// dimension, start, step size and value.
TEST(CmaEs, NeedsAsManyEvaluationsAsPublished) {
  const auto expect = [&](const Function& function, const Search& search, double published, const char* name) {
    const double found = median_evaluations(function, search);
    EXPECT_LT(found, 1.5 * published) << name;
    EXPECT_GT(found, 0.5 * published) << name << ": too good to be true";
  };
  expect(ellipsoid, {3, 0.5, 0.3, 4.8e-13}, 1400, "purecma, felli");
  expect(ellipsoid, {10, 0.5, 0.3, 5.3e-10}, 6000, "purecma, ff.elli");
  expect(rosenbrock, {4, 0.5, 0.5, 1.15e-11}, 1600, "barecmaes2, Fcts.rosenbrock");
  expect(rosenbrock, {8, 0, 0.5, 1.27e-11}, 4000, "pycma, README");
  // pycma's test.py asks for fewer than 1000 from 1 with the step size 2 to 1e-8, in 2 to 4 dimensions
  for (const std::size_t dimension : {2, 3, 4})
    EXPECT_LT(median_evaluations(sphere, {dimension, 1, 2, 1e-8}), 1000) << dimension;
}

TEST(CmaEs, NeedsNoMoreEvaluationsOnARotatedEllipsoid) {
  Rng rng = stream(1);
  for (const std::size_t dimension : {5, 10, 20}) {
    const Eigen::MatrixXd rotation = random_rotation(dimension, rng);
    const Search search{dimension, 0.5, 0.3, 5.3e-10};
    const double straight = median_evaluations(ellipsoid, search);
    const auto rotated_ellipsoid = [&](const Point& x) {
      const Eigen::VectorXd turned = rotation * Eigen::Map<const Eigen::VectorXd>(x.data(), rotation.cols());
      return ellipsoid({turned.begin(), turned.end()});
    };
    const double rotated = median_evaluations(rotated_ellipsoid, search);
    EXPECT_NEAR(rotated, straight, 0.15 * straight) << dimension;
  }
}

/// Each further digit takes the same number of evaluations.
TEST(CmaEs, ConvergesLinearlyOnTheSphere) {
  for (const std::size_t dimension : {5, 10, 20}) {
    const auto until = [&](double target) { return median_evaluations(sphere, {dimension, 1, 0.5, target}); };
    const double ten_digits = until(1e-10);
    EXPECT_NEAR((until(1e-15) - ten_digits) / (ten_digits - until(1e-5)), 1, 0.15) << dimension;
  }
}

/// Returns the least value that a search in the unit cube finds.
double least_found(const Function& function, std::size_t dimension, int generations, std::uint64_t seed) {
  CmaEs strategy(dimension, 0.3);
  Rng rng = stream(seed);
  double least = 1e300;
  for (int i = 0; i < generations; ++i) {
    const auto points = strategy.sample(10, rng);
    std::vector<double> values;
    for (const Point& x : points) {
      for (const double one : x) EXPECT_TRUE(one >= 0 && one <= 1);
      values.push_back(function(x));
    }
    least = std::min(least, *std::min_element(values.begin(), values.end()));
    learn(strategy, points, values, rng);
  }
  return least;
}

TEST(CmaEs, FindsOptimaOnTheBoundsAndBetweenTheImages) {
  // at (0, 1, 0.3, 0), with a slope at the first two bounds
  const auto corner = [](const Point& x) { return sphere({x[0] + 0.5, x[1] - 1.5, x[2] - 0.3, x[3]}) - 0.5; };
  const auto slope = [](const Point& x) { return std::accumulate(x.begin(), x.end(), 0.0); };
  // at (0, 0.75): the second axis of this narrow valley depends on the first
  const auto valley = [](const Point& x) { return 100 * std::pow(x[1] - x[0] - 0.75, 2) + x[0] * x[0] + x[0]; };
  const auto inside = [](const Point& x) {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) sum += std::pow(1e4, static_cast<double>(i) / 3) * std::pow(x[i] - 0.3, 2);
    return sum;
  };
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    EXPECT_NEAR(least_found(inside, 4, 200, seed), 0, 1e-6) << seed;
    if (seed >= 10) continue;
    EXPECT_NEAR(least_found(corner, 4, 300, seed), 0, 1e-6) << seed;
    EXPECT_NEAR(least_found(slope, 8, 800, seed), 0, 1e-6) << seed;
    EXPECT_NEAR(least_found(valley, 2, 300, seed), 0, 1e-6) << seed;
  }
}

TEST(CmaEs, ContinuesFromItsState) {
  CmaEs one(5, 0.2);
  Rng rng = stream(1);
  for (int i = 0; i < 20; ++i) {
    CmaEs copy(5, one.state());
    EXPECT_EQ(copy.state(), one.state());
    Rng same = rng;
    const auto points = one.sample(7, rng);
    ASSERT_EQ(copy.sample(7, same), points);
    one.update(points, {0, 1, 2, 3, 4, 5, 6}, rng);
    copy.update(points, {0, 1, 2, 3, 4, 5, 6}, same);
    EXPECT_EQ(copy.state(), one.state());
  }
  EXPECT_EQ(one.state().size(), 6u * 7);
  EXPECT_THROW(CmaEs(4, one.state()), std::runtime_error);
}

TEST(CmaEs, EquallyGoodPointsHaveEqualWeight) {
  Rng rng = stream(1);
  const CmaEs start(3, 0.01);  // far from the bounds, so that the images of points are those drawn
  const auto points = start.sample(6, rng);
  auto swapped = points;
  std::swap(swapped[1], swapped[3]);
  CmaEs one = start, other = start;
  Rng first = stream(2), second = stream(2), third = stream(2);
  one.update(points, {0, 1, 1, 1, 4, 5}, first);
  other.update(swapped, {0, 1, 1, 1, 4, 5}, second);
  const auto a = one.state(), b = other.state();
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-12);
  CmaEs ranked = start;
  ranked.update(swapped, {0, 1, 2, 3, 4, 5}, third);
  EXPECT_GT(std::abs(ranked.mean()[0] - one.mean()[0]), 1e-5);
}

TEST(CmaEs, LearnsNothingFromOnePointAndWhereNothingDiffers) {
  CmaEs strategy(3, 0.2);
  const auto before = strategy.state();
  Rng rng = stream(1);
  strategy.update({{0.1, 0.2, 0.3}}, {0}, rng);
  strategy.update({}, {}, rng);
  EXPECT_EQ(strategy.state(), before);
  strategy.update(strategy.sample(7, rng), std::vector<std::uint32_t>(7, 0), rng);
  EXPECT_EQ(strategy.state(), before) << "equally good points teach nothing";
  strategy.update(std::vector<Point>(7, strategy.mean()), {0, 1, 2, 3, 4, 5, 6}, rng);
  for (const double number : strategy.state()) EXPECT_TRUE(std::isfinite(number));
}

/// Chance decides which points are good. With and without ties, the step size must not collapse: it moves at random.
TEST(CmaEs, TiesDoNotShrinkTheSteps) {
  const std::vector<std::uint32_t> ties[] = {{0, 1, 2, 3, 4, 5, 6, 7, 8, 9},
                                             {0, 1, 1, 1, 1, 1, 1, 1, 1, 1},
                                             {0, 0, 0, 0, 0, 5, 5, 5, 5, 5},
                                             {0, 0, 2, 2, 2, 5, 5, 7, 8, 8}};
  for (const auto& ranks : ties) {
    std::vector<double> steps;
    for (std::uint64_t seed = 0; seed < 11; ++seed) {
      CmaEs strategy(10, 1e-3);
      Rng rng = stream(seed);
      for (int i = 0; i < 200; ++i) strategy.update(strategy.sample(10, rng), ranks, rng);
      steps.push_back(strategy.state()[1]);
    }
    std::sort(steps.begin(), steps.end());
    EXPECT_GT(steps[5], 1e-4) << ranks[1] << ranks[4];
  }
}

TEST(CmaEs, BearsPointsThatWereDrawnByOthers) {
  CmaEs strategy(3, 1e-7);
  Rng rng = stream(1);
  for (int i = 0; i < 100; ++i) {
    auto points = strategy.sample(6, rng);
    for (double& coordinate : points.front()) coordinate = rng.uniform();  // at first, a million times too far away
    const double before = strategy.state()[1];
    strategy.update(points, {0, 1, 2, 3, 4, 5}, rng);
    for (const double number : strategy.state()) ASSERT_TRUE(std::isfinite(number)) << i;
    const double growth = strategy.state()[1] / before;  // beside e, by the unit of the covariances
    EXPECT_LT(growth, 2 * std::exp(1.0)) << i;
  }
  EXPECT_GT(strategy.state()[1], 1e-3) << "it goes where the best points are";
}

/// The path is measured in the same units as the covariances.
TEST(CmaEs, ThePathStaysInProportionWhenTheDistributionIsLimited) {
  const auto path_after = [](double step) {
    Rng rng = stream(1);
    CmaEs strategy(2, std::vector<double>{50, step, 0.5, 0.5, 1, 0, 1, 0, 1, 0, 0, 1});
    strategy.update(std::vector<Point>(6, strategy.mean()), {0, 1, 2, 3, 4, 5}, rng);
    const auto state = strategy.state();
    return std::abs(state[6]) / std::sqrt(state[8]);  // relative to the standard deviation along the first axis
  };
  EXPECT_NEAR(path_after(30) / path_after(0.01), 1, 0.2);
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
