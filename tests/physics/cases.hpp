// What simulators on all devices must do: cases in which methods can fail, motion near the guard's bound, simulations
// in several pieces, samples, and tasks in scenes of their own.
#pragma once

#include <functional>

#include "support.hpp"

namespace evodevo::test {

enum class Outcome { right, flagged, right_or_flagged };

struct HardCase {
  std::string name;
  Body body;
  State start;
  Scene scene;
  double dt = 0.0005;  ///< time step [s]
  std::uint64_t steps = 0;
  Outcome outcome = Outcome::right;
  /// Largest energy at the end, if the body is not flagged, relative to the sum of initial energy and the muscles'
  /// work.
  double most_gain = 1.05;
  std::function<void(const State& end)> check = [](const State&) {};  ///< expectations if the body is not flagged
};

/// Returns the cases for one method; some steps and outcomes depend on its stability limits.
std::vector<HardCase> hard_cases(Method method);

/// Simulates every case in a batch with two other bodies. Expects the outcome of the case and, for the other bodies,
/// the same bits as when each is simulated alone. `rounding` is the energy that rounding may add to a body at rest, J.
void expect_outcomes(const std::vector<HardCase>& cases, const SimulatorFactory& simulator_for, double rounding = 1e-6);

/// Simulates bodies whose muscle is driven at resonance. Expects that the guard stops none of them and that, with
/// methods without numerical damping, the energy is that of the closed form, which is more than strain alone could
/// give.
void expect_resonance_to_live(const SimulatorFactory& simulator_for, Method method);

/// Simulates bodies that gain energy because the floor is too stiff for the time step. Expects that the guard stops
/// some of them, but none if the time step is short.
void expect_pumped_bodies_to_end(const SimulatorFactory& simulator_for);

/// Expects that the bound after several short runs is the same as after one long run, and equals the closed form in
/// guard.hpp.
void expect_one_bound(const SimulatorFactory& simulator_for);

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

/// Simulates every body without samples, with all channels, and with each channel alone. Expects bit-identical states,
/// records and work, and the same verdict. Records do not change each other, either.
void expect_samples_to_change_nothing(const SimulatorFactory& simulator_for, const std::vector<Body>& bodies);

/// Expects that samples of a body agree with the states of runs that end at the same steps, and with the work and the
/// contacts counted there. Numbers of double precision may differ by `rounding` times their largest value. `materials`
/// says how the simulator's springs get their materials.
void expect_samples_to_be_true(const SimulatorFactory& simulator_for, const Body& body, double rounding,
                               Materials materials = Materials::table);

/// Expects the same of bodies that have lost masses since they were simulated last.
void expect_samples_to_be_true_after_removals(const SimulatorFactory& simulator_for, double rounding);

/// Expects that all channels are the same, but for work (J), which may be off.
void expect_same_samples(const Sample& a, const Sample& b, double off_work = 0);

/// Expects that a body which is sampled in pieces has the samples of the whole.
void expect_samples_in_pieces(const SimulatorFactory& simulator_for, const Body& body);

/// Expects that a dropped mass touches the ground when it has fallen for sqrt(2 h/g), and that a held mass below the
/// ground always touches it; on level ground and on hills.
void expect_contact_from_the_landing_on(const SimulatorFactory& simulator_for);

/// Simulates a batch whose bodies have different scenes, and expects for each the bits, the samples and the verdict
/// that a simulator of its scene gives.
void expect_tasks_in_their_own_scenes(const SimulatorFactory& simulator_for);

}  // namespace evodevo::test
