// A run in pieces is the run in one.
#pragma once

#include <vector>

#include "hard_cases.hpp"
#include "support.hpp"

namespace evodevo::test {

/// Moves every body whole and in uneven pieces, from a start time and with a step that are no sums of powers of two,
/// and expects the same state to the bit.
void expect_pieces_to_be_the_whole(const SimulatorFactory& simulator_for, const std::vector<Body>& bodies);

/// The same of the tallies' run, whose pieces are the steps between two tallies.
void expect_tallies_to_leave_the_motion_alone(const SimulatorFactory& simulator_for, const Body& body);

/// Expects of bodies that diverge the same moment and reason whole and in pieces, whatever is recorded.
void expect_one_verdict(const SimulatorFactory& simulator_for, Method method);

/// Expects that the end of a piece is no check, but the end of the whole is.
void expect_no_check_between_pieces(const SimulatorFactory& simulator_for);

}  // namespace evodevo::test
