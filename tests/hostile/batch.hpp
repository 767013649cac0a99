// Batches of random bodies, most of which no experiment would make.
#pragma once

#include <cstdint>
#include <vector>

#include "physics/random_lives.hpp"

namespace evodevo::test {

struct Batch {
  Scene scene;
  Stepping stepping;
  Recording recording;
  std::vector<Life> lives;
  bool is_tame = false;  ///< small bodies with stable steps, which move as on another device
};

/// Returns the batch of a number. Successive numbers have all methods in both precisions, with materials from a table
/// or from codes. Twelve tame batches and twelve others come in turn. The bodies of the others have masses,
/// stiffnesses, sizes, speeds, times and steps of any scale, masses at the same place, masses with hundreds of springs,
/// and thousands of materials.
Batch batch_of(std::uint64_t number, std::size_t bodies);

}  // namespace evodevo::test
