// From genomes to scores: decode, live, be measured. Works on whole batches.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "busy_clock.hpp"
#include "development.hpp"
#include "experiment.hpp"
#include "parallel.hpp"

namespace evodevo {

/// A genome that asks to be evaluated. Its random numbers depend on the run's seed, the generation and the id alone.
struct Newborn {
  std::uint32_t id = 0;
  std::uint32_t generation = 0;
  const Genome* genome = nullptr;
};

/// How an evaluation ended.
struct Result {
  Status status = Status::ok;
  std::string reason;              ///< of a status other than ok
  double ended_at = 0;             ///< simulated time of a divergence, s
  std::vector<double> objectives;  ///< in Experiment::objectives' order and units; empty unless ok
  std::uint64_t spring_evaluations = 0;
};

/// What the body showed at one point of the final evaluation.
struct Snapshot {
  Box box;
  Vec3 centre;
  double work = 0;  ///< of the muscles since the final evaluation began, J
};

/// A newborn's whole way.
struct Life {
  Newborn newborn;
  LivingBody living;
  std::vector<Snapshot> snapshots;
  Result result;

  bool alive() const { return result.status == Status::ok; }
};

/// Takes the part of a job that is done, 0 to 1.
using Progress = std::function<void(double)>;

/// The time in which evaluations were in a phase, s. Phases overlap: while some bodies move, others develop.
struct PhaseTimes {
  double decode = 0, simulate = 0, develop = 0;
};

/// Evaluates batches of genomes for an experiment. A batch goes through life in as many cohorts as the simulator wants
/// to have at once. Experiment and simulator must outlive it.
class Evaluation {
 public:
  Evaluation(const Experiment& experiment, Simulator& simulator);

  /// Decodes, develops, measures and scores. The results are in the newborns' order and independent of the batch.
  /// `progress` is called with the part of the simulation that is done, 0 to 1, by one thread at a time.
  std::vector<Result> evaluate(std::span<const Newborn> newborns, const Progress& progress) const;

  /// Only decodes: the bodies as they are born.
  std::vector<Life> birth(std::span<const Newborn> newborns) const;
  /// Lets bodies live through their development cycles: what comes out is matured.
  void develop(std::span<Life> lives, const Progress& progress) const;

  PhaseTimes phase_times() const { return {decode_.seconds(), simulate_.seconds(), develop_.seconds()}; }

 private:
  std::vector<Result> evaluate_cohort(std::span<const Newborn> newborns, const Progress& progress) const;
  /// The moments of the final evaluation, in steps from its start, at which some fitness looks.
  std::vector<std::uint64_t> marks() const;
  void simulate(std::span<Life> lives, std::uint64_t steps, Recording recording) const;
  /// The box around the body where it is when life goes on, cut off at the floor.
  Box bounds(const LivingBody& living) const;
  /// Makes a change; the energy that it brings is no fault of the simulation, so the guard is to allow it.
  template <class Change>
  void allow_energy(Life& life, const Change& change) const;
  /// What an operator sees after a cycle.
  Moment moment(const Life& life, int cycle, const Schedule& schedule) const;
  void apply_operators(Life& life, int cycle) const;
  void apply_operator(Life& life, int cycle, std::size_t index) const;
  /// What development has torn off is no longer part of the body.
  void shed_loose_pieces(Life& life, int cycle) const;
  /// Random numbers for one part of a life.
  Rng stream(const Life& life, std::uint32_t place) const;
  void check_step(Life& life) const;
  void measure(std::span<Life> lives, const Progress& progress) const;
  std::uint64_t development_steps() const;
  bool needs_work(std::uint64_t from, std::uint64_t to) const;
  void score(Life& life) const;
  void return_to_rest(Life& life) const;

  const Experiment& experiment_;
  Simulator& simulator_;
  std::vector<std::uint64_t> marks_;
  mutable Workers workers_;
  mutable BusyClock decode_, simulate_, develop_;
};

}  // namespace evodevo
