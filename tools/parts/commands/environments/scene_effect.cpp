#include "environments/scene_effect.hpp"

#include <algorithm>

#include "base/philox.hpp"

namespace evodevo {
namespace {

/// One flag for each body: whether it is assigned to the second scene.
using Deal = std::vector<char>;

struct Means {
  double between, within;

  double excess() const { return between - within; }
};

/// Returns the mean distances between and within the scenes, each of which must have at least two bodies.
Means means(const std::vector<std::vector<double>>& distances, const Deal& in_other) {
  double sum[2] = {}, between = 0;
  for (std::size_t i = 0; i < in_other.size(); ++i)
    for (std::size_t j = i + 1; j < in_other.size(); ++j)
      (in_other[i] != in_other[j] ? between : sum[static_cast<int>(in_other[i])]) += distances[i][j];
  const auto b = static_cast<double>(std::count(in_other.begin(), in_other.end(), 1));
  const double a = static_cast<double>(in_other.size()) - b;
  return {between / (a * b), sum[0] / (a * (a - 1)) + sum[1] / (b * (b - 1))};
}

double mean_between(const std::vector<std::vector<double>>& distances, std::size_t first) {
  double sum = 0;
  for (std::size_t i = 0; i < first; ++i)
    for (std::size_t j = first; j < distances.size(); ++j) sum += distances[i][j];
  return sum / static_cast<double>(first * (distances.size() - first));
}

}  // namespace

SceneEffect scene_effect(const std::vector<std::vector<double>>& distances, std::size_t first) {
  constexpr int deals = 9999;
  constexpr double rounding = 1e-12;  // rounding error of sums in different orders; distances are at most about 1
  if (first < 2 || distances.size() < first + 2) return {mean_between(distances, first), {}, {}};
  Deal deal(distances.size(), 0);
  std::fill(deal.begin() + static_cast<std::ptrdiff_t>(first), deal.end(), 1);
  const Means given = means(distances, deal);
  Rng rng(philox, {});
  int as_far = 1;  // the actual assignment counts as one
  for (int i = 0; i < deals; ++i) {
    rng.shuffle(deal);
    if (means(distances, deal).excess() >= given.excess() - rounding) ++as_far;
  }
  return {given.between, given.within, as_far / (deals + 1.0)};
}

}  // namespace evodevo
