// The counter-based random numbers behind Rng.
#pragma once

#include "evodevo/rng.hpp"

namespace evodevo {

/// Philox 4x32 with 10 rounds (Salmon et al. 2011), by Random123.
void philox(const std::uint32_t* counter, const std::uint32_t* key, std::uint32_t* out);

/// Which part of the pipeline a stream of random numbers belongs to. Operators that stand in lists take as many
/// places as the list is long; the devo operators one for each cycle.
namespace place {
inline constexpr std::uint32_t newborn = 1;
inline constexpr std::uint32_t parents = 2;
inline constexpr std::uint32_t survivors = 3;
inline constexpr std::uint32_t variation = 4;       ///< which operators a child goes through
inline constexpr std::uint32_t disturbance = 0x10;  ///< and on, of starts that differ by noise
inline constexpr std::uint32_t crossover = 0x100;
inline constexpr std::uint32_t mutation = 0x200;
/// The place of what is drawn once more, where a newborn has come out as a clone so many times.
constexpr std::uint32_t again(std::uint32_t place, std::uint32_t times) { return place + (times << 16); }
constexpr std::uint32_t devo(std::size_t op, std::int64_t cycle) {
  return static_cast<std::uint32_t>(op + 1) << 24 | static_cast<std::uint32_t>(cycle);
}
inline constexpr std::int64_t most_cycles = (1 << 24) - 1;
inline constexpr std::size_t most_operators = 0xfc;
/// The controls and tallies of stress take the places behind the last devo operator.
constexpr std::uint32_t random_places(std::int64_t cycle) { return devo(most_operators, cycle); }
constexpr std::uint32_t stress_tallies(std::int64_t cycle) { return devo(most_operators + 1, cycle); }
constexpr std::uint32_t stress_shuffle(std::int64_t cycle) { return devo(most_operators + 2, cycle); }
}  // namespace place

}  // namespace evodevo
