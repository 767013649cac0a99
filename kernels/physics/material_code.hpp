// The code of 48 bits that a spring carries where its material is computed, as the host writes and the GPU reads it.
#pragma once

#include <cstdint>

namespace evodevo {

/// A material in units of its body's (computed_materials.hpp).
struct MaterialCode {
  std::uint32_t stiffness;  ///< 16 bits
  std::uint32_t wave;       ///< from the highest: 12 bits of phase, 10 of amplitude, 10 of frequency
};

inline constexpr double turn = 2 * 3.14159265358979323846;  // rad
inline constexpr unsigned phase_shift = 20, amplitude_shift = 10;
inline constexpr std::uint32_t phase_mask = 0xfff00000;  ///< these bits in place are the phase in turns/2^32
inline constexpr std::uint32_t amplitude_mask = 0x000ffc00;
inline constexpr std::uint32_t frequency_mask = 0x000003ff;

}  // namespace evodevo
