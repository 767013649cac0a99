// Niches: a space of descriptors that is divided into cells, each of which keeps its best individual (MAP-Elites:
// Mouret and Clune 2015). Places lie in the unit cube; what lies outside belongs to the nearest cell.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>

#include "evodevo/helpers/selection/neighbours.hpp"
#include "evodevo/rng.hpp"

namespace evodevo {

/// Returns the cell of the grid of the descriptors' bins in which their values lie, counted from 0, the last descriptor
/// fastest. Throws std::invalid_argument if the grid has more than 2^53 cells.
inline std::uint64_t grid_cell(std::span<const double> values, std::span<const Objective> descriptors) {
  constexpr double most = 9007199254740992;  // up to which all whole numbers are doubles, as notes are
  double cells = 1, cell = 0;
  for (std::size_t axis = 0; axis < values.size(); ++axis) {
    cells *= descriptors[axis].bins;
    cell = cell * descriptors[axis].bins + descriptors[axis].bin(values[axis]);
  }
  if (cells > most)
    throw std::invalid_argument("a grid of the " + std::to_string(descriptors.size()) +
                                " descriptors has more than 2^53 cells; give them fewer bins, or use centroidal cells");
  return static_cast<std::uint64_t>(cell);
}

/// Moves each centroid to the mean of the samples to which it is the nearest one (Lloyd's algorithm), and returns the
/// mean squared distance of the samples to their centroids before that. A centroid without samples stays.
inline double move_centroids(std::vector<Coordinates>& centroids, const std::vector<Coordinates>& samples) {
  const Neighbours cells(centroids);
  std::vector<Coordinates> sums(centroids.size(), Coordinates(centroids.front().size(), 0));
  std::vector<std::uint32_t> counts(centroids.size(), 0);
  double cost = 0;
  for (const Coordinates& sample : samples) {
    const Neighbours::Neighbour cell = cells.nearest(sample, 1).front();
    for (std::size_t axis = 0; axis < sample.size(); ++axis) sums[cell.index][axis] += sample[axis];
    ++counts[cell.index];
    cost += cell.distance * cell.distance;
  }
  for (std::size_t i = 0; i < centroids.size(); ++i)
    for (std::size_t axis = 0; axis < sums[i].size() && counts[i] > 0; ++axis)
      centroids[i][axis] = sums[i][axis] / counts[i];
  return cost / static_cast<double>(samples.size());
}

/// Returns the centres of `count` > 0 cells of similar size that fill the unit cube of a dimension: a centroidal
/// Voronoi tessellation, by k-means of uniformly distributed samples (Vassiliades et al. 2018). A place belongs to the
/// cell whose centre is nearest.
inline std::vector<Coordinates> voronoi_centres(std::uint32_t count, std::size_t dimension, Rng& rng) {
  std::vector<Coordinates> samples(std::max<std::size_t>(10'000, std::size_t{25} * count), Coordinates(dimension));
  for (Coordinates& sample : samples)
    for (double& coordinate : sample) coordinate = rng.uniform();
  std::vector<Coordinates> centres(samples.begin(), samples.begin() + count);
  double before = move_centroids(centres, samples);
  for (int round = 0; round < 100; ++round) {  // until the cost hardly changes
    const double cost = move_centroids(centres, samples);
    if (cost > 0.999 * before) break;
    before = cost;
  }
  return centres;
}

}  // namespace evodevo
