// The GPU finds the same neighbours as the CPU, for all kinds of point clouds.
#include "analysis/neighbours.hpp"

#include <cmath>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "cuda/runtime/cuda_neighbours.hpp"
#include "evodevo/lattice.hpp"
#include "gpu.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

using test::random_places;
using Places = std::vector<Vec3>;

Places shuffled(Places places) {
  std::mt19937_64 random(1);
  std::shuffle(places.begin(), places.end(), random);
  return places;
}

/// Searches all clouds in one call, and compares each result with nearest_pairs().
void compare(NeighbourSearch& search, const std::vector<PointCloud>& clouds) {
  std::vector<std::vector<IndexPair>> found(clouds.size());
  std::vector<int> calls(clouds.size(), 0);
  Workers workers(2);
  search.find(clouds, workers, [&](std::size_t i, std::span<const IndexPair> pairs) {
    found[i].assign(pairs.begin(), pairs.end());
    ++calls[i];
  });
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    EXPECT_EQ(calls[i], 1) << "cloud " << i;
    // not EXPECT_EQ, which would print a million pairs
    EXPECT_TRUE(found[i] == nearest_pairs(clouds[i].positions, clouds[i].k))
        << "cloud " << i << ", " << clouds[i].positions.size() << " points, k = " << clouds[i].k;
  }
}

/// Searches all clouds with each k in one call, and compares the results.
void compare(const std::vector<Places>& all, std::initializer_list<std::uint32_t> ks) {
  std::vector<PointCloud> clouds;
  for (const std::uint32_t k : ks)
    for (const Places& places : all) clouds.push_back({places, k});
  compare(*make_cuda_neighbour_search(), clouds);
}

class GpuNeighbours : public OnGpu {};

TEST_F(GpuNeighbours, RandomPlacesOfManySizes) {
  std::vector<Places> all;
  for (const std::size_t count : {2, 3, 31, 32, 33, 64, 500, 1000}) all.push_back(random_places(count, count));
  compare(all, {1, 2, 25, 60, 5000});
}

TEST_F(GpuNeighbours, EquallyNearPlacesGoByIndex) {
  const Places lattice = shuffled(make_lattice({9, 9, 9}, 1).corners);
  // away from the origin, distances are rounded
  Places moved = lattice;
  for (Vec3& p : moved) p = 0.1 * p + Vec3{0.3, -7.7, 1e3};
  compare({lattice, moved}, {1, 4, 7, 25, 300});
}

TEST_F(GpuNeighbours, Duplicates) {
  Places copies = random_places(100, 7);
  for (int i = 0; i < 4; ++i) copies.insert(copies.end(), copies.begin(), copies.begin() + 100);
  compare({shuffled(copies), Places(200, Vec3{1, 2, 3}), Places(2, Vec3{})}, {1, 3, 4, 5, 25, 150});
}

TEST_F(GpuNeighbours, PlacesOnALine) {
  Places even, geometric;
  for (int i = 0; i < 400; ++i) even.push_back({0.01 * i, 0, 0});
  for (int i = 0; i < 400; ++i) geometric.push_back({0, std::pow(0.5, i), 0});
  compare({shuffled(even), shuffled(geometric)}, {1, 2, 25, 200});
}

TEST_F(GpuNeighbours, ACrowdFarFromAStraggler) {
  Places crowd = random_places(500, 5);
  for (Vec3& p : crowd) p = {1e-4 * p.x, 1e-6 * p.y, 1e-12 * p.z};
  crowd.push_back({1000, 1000, 1000});
  compare({shuffled(crowd)}, {1, 25, 499});
}

TEST_F(GpuNeighbours, NothingToJoin) {
  const Places none, one = random_places(1, 1), some = random_places(40, 1);
  compare(*make_cuda_neighbour_search(), {});
  compare(*make_cuda_neighbour_search(), {{none, 3}, {one, 3}, {some, 0}});
  compare(*make_cuda_neighbour_search(), {{none, 3}, {some, 3}, {one, 3}, {some, 0}, {some, 4}});
}

TEST_F(GpuNeighbours, LargeBodies) {
  const Places places5000 = random_places(5000, 2), places50000 = random_places(50000, 3);
  compare(*make_cuda_neighbour_search(), {{places5000, 25}, {places50000, 25}, {places5000, 200}});
}

TEST_F(GpuNeighbours, Portions) {
  std::vector<Places> all;
  for (std::size_t i = 0; i < 40; ++i) all.push_back(random_places(20 + 17 * i, i));
  std::vector<PointCloud> clouds;
  for (const Places& places : all) clouds.push_back({places, 25});
  // a limit that is less than a single large cloud needs
  compare(*make_cuda_neighbour_search(100'000), clouds);
}

TEST_F(GpuNeighbours, SeveralThreadsSearchAtOnce) {
  const auto search = make_cuda_neighbour_search();
  std::vector<std::jthread> threads;
  for (std::uint64_t thread = 0; thread < 4; ++thread)
    threads.emplace_back([&search, thread] {
      for (std::uint64_t round = 0; round < 5; ++round) {
        const Places a = random_places(300 + 100 * thread, 10 * thread + round), b = random_places(77, round);
        compare(*search, {{a, 25}, {b, 10}});
      }
    });
}

TEST_F(GpuNeighbours, PassesOnWhatTheCallerThrows) {
  const auto search = make_cuda_neighbour_search();
  const Places places = random_places(50, 1);
  const std::vector<PointCloud> clouds{{places, 5}, {places, 6}};
  Workers workers(2);
  EXPECT_THROW(search->find(clouds, workers, [](std::size_t, auto) { throw std::range_error("no"); }),
               std::range_error);
  compare(*search, clouds);
}

}  // namespace
}  // namespace evodevo::testing_gpu::EVODEVO_FILE
