// Random permutations that a thread can evaluate without storing them.
#pragma once

#include <cstdint>

#include "physics/arithmetic.hpp"

namespace evodevo::tools::bench {

/// A permutation of 0 .. count-1 that depends only on a key. It is a Feistel network of ten rounds with the multiplier
/// and the key schedule of Philox 2x32-10 (Salmon et al. 2011). Its halves have just enough bits for `count`; results
/// outside the range are mapped again until they lie in it (cycle walking).
class Permutation {
 public:
  EVODEVO_HD Permutation(std::uint32_t count, std::uint32_t key) : count_(count), key_(key) {
    while ((std::uint64_t{1} << 2 * half_) < count) ++half_;
  }

  EVODEVO_HD std::uint32_t operator()(std::uint32_t value) const {
    do value = mixed(value);
    while (value >= count_);
    return value;
  }

 private:
  EVODEVO_HD std::uint32_t mixed(std::uint32_t value) const {
    const std::uint32_t mask = (1u << half_) - 1;
    std::uint32_t left = value >> half_, right = value & mask, key = key_;
    for (int round = 0; round < 10; ++round) {
      // the upper bits of a product depend on all bits of its factors
      const std::uint32_t next = left ^ ((right ^ key) * 0xd256d193u >> (32 - half_));
      left = right;
      right = next;
      key += 0x9e3779b9u;
    }
    return left << half_ | right;
  }

  std::uint32_t count_, key_;
  unsigned half_ = 1;  // bits of each half of the network
};

/// The order in which the springs of a body are distributed over threads in a tally; it differs between tallies and
/// between bodies. `springs` is the number of springs.
EVODEVO_HD Permutation shifted(std::uint32_t springs, std::uint32_t body, std::uint32_t tally) {
  return {springs, tally * 0x85ebca6bu ^ body * 0xc2b2ae35u};
}

}  // namespace evodevo::tools::bench
