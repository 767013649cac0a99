// Evaluates batches of genomes: makes bodies, simulates their lives, and computes the objectives.
#pragma once

#include <span>
#include <vector>

#include "life/birth.hpp"
#include "life/development.hpp"
#include "life/life.hpp"
#include "life/life_simulation.hpp"
#include "life/measurement/measurement.hpp"

namespace evodevo {

/// Wall-clock time in which at least one evaluation was in a phase, s. Phases overlap, because some bodies are
/// simulated while others are changed.
struct PhaseTimes {
  double decode = 0, simulate = 0, develop = 0;
};

/// A cohort with fewer newborns would not repay the overhead of a batch of the simulator.
inline constexpr std::size_t smallest_cohort = 12;
/// A cohort with so many newborns does its part to keep a GPU busy.
inline constexpr std::size_t large_cohort = 64;

/// The stages of a life. evaluate() sends each newborn through all of them, one after the other:
///
///   newborns -> birth -> development -> measurement -> results
///                  \_______ all three use _______/
///                            simulation
///
/// Newborns also develop in the scenarios that ask for it, in lives of their own. A batch is divided into cohorts, each
/// with all lives of its newborns: while some cohorts are simulated, others develop. Experiment and simulator must
/// outlive this object.
class Evaluation {
 public:
  Evaluation(const Experiment& experiment, Simulator& simulator);
  Evaluation(const Experiment& experiment, Simulator& simulator, const Conditions& conditions);
  Evaluation(const Evaluation&) = delete;  // the stages refer to each other
  Evaluation& operator=(const Evaluation&) = delete;

  /// Returns the results in the order of the newborns. The result of a newborn is that of all its lives, as
  /// of_all_lives() combines them, and does not depend on the others in the batch. Calls `progress` with the fraction
  /// of the simulation that is done, 0 to 1, from one thread at a time.
  std::vector<Result> evaluate(std::span<const Newborn> newborns, const Progress& progress) const;
  /// The same in so many cohorts, 1 or more, for callers that evaluate several batches at the same time.
  std::vector<Result> evaluate_in(std::size_t cohorts, std::span<const Newborn> newborns,
                                  const Progress& progress) const;

  /// Lets newborns develop in each scene until they have matured. The spring evaluations in scenarios count in the
  /// results of Cohort::lives. Calls `progress` as DevelopmentLoop::run() does.
  Cohort matured(Cohort born, const Progress& progress) const;

  PhaseTimes phase_times() const { return {birth.seconds(), simulation.seconds(), development.seconds()}; }

  const LifeSimulation simulation;
  const Windows windows;
  const Birth birth;
  const DevelopmentLoop development;
  const Measurement measurement;

 private:
  std::vector<Result> evaluate_cohort(std::span<const Newborn> newborns, const Progress& progress) const;

  const Experiment& experiment_;
};

}  // namespace evodevo
