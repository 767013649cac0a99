// Computes samples from the state of a body.
#pragma once

#include "core/sample.hpp"
#include "evodevo/body.hpp"

namespace evodevo {

/// Returns the sample of a body with the given state at `time` (s since birth), with the requested channels except
/// those of contact and work, which are counted while the body moves.
Sample sample_of(const Body& body, const State& state, double time, Channels channels);

}  // namespace evodevo
