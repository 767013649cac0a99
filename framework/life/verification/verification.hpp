// Verification: checks whether the best individuals keep their fitness when they are simulated in other ways.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/simulator.hpp"
#include "life/evaluation.hpp"
#include "life/verification/verdict.hpp"

namespace evodevo {

/// An individual to verify in the lives that selection has seen, and its first objective in them.
struct Champion {
  Newborn newborn;
  double fitness = 0;
};

/// Whether the first objective is measured after maturing. verify() repeats only that part of a life, so that it can
/// say nothing of an objective that is measured within the life.
bool is_verifiable(const Experiment& experiment);

/// Simulators in double precision, for the trials quarter-step and other-method.
struct ExactSimulators {
  std::unique_ptr<Simulator> same_method, other_method;
};

/// Makes the simulators for verify_marks() on the device of `simulator`, with threads of their own. Throws
/// std::runtime_error if the device can no longer be used.
ExactSimulators exact_simulators(const Experiment& experiment, const Simulator& simulator);

/// Which lives of champions are verified: those that selection has seen and those to come, or only those seen.
enum class VerifiedLives { seen_and_to_come, seen };

/// Simulates the development of champions as in the run, on `simulator`, in all lives. Then repeats the final
/// evaluations in the following trials, and combines them as in the run:
///   again         unchanged;
///   quarter-step  with a quarter of the time step in double precision;
///   other-method  with a quarter of each body's own step in double precision by velocity-verlet (symplectic-euler
///                 if the run uses velocity-verlet);
///   perturbed-1   to -3: each mass moved along each axis at random by up to `perturbation` of the body's longest side;
///   no-muscles    with muscles that are not actuated;
///   settled       with windows that open 10 s later.
/// Lives to come are simulated from birth on, each with noise, damage and birth noise of its own; if the experiment has
/// no birth noise, masses are moved as in perturbed-1. If robots develop, or are born with noise:
///   reborn-1      to -4: a life to come with the draws of development that the run has used.
/// If robots develop:
///   redrawn-1     to -4: a life to come with draws of development of its own.
/// quarter-step and other-method run on the CPU, so that they are independent of a GPU. All trials run at the same
/// time. Results on the same device are the same every time.
std::vector<Verification> verify(const Experiment& experiment, Simulator& simulator,
                                 std::span<const Champion> champions,
                                 VerifiedLives lives = VerifiedLives::seen_and_to_come);

/// Like verify(), but only with the trials on which marks() depends, and no further than to the first mark: no-muscles
/// and settled, then quarter-step, then other-method. If Settings::verify_front asks for it, new-lives comes with the
/// first two: lives to come, as many as the champion has had, but at least three, with draws of development as the
/// experiment gives them to its lives, combined as in the run. quarter-step and other-method run on `exact`. They have
/// many short steps; on a CPU, they would take far longer than a GPU needs for all evaluations of a generation. If at
/// most `most_at_once` champions are left then, both are made at the same time, which is sooner done but more work.
/// That changes no first mark.
std::vector<Verification> verify_marks(const Experiment& experiment, Simulator& simulator, const ExactSimulators& exact,
                                       std::span<const Champion> champions, std::size_t most_at_once);

}  // namespace evodevo
