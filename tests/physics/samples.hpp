// Samples must not change a run, and must be true.
#pragma once

#include <vector>

#include "hard_cases.hpp"
#include "support.hpp"

namespace evodevo::test {

/// Simulates every body without samples, with all channels, and with each channel alone. Expects bit-identical states,
/// records and work, and the same verdict.
void expect_samples_to_change_nothing(const SimulatorFactory& simulator_for, const std::vector<Body>& bodies);

/// Expects that samples of a body agree with the states of runs that end at the same steps, and with the work and the
/// contacts counted there. Numbers of double precision may differ by `rounding` times their largest value. `materials`
/// says how the simulator's springs get their materials.
void expect_samples_to_be_true(const SimulatorFactory& simulator_for, const Body& body, double rounding,
                               Materials materials = Materials::table);

/// Expects the same of bodies that have lost masses since they were simulated last.
void expect_samples_to_be_true_after_removals(const SimulatorFactory& simulator_for, double rounding);

/// Expects that a body which is sampled in pieces has the samples of the whole.
void expect_samples_in_pieces(const SimulatorFactory& simulator_for, const Body& body);

/// Expects that a dropped mass touches the ground when it has fallen for sqrt(2 h/g), and that a held mass below the
/// ground always touches it. `rough` adds hills.
void expect_contact_from_the_landing_on(const SimulatorFactory& simulator_for, bool rough);

}  // namespace evodevo::test
