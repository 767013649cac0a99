// Random orders that a thread can look up without anyone storing them.
#pragma once

#include <cstdint>

#include "physics/arithmetic.hpp"

namespace evodevo::tools::bench {

/// A permutation of 0 .. count-1 that depends on a key alone: a Feistel network of ten rounds with the multiplier and
/// the key schedule of Philox 2x32-10 (Salmon et al. 2011), its halves cut to fit; what leaves the range goes through
/// it again, so that it never leaves.
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
  unsigned half_ = 1;  // bits of half a number
};

/// The order in which `springs` of a body are dealt out for its `tally`-th tally: new each time, and the body's own.
EVODEVO_HD Permutation shifted(std::uint32_t springs, std::uint32_t body, std::uint32_t tally) {
  return {springs, tally * 0x85ebca6bu ^ body * 0xc2b2ae35u};
}

}  // namespace evodevo::tools::bench
