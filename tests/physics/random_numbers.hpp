// Random numbers for the bodies and scenes of tests.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "evodevo/body.hpp"

namespace evodevo::test {

/// Random numbers that are the same with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : generator_(seed) {}

  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(generator_() >> 11) * 0x1p-53);
  }
  double of_any_scale(double low, double high) { return low * std::pow(high / low, between(0, 1)); }
  bool chance(double probability) { return between(0, 1) < probability; }
  std::uint32_t below(std::uint32_t end) { return static_cast<std::uint32_t>(generator_() % end); }
  Vec3 vector(double most) { return {between(-most, most), between(-most, most), between(-most, most)}; }

 private:
  std::mt19937_64 generator_;
};

/// Random places in a cube of side 2 m around the origin.
inline std::vector<Vec3> random_places(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3> places(count);
  for (Vec3& place : places) place = random.vector(1);
  return places;
}

}  // namespace evodevo::test
