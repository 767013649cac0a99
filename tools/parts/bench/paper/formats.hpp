// What the host and the device say to each other about the paper's methods: all bodies in one buffer of masses and one
// of springs (paper, section IV-C3).
#pragma once

#include <cstdint>

#include "cuda/layout/formats.hpp"

namespace evodevo::tools::bench {

/// How stress is recorded (paper, section IV-D1).
enum class StressMethod {
  none,
  sums,        ///< every spring's |force| is added to its sum in global memory, in every step
  extremes,    ///< every step adds one to the counters of the body's most and least stressed spring
  skip_shift,  ///< every `skip` steps each thread adds one to the counters of the most and least stressed of the
               ///< springs that it works on, which are then dealt out to the threads anew
};

/// Where a body lies in the buffers.
struct PaperBody {
  std::uint32_t first_mass, masses, first_spring, springs;
};

struct alignas(16) PaperSpring {
  std::uint32_t a, b;   ///< masses, counted from the body's first
  float rest_length;    ///< m
  std::uint32_t entry;  ///< of the table
};

struct PaperBatch {
  const PaperBody* bodies;
  const PaperSpring* springs;
  const float* mass;                ///< kg
  const float* inverse_mass;        ///< 1/kg, 0 for what never moves
  cuda::Point<float>* positions;    ///< m
  cuda::Point<float>* velocities;   ///< m/s
  cuda::Point<float>* forces;       ///< N; in global memory's method alone
  const cuda::Entry<float>* table;  ///< [steps][entries] k in N/m
  float* stress;                    ///< [springs] sum of |force|, N
  std::uint32_t *least, *most;      ///< [springs] counters
  std::uint32_t entries;
};

}  // namespace evodevo::tools::bench
