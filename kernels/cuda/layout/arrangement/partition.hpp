// Divides a body among the blocks of a cluster.
#pragma once

#include <cstdint>
#include <vector>

#include "cuda/layout/arrangement/outline.hpp"

namespace evodevo::cuda {

/// A part of a body: the masses that one block simulates, the springs inside, and those between them and other parts.
struct Part {
  Outline outline;
  std::vector<std::uint32_t> masses;   ///< [masses, halo] index into Body::masses
  std::vector<std::uint32_t> springs;  ///< [springs inside, cut springs] index into Body::springs
};

/// The part of each mass. Parts are divided from each other by planes at right angles to the longest side of what they
/// divide, so that few springs are cut, and have similar numbers of springs. Each part has a mass: `parts` is at least
/// 1, and at most the number of masses.
std::vector<std::uint32_t> parts_of_masses(const Outline& body, unsigned parts);

/// The parts of a body, each of which has a mass.
std::vector<Part> partition(const Outline& body, unsigned parts);

}  // namespace evodevo::cuda
