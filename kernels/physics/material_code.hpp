// The 48-bit code that gives a spring its material when materials are computed. The host writes the code, and the GPU
// decodes it.
#pragma once

#include <cstdint>

namespace evodevo {

/// A material as whole multiples of the body's units (MaterialUnits in analysis/computed_materials.hpp).
struct MaterialCode {
  std::uint32_t stiffness;  ///< 16 bits
  std::uint32_t wave;       ///< from the highest bit down: 12 bits of phase, 10 of amplitude, 10 of frequency
};

inline constexpr double full_turn = 2 * 3.14159265358979323846;  // one turn, rad
inline constexpr unsigned phase_shift = 20, amplitude_shift = 10;
inline constexpr std::uint32_t phase_mask =
    0xfff00000;  ///< the word with only these bits set is the phase in units of 2^-32 turns
inline constexpr std::uint32_t amplitude_mask = 0x000ffc00;
inline constexpr std::uint32_t frequency_mask = 0x000003ff;

}  // namespace evodevo
