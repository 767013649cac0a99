// The data that the host and the device exchange for the paper's methods. The masses of all bodies lie in one buffer,
// and their springs in another (paper, section IV-C3).
#pragma once

#include <cstdint>

#include "cuda/layout/formats.hpp"

namespace evodevo::tools::bench {

/// How stress is recorded (paper, section IV-D1).
enum class StressMethod {
  none,
  sums,        ///< in every step, the |force| of every spring is added to its sum in global memory
  extremes,    ///< in every step, the counters of the body's most and least stressed springs are incremented
  skip_shift,  ///< every `skip` steps, the springs are distributed over the threads in a new random order, and each
               ///< thread increments the counters of the most and the least stressed of its springs
};

/// The location of a body in the buffers.
struct PaperBody {
  std::uint32_t first_mass, masses, first_spring, springs;
};

struct alignas(16) PaperSpring {
  std::uint32_t a, b;   ///< masses at its ends, counted from the first mass of the body
  float rest_length;    ///< m
  std::uint32_t entry;  ///< index of its material in a row of the table
};

struct PaperBatch {
  const PaperBody* bodies;
  const PaperSpring* springs;
  const float* mass;                ///< kg
  const float* inverse_mass;        ///< 1/kg; 0 for masses that never move
  cuda::Point<float>* positions;    ///< m
  cuda::Point<float>* velocities;   ///< m/s
  cuda::Point<float>* forces;       ///< N; used only by the global-memory method
  const cuda::Entry<float>* table;  ///< [steps][entries] state of each material; stiffness in N/m
  float* stress;                    ///< [springs] sum of |force| over steps, N
  std::uint32_t *least, *most;      ///< [springs] counters of how often a spring was the least or the most stressed
  std::uint32_t entries;
};

}  // namespace evodevo::tools::bench
