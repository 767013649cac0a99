// Samples: what a simulator measures of a body at single steps of its motion.
#pragma once

#include <cstdint>
#include <vector>

#include "evodevo/body.hpp"
#include "evodevo/channels.hpp"

namespace evodevo {

/// A step after which a body is sampled, and the channels of the sample.
struct SamplePoint {
  std::uint64_t step = 0;  ///< number of steps since the beginning of the task
  Channels channels;

  friend bool operator==(const SamplePoint&, const SamplePoint&) = default;
};

/// The sample of a body after a step. Quantities whose channels were not requested are zero or empty. Lists by mass and
/// by spring are in the order of the body; their numbers have single precision.
///
/// A mass touches the ground in a step if it is below the surface of an elastic floor after the step, or if a rigid
/// floor has pushed it in the step.
struct Sample {
  double time = 0;  ///< since birth, s
  Vec3 centre;      ///< centre of mass, m
  Vec3 velocity;    ///< velocity of the centre of mass, m/s
  Box box;          ///< bounding box, m
  /// Number of steps since the beginning of the task in which a mass touched the ground, summed over all masses.
  std::uint64_t contact_steps = 0;
  double work = 0;                      ///< work of the muscles on the body since the beginning of the task, J
  std::vector<float> positions;         ///< [masses][3] m
  std::vector<float> velocities;        ///< [masses][3] m/s
  std::vector<std::uint32_t> contacts;  ///< [masses] number of steps, as in contact_steps
  std::vector<float> forces;            ///< [springs] N: positive if the spring pulls, negative if it pushes
};

}  // namespace evodevo
