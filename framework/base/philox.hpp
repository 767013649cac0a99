// The counter-based random numbers behind Rng.
#pragma once

#include "evodevo/rng.hpp"

namespace evodevo {

/// Philox 4x32 with 10 rounds (Salmon et al. 2011), by Random123.
void philox(const std::uint32_t* counter, const std::uint32_t* key, std::uint32_t* out);

/// The streams of random numbers of an individual, by number: each part of the pipeline draws from one of its own.
/// Operators that stand in lists have a stream each; devo operators one for each cycle.
namespace rng_stream {
inline constexpr std::uint32_t newborn = 1;
inline constexpr std::uint32_t parents = 2;
inline constexpr std::uint32_t survivors = 3;
inline constexpr std::uint32_t variation = 4;        ///< which operators a child goes through
inline constexpr std::uint32_t perturbation = 0x10;  ///< and on, of starts that differ by noise
inline constexpr std::uint32_t crossover = 0x100;
inline constexpr std::uint32_t mutation = 0x200;
/// The stream from which a newborn is drawn once more, after it has come out as a clone so many times.
constexpr std::uint32_t again(std::uint32_t stream, std::uint32_t times) { return stream + (times << 16); }
constexpr std::uint32_t devo(std::size_t op, std::int64_t cycle) {
  return static_cast<std::uint32_t>(op + 1) << 24 | static_cast<std::uint32_t>(cycle);
}
inline constexpr std::int64_t most_cycles = (1 << 24) - 1;
inline constexpr std::size_t most_operators = 0xfc;
/// The controls and tallies of stress have the streams behind those of the last devo operator.
constexpr std::uint32_t random_places(std::int64_t cycle) { return devo(most_operators, cycle); }
constexpr std::uint32_t stress_tallies(std::int64_t cycle) { return devo(most_operators + 1, cycle); }
constexpr std::uint32_t stress_shuffle(std::int64_t cycle) { return devo(most_operators + 2, cycle); }
}  // namespace rng_stream

}  // namespace evodevo
