// Random numbers that depend only on the key of their stream, not on what other streams have drawn.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace evodevo {

/// Returns a number that stands for two others, in this order; each of its bits depends on all of theirs (the finalizer
/// of SplitMix64: Steele et al. 2014).
constexpr std::uint64_t mixed(std::uint64_t one, std::uint64_t other) {
  std::uint64_t x = one + 0x9e3779b97f4a7c15 * (other + 1);
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9;
  x = (x ^ x >> 27) * 0x94d049bb133111eb;
  return x ^ x >> 31;
}

/// Identifies a stream of random numbers. Equal keys give equal streams, on any machine and thread.
struct StreamKey {
  std::uint64_t seed = 0;        ///< seed of the run
  std::uint32_t generation = 0;  ///< generation in which the numbers are drawn
  std::uint32_t individual = 0;  ///< individual for which the numbers are drawn
  std::uint32_t position = 0;    ///< position of the operator in the pipeline
};

/// A counter-based stream (Philox 4x32-10, Salmon et al. 2011, computed by the host). It is a
/// std::uniform_random_bit_generator. The members below give the same numbers with every standard library, unlike the
/// distributions of <random>.
class Rng {
 public:
  using result_type = std::uint32_t;
  /// Fills out[4] from a counter[4] and a key[2].
  using Philox = void (*)(const std::uint32_t* counter, const std::uint32_t* key, std::uint32_t* out);

  Rng(Philox philox, const StreamKey& key)
      : philox_(philox),
        key_{static_cast<std::uint32_t>(key.seed), static_cast<std::uint32_t>(key.seed >> 32)},
        counter_{0, key.generation, key.individual, key.position} {}

  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return std::numeric_limits<result_type>::max(); }

  /// Returns 32 random bits.
  result_type operator()() {
    if (used_ == 4) {
      philox_(counter_, key_, block_);
      ++counter_[0];
      used_ = 0;
    }
    return block_[used_++];
  }

  /// Returns a uniformly distributed multiple of 2^-53 in [0, 1).
  double uniform() {
    const std::uint64_t high = (*this)() >> 5, low = (*this)() >> 6;
    return static_cast<double>(high << 26 | low) * 0x1p-53;
  }

  /// Returns a uniformly distributed number in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Returns a uniformly distributed integer from 0 to count - 1, without bias; count > 0.
  std::uint32_t below(std::uint32_t count) {
    const std::uint32_t uneven = (0u - count) % count;
    for (;;) {
      const std::uint64_t product = std::uint64_t{(*this)()} * count;
      if (static_cast<std::uint32_t>(product) >= uneven) return static_cast<std::uint32_t>(product >> 32);
    }
  }

  /// Returns true with the given probability.
  bool chance(double probability) { return uniform() < probability; }

  /// Normally distributed with mean 0 and standard deviation 1 (polar method: Marsaglia and Bray 1964). It uses the
  /// logarithm of the C library, the last bit of which may differ between libraries.
  double normal() {
    for (;;) {
      const double x = uniform(-1, 1), y = uniform(-1, 1), square = x * x + y * y;
      if (square > 0 && square < 1) return x * std::sqrt(-2 * std::log(square) / square);
    }
  }

  /// Shuffles the items; all orders are equally likely.
  template <class Items>
  void shuffle(Items& items) {
    for (auto left = static_cast<std::uint32_t>(items.size()); left > 1; --left) {
      const std::uint32_t other = below(left);
      if (other != left - 1) std::swap(items[left - 1], items[other]);
    }
  }

 private:
  Philox philox_;
  std::uint32_t key_[2];
  std::uint32_t counter_[4];
  std::uint32_t block_[4] = {};
  int used_ = 4;
};

}  // namespace evodevo
