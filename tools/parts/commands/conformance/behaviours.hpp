// Behaviours of bodies, made up at random, for fitness operators to score.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "evodevo/fitness.hpp"

namespace evodevo::conformance {

/// What a body did in the window of a fitness operator, with what the observation refers to.
struct SampleBehaviour {
  std::shared_ptr<const BodyVersion> version;
  std::vector<StoredSample> samples;
  Observation observation;
};
/// Returns what a body at a random place did, moved by `place` (m).
SampleBehaviour sample_behaviour(const Request& request, std::uint64_t seed, std::uint32_t input, Vec3 place = {});
/// Returns a behaviour in which everything measured is NaN.
SampleBehaviour unmeasurable_behaviour(const Request& request);

}  // namespace evodevo::conformance
