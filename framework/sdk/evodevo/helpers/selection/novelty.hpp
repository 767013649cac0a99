// Novelty: how far an individual's descriptors are from those of the others (Lehman and Stanley 2011a), and how good it
// is among those who are like it (local competition: Lehman and Stanley 2011b).
#pragma once

#include <limits>

#include "evodevo/helpers/selection/neighbours.hpp"

namespace evodevo {

/// What an individual did, and how good it was.
struct Behaviour {
  Coordinates place;  ///< in the space of descriptors
  double score = 0;   ///< greater is better
};

/// How an individual compares with its nearest neighbours.
struct Novelty {
  double distance = 0;       ///< mean distance to them
  std::uint32_t beaten = 0;  ///< number of them that have a lower score
};

/// Compares each individual with its nearest `count` neighbours among the others and an archive. If there are fewer, it
/// compares it with all; if there are none, the novelty is 0.
inline std::vector<Novelty> novelty(std::span<const Behaviour> individuals, std::span<const Behaviour> archive,
                                    std::size_t count) {
  std::vector<Behaviour> all(individuals.begin(), individuals.end());
  all.insert(all.end(), archive.begin(), archive.end());
  std::vector<Coordinates> places;
  for (const Behaviour& one : all) places.push_back(one.place);
  const Neighbours neighbours(std::move(places));
  std::vector<Novelty> result;
  for (std::uint32_t i = 0; i < individuals.size(); ++i) {
    auto near = neighbours.nearest(all[i].place, count + 1);
    // the individual itself, unless so many others are at its place that it is not among those found
    const auto self = std::find_if(near.begin(), near.end(), [&](const auto& one) { return one.index == i; });
    near.erase(self == near.end() ? near.end() - 1 : self);
    Novelty& found = result.emplace_back();
    for (const Neighbours::Neighbour& one : near) {
      found.distance += one.distance / static_cast<double>(near.size());
      found.beaten += all[one.index].score < all[i].score;
    }
  }
  return result;
}

}  // namespace evodevo
