// Places in the space of descriptors, and nearest neighbours in a space of any dimension. Needs nanoflann.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nanoflann.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "evodevo/selection.hpp"

namespace evodevo {

/// The coordinates of a place in a space of any dimension, such as the space of the descriptors.
using Coordinates = std::vector<double>;

/// Largest coordinate, and smallest one if negated, of a place in the space of the descriptors.
inline constexpr double farthest = 1e6;

/// Returns where an individual that did not fail lies in the space of the descriptors. The range of each descriptor
/// becomes [0, 1]. A value that lies outside by more than a million ranges counts as that far outside, so that
/// distances are finite, and those to different cells differ.
inline Coordinates place_of(const Candidate& row, std::span<const Objective> descriptors) {
  Coordinates place;
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    const double low = descriptors[i].low / 2, range = descriptors[i].high / 2 - low;  // half, so that none overflows
    place.push_back(std::clamp((row.descriptors[i] / 2 - low) / range, -farthest, farthest));
  }
  return place;
}

/// Returns places as a list of a memory: the coordinates of one after those of another.
inline std::vector<double> list_of_places(const std::vector<Coordinates>& places) {
  std::vector<double> list;
  for (const Coordinates& place : places) list.insert(list.end(), place.begin(), place.end());
  return list;
}

/// Returns the `count` places in the space of so many descriptors that a list of a memory has. Throws
/// std::runtime_error if there is no such list, or if it has other places.
inline std::vector<Coordinates> places_in(const SelectionMemory& memory, const std::string& name, std::size_t count,
                                          std::size_t descriptors) {
  const std::vector<double>& list = memory.list(name);
  if (list.size() != count * descriptors ||
      !std::all_of(list.begin(), list.end(), [](double x) { return x >= -farthest && x <= farthest; }))
    SelectionMemory::fail("does not have " + std::to_string(count) + " " + name + " of " + std::to_string(descriptors) +
                          " descriptors from -1e6 to 1e6");
  std::vector<Coordinates> places;
  for (auto next = list.begin(); next != list.end(); next += static_cast<std::ptrdiff_t>(descriptors))
    places.emplace_back(next, next + static_cast<std::ptrdiff_t>(descriptors));
  return places;
}

/// Finds the nearest of many fixed places by Euclidean distance, with a k-d tree (nanoflann).
class Neighbours {
 public:
  struct Neighbour {
    std::uint32_t index;  ///< of a place
    double distance;
  };

  /// All places must have the same dimension, at least 1, and coordinates up to 1e150.
  explicit Neighbours(std::vector<Coordinates> places)
      : cloud_{std::move(places)}, tree_(cloud_.dimension(), cloud_, {leaf_size}) {}
  Neighbours(const Neighbours&) = delete;  // the tree refers to the places
  Neighbours& operator=(const Neighbours&) = delete;

  /// Returns the `count` places that are nearest to a place, the nearest first; all of them if there are fewer.
  std::vector<Neighbour> nearest(std::span<const double> place, std::size_t count) const {
    if (cloud_.places.empty() || count == 0) return {};
    std::vector<std::uint32_t> index(std::min(count, cloud_.places.size()));
    std::vector<double> squared(index.size());
    nanoflann::KNNResultSet<double, std::uint32_t> found(index.size());
    found.init(index.data(), squared.data());
    tree_.findNeighbors(found, place.data(), nanoflann::SearchParams());
    std::vector<Neighbour> result;
    for (std::size_t i = 0; i < found.size(); ++i) result.push_back({index[i], std::sqrt(squared[i])});
    return result;
  }

  const std::vector<Coordinates>& places() const { return cloud_.places; }

 private:
  static constexpr std::size_t leaf_size = 10;

  /// The places in the form that nanoflann reads.
  struct Cloud {
    std::vector<Coordinates> places;

    int dimension() const { return places.empty() ? 1 : static_cast<int>(places.front().size()); }
    std::size_t kdtree_get_point_count() const { return places.size(); }
    double kdtree_get_pt(std::size_t i, std::size_t axis) const { return places[i][axis]; }
    template <class Bounds>
    bool kdtree_get_bbox(Bounds&) const {
      return false;  // nanoflann computes the bounding box itself
    }
  };

  Cloud cloud_;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, -1, std::uint32_t> tree_;
};

}  // namespace evodevo
