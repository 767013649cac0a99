// One life, from a genome to a result, and the conditions under which it is lived.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/simulator.hpp"
#include "experiment/experiment.hpp"
#include "life/edits.hpp"
#include "life/life_record.hpp"

namespace evodevo {

/// A genome that asks to be evaluated. Its random numbers depend on the run's seed, the generation and the id alone.
struct Newborn {
  std::uint32_t id = 0;
  std::uint32_t generation = 0;
  const Genome* genome = nullptr;
  /// Of a life that is simulated again: its changes are made whatever the operators would do.
  std::optional<LifeRecord> record = std::nullopt;
  std::string recorded_in = {};  ///< whose record that is, for messages
};

/// How an evaluation ended.
struct Result {
  Status status = Status::ok;
  std::string reason;              ///< of a status other than ok
  double ended_at = 0;             ///< simulated time of a divergence, s
  std::vector<double> objectives;  ///< in Experiment::objectives' order and units; empty unless ok
  std::uint64_t spring_evaluations = 0;
  LifeRecord record;  ///< of development; kept, and archived, for those alone who reach the front
};

/// What becomes of a newborn.
struct Life {
  Newborn newborn;
  LivingBody living;
  double work = 0;  ///< of the muscles on the body, where it was recorded, J
  Result result;

  bool alive() const { return result.status == Status::ok; }
  /// `ended_at` is the simulated time of a divergence, s.
  void end(Status status, std::string reason, double ended_at = 0) {
    result.status = status;
    result.reason = std::move(reason);
    result.ended_at = ended_at;
  }
};

/// How lives are simulated, by default as an experiment says.
struct Conditions {
  explicit Conditions(const Experiment& experiment) : method(experiment.stepping.method), step(experiment.step) {}

  Method method;  ///< of the simulator
  StepRule step;
  double later = 0;  ///< how much later the windows of the fitness open, s
};

/// Takes the part of a job that is done, 0 to 1.
using Progress = std::function<void(double)>;

}  // namespace evodevo
