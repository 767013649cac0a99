// Computed materials: each spring carries its material as a code, which is decoded in registers (paper, section V), and
// the coefficient of its dashpot. A step needs only one number for all springs, the clock: the phase of an oscillation
// with the body's unit of frequency.
//
//   clock, code ─► angle ─► stiffness, length of the spring now
#pragma once

#include "cuda/device/resident.cuh"
#include "physics/material_code.hpp"

namespace evodevo::cuda {

/// The records, codes and coefficients of the springs, beginning with a given spring.
struct Records {
  struct Read : Record<Number> {
    unsigned wave;       // MaterialCode::wave
    Number coefficient;  // of the dashpot
  };
  const Record<Number>* first;
  const std::uint32_t* first_wave;
  const Number* first_coefficient;

  __device__ __forceinline__ Read operator[](unsigned i) const {
    Read read{first[i], 0, 0};
    if constexpr (actuation) read.wave = first_wave[i];
    if constexpr (dashpots) read.coefficient = first_coefficient[i];
    return read;
  }
  __device__ __forceinline__ Records from(unsigned slot) const {
    return {first + slot, first_wave + slot, first_coefficient + slot};
  }

  static __device__ __forceinline__ Records of(const Body& body) {
    return {array_of(body.records, body.record_offset), array_of(body.waves, body.wave_offset),
            array_of(body.coefficients, body.coefficient_offset)};
  }
  /// Copies what belongs on the chip. `count`: number of records.
  static __device__ __forceinline__ void load(const Body& body, unsigned count) {
    if constexpr (records_on_chip) {
      copy_to_chip(body.records, body.record_offset, count);
      if constexpr (actuation) copy_to_chip(body.waves, body.wave_offset, count);
      if constexpr (dashpots) copy_to_chip(body.coefficients, body.coefficient_offset, count);
    }
  }
};

/// A spring's material in a pass.
struct SpringMaterial {
  unsigned wave;
  Number coefficient;
  Entry<Number> entry;
};

/// The lengths of one pass.
struct Lengths {
  const CodeUnits<Number>& units;
  unsigned row;    // offset of the clock's reading in shared memory
  unsigned clock;  // phase in units of 2^-32 turns, without whole turns

  __device__ __forceinline__ explicit Lengths(const Body& body)
      : units(body.units), row(body.table_offset), clock(on_chip<unsigned>(row)) {}

  /// The phase of a spring's actuation, rad, from -pi to pi. Integer overflow drops whole turns.
  __device__ __forceinline__ Number angle(unsigned wave) const {
    const unsigned turns = (wave & phase_mask) + (wave & frequency_mask) * clock;
    return static_cast<Number>(static_cast<int>(turns)) * Number(full_turn * 0x1p-32);
  }

  __device__ __forceinline__ Number amplitude(unsigned wave) const {
    return static_cast<Number>(wave & amplitude_mask) * units.amplitude;
  }

  __device__ __forceinline__ SpringMaterial operator()(const Records::Read& read) const {
    const Number stiffness = static_cast<Number>(read.packed >> 16) * units.stiffness;
    Number length = 1;  // L/L0
    if constexpr (actuation) length = physics::multiply_add(amplitude(read.wave), __sinf(angle(read.wave)), length);
    return {read.wave, read.coefficient, {stiffness, stiffness * length}};
  }

  /// The rate of change of L/L0, 1/s.
  template <class T>
  __device__ __forceinline__ Number rate_of(const T& material) const {
    static_assert(only_for<work, T>);
    Number rate = 0;
    if constexpr (actuation)
      rate = amplitude(material.wave) * __cosf(angle(material.wave)) *
             (static_cast<Number>(material.wave & frequency_mask) * units.angular_frequency);
    return rate;
  }

  /// The coefficient of the dashpot, units of force s/m.
  template <class T>
  __device__ __forceinline__ Number damping_of(const T& material) const {
    static_assert(only_for<dashpots, T>);
    return material.coefficient;
  }

  __device__ __forceinline__ void advance_rows(const Body&, unsigned rows_on) {
    row += rows_on * sizeof(unsigned);
    clock = on_chip<unsigned>(row);
  }
};

/// Sets the clock for `count` rows, beginning with step `step` of the piece. The phase is computed in double precision,
/// so that late times lose no digits.
__device__ __noinline__ void fill_lengths(const Body& body, std::uint64_t step, unsigned count) {
  const double interval = body.constants.exact_dt / rows_per_step;
  const std::uint64_t row = (body.piece.first_step + step) * rows_per_step;
  for (unsigned i = threadIdx.x; i < count; i += blockDim.x) {
    const double time = body.piece.origin + static_cast<double>(row + i) * interval;
    const double turns = body.units.frequency * time;
    on_chip<unsigned>(body.table_offset + i * sizeof(unsigned)) =
        static_cast<unsigned>(__double2ull_rn((turns - floor(turns)) * 0x1p32));
  }
}

}  // namespace evodevo::cuda
