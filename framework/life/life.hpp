// One life, from a genome to a result, and the conditions under which it is simulated.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/simulator.hpp"
#include "experiment/experiment.hpp"
#include "life/edits.hpp"
#include "life/life_record.hpp"

namespace evodevo {

/// A genome to be evaluated. What the random numbers of its life depend on is told at draws_for().
struct Newborn {
  std::uint32_t id = 0;
  std::uint32_t generation = 0;
  const Genome* genome = nullptr;
  /// For a re-simulation: the changes to apply to the body instead of calling the operators.
  std::optional<LifeRecord> record = std::nullopt;
  std::string recorded_in = {};  ///< the run and individual that the record belongs to, for messages
  std::uint32_t life = 0;        ///< number of a life with other inherited draws; 0: the life in a run
};

/// Returns the random numbers of one part of a newborn's life, such as an application of a devo operator. `what` names
/// the part, and `number` tells parts of the same name apart. Inherited draws depend on these two, the seed of
/// development and the number of the life; others on these two, the run's seed, the generation and the id.
Draws draws_for(const Experiment& experiment, const Newborn& newborn, std::string_view what, std::uint64_t number);

/// A score of a matured body in one repeat of one scenario.
struct TestScore {
  std::size_t scenario = 0;   ///< index into Settings::scenarios
  std::int64_t repeat = 0;    ///< from 0
  std::size_t objective = 0;  ///< index into Experiment::objectives
  double value = 0;
};

/// How an evaluation ended.
struct Result {
  Status status = Status::ok;
  std::string reason;              ///< reason for a status other than ok
  double ended_at = 0;             ///< simulated time at which the body diverged, s
  std::vector<double> objectives;  ///< in the order and units of Experiment::objectives; empty unless ok
  std::uint64_t spring_evaluations = 0;
  LifeRecord record;  ///< changes by development; kept and archived only for individuals that reach the front
  std::vector<double> measures = {};  ///< in the order and units of Experiment::measures; empty unless ok or infeasible
  std::vector<TestScore> tests = {};  ///< of the windows that lie in scenarios; empty without scenarios
};

/// The life of a newborn while it is being evaluated.
struct Life {
  Newborn newborn;
  LivingBody living;
  const Scene* scene = nullptr;       ///< the scene in which the body lives; set at birth
  std::vector<StoredSample> samples;  ///< taken so far
  double contact_time = 0;            ///< mean time in which a mass touched the ground, as far as it was counted, s
  double work = 0;                    ///< work of the muscles on the body, as far as it was recorded, J
  Result result;

  bool alive() const { return result.status == Status::ok; }
  /// Ends the life without objectives. `ended_at` is the simulated time at which the body diverged, s.
  void end(Status status, std::string reason, double ended_at = 0) {
    result.status = status;
    result.reason = std::move(reason);
    result.ended_at = ended_at;
  }
};

/// Newborns that have matured.
struct Matured {
  std::vector<Life> lives;  ///< in the scene of the experiment, in the order of the newborns
  /// Lives of the same newborns, by the index of each scenario that develops.
  std::map<std::size_t, std::vector<Life>> in_scenarios = {};
};

/// How lives are simulated. The defaults are the settings of an experiment.
struct Conditions {
  explicit Conditions(const Experiment& experiment) : method(experiment.stepping.method), step(experiment.step) {}

  Method method;  ///< time-stepping method of the simulator
  StepRule step;
  double later = 0;  ///< delay of the windows of the fitness operators, s
  /// If it is there, each newborn is perturbed, from this start of perturb().
  std::optional<std::uint32_t> perturbed_birth = std::nullopt;
};

/// A function that is told what fraction of a job is done, 0 to 1.
using Progress = std::function<void(double)>;

}  // namespace evodevo
