// Compares the search for nearest neighbours on the GPU with that on the CPU.
#include "analysis/neighbours.hpp"

#include <chrono>
#include <stdexcept>

#include "batch.hpp"
#include "common/bodies.hpp"
#include "cuda/runtime/cuda_neighbours.hpp"
#include "studies.hpp"
#include "threads/parallel.hpp"

namespace evodevo::tools::bench {
namespace {

constexpr std::uint32_t neighbours_of_each = 25;

using Clouds = std::vector<PointCloud>;

/// The time that a search through all clouds takes, s.
double seconds(NeighbourSearch& search, const Clouds& clouds, Workers& workers) {
  std::vector<std::size_t> pairs(clouds.size());
  const auto start = std::chrono::steady_clock::now();
  search.find(clouds, workers, [&](std::size_t i, std::span<const IndexPair> found) { pairs[i] = found.size(); });
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::vector<std::vector<IndexPair>> all_pairs(NeighbourSearch& search, const Clouds& clouds, Workers& workers) {
  std::vector<std::vector<IndexPair>> pairs(clouds.size());
  search.find(clouds, workers,
              [&](std::size_t i, std::span<const IndexPair> found) { pairs[i].assign(found.begin(), found.end()); });
  return pairs;
}

}  // namespace

Report neighbours(const Settings& settings) {
  std::vector<std::vector<Vec3>> population(settings.bodies);
  Workers workers(settings.threads);
  workers.for_each(population.size(), [&](std::size_t i) { population[i] = points_in_ball(settings.masses, i); });
  Clouds clouds;
  for (const std::vector<Vec3>& positions : population) clouds.push_back({positions, neighbours_of_each});
  const auto cpu = make_cpu_neighbour_search(), cuda = make_cuda_neighbour_search();
  if (all_pairs(*cpu, clouds, workers) != all_pairs(*cuda, clouds, workers))
    throw std::runtime_error("CPU and GPU do not find the same neighbours");

  std::vector<double> cpu_seconds, cuda_seconds, ratios;
  // measures alternately, so that other load on the machine affects both equally
  for (int run = 0; run < settings.runs; ++run) {
    cpu_seconds.push_back(seconds(*cpu, clouds, workers));
    cuda_seconds.push_back(seconds(*cuda, clouds, workers));
    ratios.push_back(cpu_seconds.back() / cuda_seconds.back());
  }
  return {{"study", "Nearest neighbours"},
          {"command", settings.command},
          {"points", "random in a ball"},
          {"masses", settings.masses},
          {"neighbours", neighbours_of_each},
          {"bodies", settings.bodies},
          {"threads", thread_count(settings.threads)},
          {"runs", settings.runs},
          {"note", "CPU and GPU find the same neighbours; copies to and from the GPU are included."},
          {"rows", Report::array({{{"cpu_seconds", median(cpu_seconds)},
                                   {"cuda_seconds", median(cuda_seconds)},
                                   {"times_faster", median(ratios)}}})}};
}

}  // namespace evodevo::tools::bench
