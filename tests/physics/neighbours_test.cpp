// k-nearest neighbours, compared with a search through all distances, and the colouring of springs.
#include "analysis/neighbours.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <stdexcept>

#include "analysis/colouring.hpp"
#include "evodevo/lattice.hpp"
#include "random_numbers.hpp"
#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

using Pairs = std::vector<IndexPair>;

Pairs brute_force(const std::vector<Vec3>& places, std::uint32_t k) {
  std::set<IndexPair> pairs;
  const auto n = static_cast<std::uint32_t>(places.size());
  for (std::uint32_t i = 0; i < n; ++i) {
    std::vector<std::pair<double, std::uint32_t>> others;
    for (std::uint32_t j = 0; j < n; ++j)
      if (j != i) others.emplace_back(dot(places[j] - places[i], places[j] - places[i]), j);
    std::sort(others.begin(), others.end());
    for (std::uint32_t j = 0; j < std::min<std::size_t>(k, others.size()); ++j)
      pairs.insert(std::minmax(i, others[j].second));
  }
  return {pairs.begin(), pairs.end()};
}

void expect_those_of_brute_force(const std::vector<Vec3>& places, std::initializer_list<std::uint32_t> numbers) {
  for (const std::uint32_t k : numbers) EXPECT_EQ(nearest_pairs(places, k), brute_force(places, k)) << k;
}

TEST(Neighbours, RandomPlaces) {
  for (const std::uint32_t n : {0u, 1u, 2u, 6u, 11u, 300u})
    expect_those_of_brute_force(random_places(n, n), {0, 1, 5, 25});
}

TEST(Neighbours, EquallyNearPlacesGoByIndex) {
  // integer edges: distances are exact, and many are equal
  std::vector<Vec3> places = make_lattice({5, 6, 4}, 1).corners;
  std::mt19937_64 random(1);
  std::shuffle(places.begin(), places.end(), random);
  expect_those_of_brute_force(places, {1, 4, 7, 25});
  // away from the origin, where distances in the tree are rounded
  for (Vec3& p : places) p = 0.1 * p + Vec3{0.3, -7.7, 1e3};
  expect_those_of_brute_force(places, {1, 4, 7, 25});
}

TEST(Neighbours, Duplicates) {
  std::vector<Vec3> places = random_places(20, 7);
  for (int copies = 0; copies < 3; ++copies) places.insert(places.end(), places.begin(), places.begin() + 20);
  expect_those_of_brute_force(places, {1, 2, 3, 5, 30});
  expect_those_of_brute_force(std::vector<Vec3>(50, Vec3{1, 2, 3}), {3});
}

TEST(Neighbours, OfAPopulation) {
  std::vector<std::vector<Vec3>> places;
  for (const std::uint32_t n : {0u, 40u, 1u, 7u, 90u}) places.push_back(random_places(n, n));
  std::vector<PointCloud> clouds;
  for (std::uint32_t i = 0; i < places.size(); ++i) clouds.push_back({places[i], i});
  for (const int threads : {1, 3}) {
    std::vector<std::vector<Pairs>> found(clouds.size());
    Workers workers(threads);
    make_cpu_neighbour_search()->find(clouds, workers, [&](std::size_t i, std::span<const IndexPair> pairs) {
      found[i].push_back({pairs.begin(), pairs.end()});
    });
    for (std::uint32_t i = 0; i < clouds.size(); ++i)
      EXPECT_EQ(found[i], std::vector<Pairs>{brute_force(places[i], i)}) << i;
  }
}

TEST(Neighbours, PassesOnWhatTheCallerThrows) {
  const std::vector<Vec3> places = random_places(9, 1);
  const std::vector<PointCloud> clouds{{places, 2}, {places, 3}};
  Workers workers(2);
  const auto fail = [](std::size_t, auto) { throw std::range_error("no"); };
  EXPECT_THROW(make_cpu_neighbour_search()->find(clouds, workers, fail), std::range_error);
}

TEST(Colouring, NoTwoSpringsOfAColourShareAMass) {
  EXPECT_TRUE(spring_colours({}).empty());
  for (const Body& body : {random_body(150, 12, 5, 1), block(3, {5000, 0, 0, 0})}) {
    const std::vector<std::uint32_t> colours = spring_colours(body);
    ASSERT_EQ(colours.size(), body.springs.size());
    std::vector<std::set<std::uint32_t>> at(body.masses.size());
    std::size_t highest_degree = 0;
    for (std::size_t i = 0; i < colours.size(); ++i)
      for (const std::uint32_t mass : {body.springs[i].a, body.springs[i].b}) {
        EXPECT_TRUE(at[mass].insert(colours[i]).second) << "spring " << i;
        highest_degree = std::max(highest_degree, at[mass].size());
      }
    EXPECT_LT(*std::max_element(colours.begin(), colours.end()), 2 * highest_degree - 1);
  }
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
