// A simulation in several pieces must equal the simulation as a whole.
#pragma once

#include <vector>

#include "hard_cases.hpp"
#include "support.hpp"

namespace evodevo::test {

/// Simulates every body as a whole and in uneven pieces, with a start time and a time step that are not exact binary
/// fractions. Expects bit-identical states.
void expect_pieces_to_be_the_whole(const SimulatorFactory& simulator_for, const std::vector<Body>& bodies);

/// Expects the same state after a simulation with tallies, whose pieces are the steps between two tallies.
void expect_tallies_to_leave_the_motion_alone(const SimulatorFactory& simulator_for, const Body& body);

/// Expects that bodies diverge at the same time and for the same reason whether they are simulated as a whole or in
/// pieces, and whichever quantities are recorded.
void expect_one_verdict(const SimulatorFactory& simulator_for, Method method);

/// Expects that the guard checks energy at the end of the whole run, but not at the end of a piece.
void expect_no_check_between_pieces(const SimulatorFactory& simulator_for);

}  // namespace evodevo::test
