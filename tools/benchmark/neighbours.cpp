#include "benchmark/neighbours.hpp"

#include <algorithm>
#include <chrono>
#include <random>
#include <stdexcept>
#include <vector>

#include "cuda/cuda_neighbours.hpp"
#include "neighbours.hpp"
#include "parallel.hpp"

namespace evodevo::benchmark {
namespace {

using Population = std::vector<std::vector<Vec3>>;
using Clouds = std::vector<PointCloud>;

/// Points that are uniform in the unit ball.
std::vector<Vec3> random_ball(std::uint32_t points, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto coordinate = [&] { return static_cast<double>(random() >> 11) * 0x1p-52 - 1; };
  std::vector<Vec3> places;
  while (places.size() < points) {
    const double x = coordinate(), y = coordinate(), z = coordinate();
    if (dot({x, y, z}, {x, y, z}) <= 1) places.push_back({x, y, z});
  }
  return places;
}

/// The time that a search takes for all clouds, s.
double seconds(NeighbourSearch& search, const Clouds& clouds) {
  std::vector<std::size_t> pairs(clouds.size());
  const auto start = std::chrono::steady_clock::now();
  search.find(clouds, [&](std::size_t i, std::span<const IndexPair> found) { pairs[i] = found.size(); });
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::vector<std::vector<IndexPair>> all_pairs(NeighbourSearch& search, const Clouds& clouds) {
  std::vector<std::vector<IndexPair>> pairs(clouds.size());
  search.find(clouds,
              [&](std::size_t i, std::span<const IndexPair> found) { pairs[i].assign(found.begin(), found.end()); });
  return pairs;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

}  // namespace

nlohmann::ordered_json measure_neighbours(const NeighbourSettings& settings) {
  Population population(settings.bodies);
  Workers(settings.threads).for_each(population.size(), [&](std::size_t i) {
    population[i] = random_ball(settings.masses, i);
  });
  Clouds clouds;
  for (const std::vector<Vec3>& places : population) clouds.push_back({places, settings.neighbours});
  const auto cpu = make_cpu_neighbour_search(settings.threads), cuda = make_cuda_neighbour_search(settings.threads);
  if (all_pairs(*cpu, clouds) != all_pairs(*cuda, clouds))
    throw std::runtime_error("CPU and GPU do not find the same neighbours");

  std::vector<double> cpu_seconds, cuda_seconds, ratios;
  // in turn, so that whatever else the machine does meets both
  for (int run = 0; run < settings.runs; ++run) {
    cpu_seconds.push_back(seconds(*cpu, clouds));
    cuda_seconds.push_back(seconds(*cuda, clouds));
    ratios.push_back(cpu_seconds.back() / cuda_seconds.back());
  }
  return {{"cpu_seconds", median(cpu_seconds)},
          {"cuda_seconds", median(cuda_seconds)},
          {"times_faster", median(ratios)},
          {"bodies", settings.bodies},
          {"masses", settings.masses},
          {"neighbours", settings.neighbours},
          {"threads", thread_count(settings.threads)},
          {"runs", settings.runs}};
}

}  // namespace evodevo::benchmark
