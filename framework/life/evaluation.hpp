// From genomes to scores, for whole batches.
#pragma once

#include <span>
#include <vector>

#include "life/birth.hpp"
#include "life/development.hpp"
#include "life/life.hpp"
#include "life/life_simulation.hpp"
#include "life/measurement.hpp"

namespace evodevo {

/// The time in which evaluations were in a phase, s. Phases overlap: while some bodies move, others develop.
struct PhaseTimes {
  double decode = 0, simulate = 0, develop = 0;
};

/// The stages of a life, and all of them one after the other: a genome passes through each once.
///
///   newborns -> birth -> development -> measurement -> results
///                  \________ all move by ________/
///                            simulation
///
/// A batch goes through them in as many cohorts as the simulator wants to have at once. Experiment and simulator must
/// outlive it.
class Evaluation {
 public:
  Evaluation(const Experiment& experiment, Simulator& simulator);
  Evaluation(const Experiment& experiment, Simulator& simulator, const Conditions& conditions);
  Evaluation(const Evaluation&) = delete;  // the stages refer to each other
  Evaluation& operator=(const Evaluation&) = delete;

  /// The results are in the newborns' order and independent of the batch. `progress` is called with the part of the
  /// simulation that is done, 0 to 1, by one thread at a time.
  std::vector<Result> evaluate(std::span<const Newborn> newborns, const Progress& progress) const;

  PhaseTimes phase_times() const { return {birth.seconds(), simulation.seconds(), development.seconds()}; }

  const LifeSimulation simulation;
  const Birth birth;
  const DevelopmentLoop development;
  const Measurement measurement;

 private:
  std::vector<Result> evaluate_cohort(std::span<const Newborn> newborns, const Progress& progress) const;
};

}  // namespace evodevo
