// k-nearest neighbours, compared with a search through all distances.
#include "analysis/neighbours.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <stdexcept>

#include "evodevo/lattice.hpp"

namespace evodevo::EVODEVO_FILE {
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

std::vector<Vec3> random_places(std::uint32_t n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<Vec3> places(n);
  for (Vec3& p : places) p.x = unit(), p.y = unit(), p.z = unit();
  return places;
}

TEST(Neighbours, RandomPlaces) {
  for (const std::uint32_t n : {2u, 11u, 300u})
    for (const std::uint32_t k : {1u, 5u, 25u})
      EXPECT_EQ(nearest_pairs(random_places(n, n), k), brute_force(random_places(n, n), k));
}

TEST(Neighbours, EquallyNearPlacesGoByIndex) {
  // integer edges: distances are exact, and many are equal
  std::vector<Vec3> places = make_lattice({5, 6, 4}, 1).corners;
  std::mt19937_64 random(1);
  std::shuffle(places.begin(), places.end(), random);
  for (const std::uint32_t k : {1u, 4u, 7u, 25u}) EXPECT_EQ(nearest_pairs(places, k), brute_force(places, k)) << k;
  // away from the origin, where distances in the tree are rounded
  for (Vec3& p : places) p = 0.1 * p + Vec3{0.3, -7.7, 1e3};
  for (const std::uint32_t k : {1u, 4u, 7u, 25u}) EXPECT_EQ(nearest_pairs(places, k), brute_force(places, k)) << k;
}

TEST(Neighbours, Duplicates) {
  std::vector<Vec3> places = random_places(20, 7);
  for (int copies = 0; copies < 3; ++copies) places.insert(places.end(), places.begin(), places.begin() + 20);
  for (const std::uint32_t k : {1u, 2u, 3u, 5u, 30u}) EXPECT_EQ(nearest_pairs(places, k), brute_force(places, k)) << k;
  const std::vector<Vec3> all_the_same(50, Vec3{1, 2, 3});
  EXPECT_EQ(nearest_pairs(all_the_same, 3), brute_force(all_the_same, 3));
}

TEST(Neighbours, AllAreJoinedWhereThereAreNoMore) {
  const std::vector<Vec3> places = random_places(6, 3);
  for (const std::uint32_t k : {5u, 6u, 100u}) EXPECT_EQ(nearest_pairs(places, k).size(), 15u);
}

TEST(Neighbours, NothingToJoin) {
  EXPECT_TRUE(nearest_pairs({}, 3).empty());
  EXPECT_TRUE(nearest_pairs(random_places(1, 1), 3).empty());
  EXPECT_TRUE(nearest_pairs(random_places(9, 1), 0).empty());
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
  EXPECT_THROW(
      make_cpu_neighbour_search()->find(clouds, workers, [](std::size_t, auto) { throw std::range_error("no"); }),
      std::range_error);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
