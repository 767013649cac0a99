// What the generation loop needs to know of individuals, and how one process finds it.
#pragma once

#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "archive/provenance.hpp"
#include "life/evaluation.hpp"
#include "life/verification/verification.hpp"

namespace evodevo {

/// What an evaluator finds of a newborn.
struct Evaluated {
  Result result;                 ///< without its records
  std::uint32_t provenance = 0;  ///< index into Evaluator::provenances()
};

/// Evaluates and verifies individuals. Implementations are LocalEvaluator, for one process, and Farm
/// (cluster/farm.hpp), for many. Results do not depend on the implementation, nor on what else is evaluated, unless the
/// evaluator has several provenances.
class Evaluator {
 public:
  virtual ~Evaluator() = default;

  /// Returns the provenances that results may have, each once. The first one is that of this process.
  virtual std::vector<Provenance> provenances() const = 0;

  /// Returns the results in the order of the newborns, without the records of their lives. These are kept where the
  /// lives were simulated, because the records of a whole population would take too much memory. Calls `progress` with
  /// the fraction that is done, 0 to 1.
  virtual std::vector<Evaluated> evaluate(std::span<const Newborn> newborns, const Progress& progress) = 0;
  /// Returns the records of all lives of newborns, in their order. Lives whose records are not kept are simulated
  /// again, by processes that have the provenance of the newborn's result.
  virtual std::vector<std::vector<LifeRecord>> records(std::span<const Newborn> newborns,
                                                       std::span<const std::uint32_t> provenances) = 0;
  /// Forgets all records that are kept.
  virtual void forget_records() = 0;

  /// Verifies champions as verify_marks() does, by processes that have the provenance of the champion's result. Returns
  /// what it found in their order.
  virtual std::vector<Verification> verify(std::span<const Champion> champions,
                                           std::span<const std::uint32_t> provenances) = 0;
  /// About the number of champions that can be verified in the time that one takes.
  virtual std::size_t verified_at_once() const = 0;

  /// The threads of this process. They may be used while nothing is evaluated, too.
  virtual Workers& workers() = 0;
  /// Of this process.
  virtual PhaseTimes phase_times() const = 0;
};

/// About the number of lives that keep a simulator busy: one for each thread of a CPU, a hundred for a GPU, less
/// those that it simulates already, such as those of other runs of this process.
std::size_t lives_at_once(Simulator& simulator);
/// About the number of champions that one process verifies in the time that one takes, each in all its lives. Two of
/// the four trials take nearly all of the time.
std::size_t verified_at_once(const Experiment& experiment, Simulator& simulator);

/// Evaluates and verifies in this process. Several threads may use it. Experiment and simulator must outlive it.
class LocalEvaluator final : public Evaluator {
 public:
  LocalEvaluator(const Experiment& experiment, Simulator& simulator)
      : experiment_(experiment), simulator_(simulator), evaluation_(experiment, simulator) {}

  std::vector<Provenance> provenances() const override { return {this_provenance(experiment_, simulator_.device())}; }
  std::vector<Evaluated> evaluate(std::span<const Newborn> newborns, const Progress& progress) override;
  /// The same as one cohort, for callers that evaluate several cohorts at the same time.
  std::vector<Evaluated> evaluate_cohort(std::span<const Newborn> newborns, const Progress& progress);
  std::vector<std::vector<LifeRecord>> records(std::span<const Newborn> newborns,
                                               std::span<const std::uint32_t> provenances) override;
  void forget_records() override;
  std::vector<Verification> verify(std::span<const Champion> champions,
                                   std::span<const std::uint32_t> provenances) override;
  std::size_t verified_at_once() const override { return evodevo::verified_at_once(experiment_, simulator_); }
  Workers& workers() override { return simulator_.workers(); }
  PhaseTimes phase_times() const override { return evaluation_.phase_times(); }

 private:
  /// Keeps the records of the lives of these newborns, and returns the rest of the results.
  std::vector<Evaluated> without_records(std::span<const Newborn> newborns, std::vector<Result> results);
  const ExactSimulators& exact();

  const Experiment& experiment_;
  Simulator& simulator_;
  Evaluation evaluation_;
  std::mutex mutex_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<LifeRecord>> kept_;  ///< by id and first life
  ExactSimulators exact_;  ///< made when the first individual is verified
};

}  // namespace evodevo
