// One life, from a genome to a result, and the conditions under which it is simulated.
#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/simulator.hpp"
#include "experiment/experiment.hpp"
#include "life/edits.hpp"
#include "life/life_record.hpp"

namespace evodevo {

/// A genome that is born: once or, if several lives of it are to be evaluated, as often as it lives. What the random
/// numbers of a life depend on is told at draws_of_development() and draws_of_life().
struct Newborn {
  std::uint32_t id = 0;
  std::uint32_t generation = 0;
  const Genome* genome = nullptr;
  /// For a re-simulation: the changes to apply to the body in its first lives, instead of calling the operators.
  std::vector<LifeRecord> records = {};
  std::string recorded_in = {};  ///< the run and individual that the records belong to, for messages
  std::uint32_t life = 1;        ///< number of its life, or of the first of its lives
  std::uint32_t lives = 1;       ///< number of lives to evaluate
  std::uint32_t draws = 1;       ///< number of the draws of development, equal in lives that develop alike
  bool redrawn = false;          ///< whether each life has draws of its own, whatever the experiment gives to its lives
};

/// The numbers of lives that selection never sees; those that it has seen are at most most_lives.
namespace unseen_life {
inline constexpr std::uint32_t deciding = 1u << 20;  ///< first of those that decide what comes to the front
inline constexpr std::uint32_t telling = 1u << 24;   ///< first of those that tell what is to be expected
inline constexpr std::uint32_t studied = 1u << 25;   ///< first of those that measure what selection sees
}  // namespace unseen_life

/// Returns a newborn for each life of these, in their order. Each has the draws of development that
/// [development] draws_between_lives gives to its life.
std::vector<Newborn> each_life(const Experiment& experiment, std::span<const Newborn> newborns);

/// Returns the random numbers of one part of a newborn's development, such as an application of a devo operator. `what`
/// names the part, and `number` tells parts of the same name apart. Inherited draws depend on these two, the seed of
/// development and Newborn::draws; others on these two, the run's seed, the generation, the id and Newborn::draws.
Draws draws_of_development(const Experiment& experiment, const Newborn& newborn, std::string_view what,
                           std::uint64_t number);
/// Returns the random numbers of something else that happens in a newborn's life, such as noise and damage. They depend
/// on the same, but on Newborn::life instead of Newborn::draws.
Draws draws_of_life(const Experiment& experiment, const Newborn& newborn, std::string_view what, std::uint64_t number);

/// Returns a seed for one of several repetitions, counted from 1. The first has the seed itself.
std::uint64_t seed_of(std::int64_t seed, std::uint32_t repetition);

/// A score of a matured body in one repeat of one scenario.
struct TestScore {
  std::uint32_t life = 1;     ///< number of the life
  std::size_t scenario = 0;   ///< index into Settings::scenarios
  std::int64_t repeat = 0;    ///< from 0
  std::size_t objective = 0;  ///< index into Experiment::objectives
  double value = 0;
};

/// How an evaluation ended: that of one life or, from Evaluation::evaluate(), of all lives of a newborn.
struct Result {
  Status status = Status::ok;
  std::string reason;              ///< reason for a status other than ok
  double ended_at = 0;             ///< simulated time at which the body diverged, s
  std::vector<double> objectives;  ///< in the order and units of Experiment::objectives; empty unless ok
  std::uint64_t spring_evaluations = 0;
  /// Changes by development in each life; kept and archived only for individuals that reach the front.
  std::vector<LifeRecord> records = {};
  std::vector<double> measures = {};  ///< in the order and units of Experiment::measures; empty unless ok or infeasible
  std::vector<TestScore> tests = {};  ///< of the windows that lie in scenarios; empty without scenarios
  std::vector<std::vector<double>> lives = {};  ///< the objectives in each life; empty unless ok
};

/// The life of a newborn while it is being evaluated.
struct Life {
  Newborn newborn;
  LivingBody living;
  const Scene* scene = nullptr;        ///< the scene in which the body lives; set at birth
  const Scenario* scenario = nullptr;  ///< the scenario in which it develops; null: in the experiment's own scene
  std::vector<StoredSample> samples;   ///< taken so far
  double contact_time = 0;             ///< mean time in which a mass touched the ground, as far as it was counted, s
  double work = 0;                     ///< work of the muscles on the body, as far as it was recorded, J
  LifeRecord record;                   ///< changes by development so far
  bool given_up = false;               ///< whether an operator has given the body up
  Result result;                       ///< without records and lives

  bool alive() const { return result.status == Status::ok; }
  /// Ends the life without objectives. `ended_at` is the simulated time at which the body diverged, s.
  void end(Status status, std::string reason, double ended_at = 0) {
    result.status = status;
    result.reason = std::move(reason);
    result.ended_at = ended_at;
  }
};

/// Lives of the same newborns, in the same order, in each scene in which they develop.
struct Cohort {
  std::vector<Life> lives;  ///< in the scene of the experiment
  /// By the index of each scenario that develops.
  std::map<std::size_t, std::vector<Life>> in_scenarios = {};
};

/// How lives are simulated. The defaults are the settings of an experiment.
struct Conditions {
  explicit Conditions(const Experiment& experiment)
      : method(experiment.stepping.method), step(experiment.step), birth_noise(experiment.birth_noise) {}

  Method method;  ///< time-stepping method of the simulator
  StepRule step;
  double later = 0;    ///< delay of the windows of the fitness operators, s
  double birth_noise;  ///< Settings::birth_noise
};

/// A function that is told what fraction of a job is done, 0 to 1.
using Progress = std::function<void(double)>;

}  // namespace evodevo
