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

namespace evodevo {

/// The result of repeating the final evaluation of a matured body with one thing changed.
struct Trial {
  std::string name;  ///< name of one of the trials listed at verify()
  Status status = Status::ok;
  std::string reason;           ///< reason for a status other than ok
  std::optional<double> value;  ///< the first objective; none unless ok
};

/// An individual to verify, and its first objective as the run recorded it.
struct Champion {
  Newborn newborn;
  double fitness = 0;
};

/// An individual's trials, and the fitness that its original evaluation found.
struct Verification {
  std::uint32_t individual = 0;
  double fitness = 0;  ///< the first objective, as the run recorded it
  std::vector<Trial> trials;
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

/// Simulates the development of champions as in the run, on `simulator`. Then repeats the final evaluation in the
/// following trials:
///   again         unchanged;
///   quarter-step  with a quarter of the time step in double precision;
///   other-method  with a quarter of each body's own step in double precision by velocity-verlet (symplectic-euler
///                 if the run uses velocity-verlet);
///   perturbed-1   to -3: each mass moved along each axis at random by up to 1e-4 of the body's longest side;
///   no-muscles    with muscles that are not actuated;
///   settled       with windows that open 10 s later.
/// If robots develop, their whole lives are repeated as well:
///   reborn-1      to -3: from birth on, with masses moved as in perturbed-1, and with other random numbers.
/// quarter-step and other-method run on the CPU, so that they are independent of a GPU. All trials run at the same
/// time. Results on the same device are the same every time.
std::vector<Verification> verify(const Experiment& experiment, Simulator& simulator,
                                 std::span<const Champion> champions);

/// Like verify(), but only with the trials on which marks() depends, and no further than to the first mark: no-muscles
/// and settled, then quarter-step, then other-method. The last two run on `exact`. They have many short steps; on a
/// CPU, they would take far longer than a GPU needs for all evaluations of a generation. If at most `most_at_once`
/// champions are left then, both are made at the same time, which is sooner done but more work. That changes no first
/// mark.
std::vector<Verification> verify_marks(const Experiment& experiment, Simulator& simulator, const ExactSimulators& exact,
                                       std::span<const Champion> champions, std::size_t most_at_once);

/// Whether an individual keeps its fitness in a trial: the trial's value is as good as the fitness, better, or worse by
/// at most half of the fitness's absolute value. False if the trial has no value.
bool held(const Verification& verification, const Trial& trial, bool maximise);

/// Returns the marks of an individual, which are found from its trials:
///   artefact  its fitness depends on the time step or the method: it is lost in quarter-step or other-method;
///   passive   it keeps over half its fitness in no-muscles, or loses over half in settled; only if the objective is
///             maximised and the fitness is above 0.
/// The names are in alphabetical order.
std::vector<std::string> marks(const Verification& verification, bool maximise);
/// A mark of an individual, as a status, and the trial from which it was found.
struct Mark {
  Status status = Status::artefact;  ///< artefact or passive
  Trial trial;
};
/// Returns the first mark that an individual gets in the order of the trials in verify_marks(); nullopt if it has none.
std::optional<Mark> first_mark(const Verification& verification, bool maximise);
/// Returns the marks as a text, such as "artefact, passive"; "verified" if there are none.
std::string marks_text(const Verification& verification, bool maximise);
/// Returns what the trials say of the individual, in this life and in others: its marks and, if it was born again, how
/// often it kept its fitness then, such as "verified in this life, kept in 1 of 3 others".
std::string verdict_text(const Verification& verification, bool maximise);

}  // namespace evodevo
