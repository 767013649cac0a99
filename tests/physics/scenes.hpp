// Tasks of one batch in scenes of their own.
#pragma once

#include "hard_cases.hpp"
#include "support.hpp"

namespace evodevo::test {

/// Simulates a batch whose bodies have different scenes, and expects for each the bits, the samples and the verdict
/// that a simulator of its scene gives.
void expect_tasks_in_their_own_scenes(const SimulatorFactory& simulator_for);

}  // namespace evodevo::test
