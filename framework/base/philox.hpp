// The counter-based random number generator that Rng uses.
#pragma once

#include "evodevo/rng.hpp"

namespace evodevo {

/// Computes one block of Philox 4x32 with 10 rounds (Salmon et al. 2011), using the library Random123.
void philox(const std::uint32_t* counter, const std::uint32_t* key, std::uint32_t* out);

/// The numbers of the RNG streams (StreamKey::position). Each part of the pipeline draws from its own stream. Each
/// crossover and each mutation operator of an experiment has one stream, and each devo operator has one for each cycle.
namespace rng_stream {
inline constexpr std::uint32_t newborn = 1;
inline constexpr std::uint32_t parents = 2;
inline constexpr std::uint32_t survivors = 3;
inline constexpr std::uint32_t variation = 4;  ///< choice of the operators that vary a child
inline constexpr std::uint32_t scenario = 5;   ///< noise and damage of a scenario
inline constexpr std::uint32_t island = 6;     ///< seeds of islands
inline constexpr std::uint32_t emigrants = 7;  ///< choice of those who leave an island at random
inline constexpr std::uint32_t replaced = 8;   ///< choice of those whose place immigrants take
inline constexpr std::uint32_t birth_noise = 9;
inline constexpr std::uint32_t signal = 10;  ///< choice of robots and mates that are measured
inline constexpr std::uint32_t perturbation = 0x10;    ///< first of the streams of perturbations
inline constexpr std::uint32_t crossover = 0x100;      ///< stream of the first crossover operator
inline constexpr std::uint32_t mutation = 0x200;       ///< stream of the first mutation operator
inline constexpr std::uint32_t first_section = 0x300;  ///< stream of the first genes of the first section
/// Returns the stream of the genes that a random individual has in a section. The encoding's is that of newborns.
constexpr std::uint32_t section(std::uint32_t index) { return index == 0 ? newborn : first_section + index; }
/// Returns the stream to use instead of `stream` for a newborn that is made again after `times` attempts were clones.
constexpr std::uint32_t again(std::uint32_t stream, std::uint32_t times) { return stream + (times << 16); }
constexpr std::uint32_t devo(std::size_t op, std::int64_t cycle) {
  return static_cast<std::uint32_t>(op + 1) << 24 | static_cast<std::uint32_t>(cycle);
}
inline constexpr std::int64_t most_cycles = (1 << 24) - 1;
inline constexpr std::size_t most_operators = 0xfb;
/// The streams of the controls and of the stress tallies come after those of the last possible devo operator.
constexpr std::uint32_t mass_shuffle(std::int64_t cycle) { return devo(most_operators, cycle); }
constexpr std::uint32_t random_places(std::int64_t cycle) { return devo(most_operators + 1, cycle); }
constexpr std::uint32_t stress_tallies(std::int64_t cycle) { return devo(most_operators + 2, cycle); }
constexpr std::uint32_t stress_shuffle(std::int64_t cycle) { return devo(most_operators + 3, cycle); }
}  // namespace rng_stream

}  // namespace evodevo
