// Whether champions keep their fitness when they are simulated again in other ways.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/simulator.hpp"
#include "life/evaluation.hpp"

namespace evodevo {

/// The final evaluation of a matured body, repeated with one thing changed.
struct Trial {
  std::string name;  ///< one of those that verify() makes
  Status status = Status::ok;
  std::string reason;           ///< of a status other than ok
  std::optional<double> value;  ///< the first objective; none unless ok
};

/// An individual to verify: how it is simulated again, and its first objective, as the run recorded it.
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

/// Lets champions mature as in the run, on `simulator`, and repeats the final evaluation
///   again         as it was;
///   quarter-step  with a quarter of the time step in double precision;
///   other-method  with a quarter of each body's own step in double precision by velocity-verlet (symplectic-euler
///                 where the run has that);
///   perturbed-1   to -3: each mass moved along each axis at random by up to 1e-4 of the body's longest side;
///   no-muscles    with springs that keep their length;
///   settled       with windows that open 10 s later.
/// The second and third run on the CPU. The same on the same device, every time.
std::vector<Verification> verify(const Experiment& experiment, Simulator& simulator,
                                 std::span<const Champion> champions);

/// Whether a trial's value is at least half the fitness; where less is better, or the fitness is not above 0, within
/// half of it. No value is never enough.
bool held(const Verification& verification, const Trial& trial, bool maximise);

/// What an individual turned out to be:
///   artefact  of the time step: quarter-step or other-method did not hold;
///   passive   without muscles it keeps over half its fitness, or after 10 s more it has lost over half; only where
///             more is better and the fitness is above 0.
std::vector<std::string> marks(const Verification& verification, bool maximise);
/// "passive", or "verified" where nothing is to be said.
std::string marks_text(const Verification& verification, bool maximise);

}  // namespace evodevo
