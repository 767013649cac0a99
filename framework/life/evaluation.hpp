// From genomes to scores: decode, live, be measured. Works on whole batches.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "life/body_building.hpp"
#include "life/controls.hpp"
#include "life/edits.hpp"
#include "life/life_record.hpp"
#include "threads/busy_clock.hpp"
#include "threads/parallel.hpp"

namespace evodevo {

/// A genome that asks to be evaluated. Its random numbers depend on the run's seed, the generation and the id alone.
struct Newborn {
  std::uint32_t id = 0;
  std::uint32_t generation = 0;
  const Genome* genome = nullptr;
  /// Of a life that is lived again: its changes are made whatever the operators would do.
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

/// The time in which evaluations were in a phase, s. Phases overlap: while some bodies move, others develop.
struct PhaseTimes {
  double decode = 0, simulate = 0, develop = 0;
};

/// What the experiment's encoding makes of a genome. Blames the encoding for what cannot be a blueprint.
Blueprint decoded(const Experiment& experiment, const Genome& genome, CallPlace place = {});

/// Runs the tasks of lives, which are in the same order.
using Move = std::function<void(std::span<Task>, std::span<Life* const>)>;

/// Evaluates batches of genomes for an experiment. A batch goes through life in as many cohorts as the simulator wants
/// to have at once. Experiment and simulator must outlive it.
class Evaluation {
 public:
  Evaluation(const Experiment& experiment, Simulator& simulator);
  Evaluation(const Experiment& experiment, Simulator& simulator, const Conditions& conditions);

  /// Decodes, develops, measures and scores. The results are in the newborns' order and independent of the batch.
  /// `progress` is called with the part of the simulation that is done, 0 to 1, by one thread at a time.
  std::vector<Result> evaluate(std::span<const Newborn> newborns, const Progress& progress) const;

  /// Only decodes: the bodies before the scene has them.
  std::vector<BuiltBody> build(std::span<const Newborn> newborns) const;
  /// The bodies as they are born: they bear the scene's load and lie on its ground.
  std::vector<Life> birth(std::span<const Newborn> newborns) const;
  /// The same for a body from elsewhere.
  Life birth(Body body) const;
  /// A body in the middle of its life, as it is. It is invalid where the ground would throw it out.
  Life amid_life(Body body, State state) const;
  /// Lets bodies live through their development cycles: what comes out is matured. `progress` is called after each
  /// cycle, when the lives are as it has left them.
  void develop(std::span<Life> lives, const Progress& progress) const;
  /// Chooses the longest step for the body as it is; a body that has none is invalid.
  void choose_step(Life& life) const;
  /// Lets the bodies that are alive do something for `duration` s, by `move`.
  void simulate(std::span<Life> lives, double duration, const Move& move) const;
  /// The final evaluation: moves the matured bodies on and scores them.
  void measure(std::span<Life> lives, const Progress& progress) const;

  PhaseTimes phase_times() const { return {decode_.seconds(), simulate_.seconds(), develop_.seconds()}; }

 private:
  std::vector<Result> evaluate_cohort(std::span<const Newborn> newborns, const Progress& progress) const;
  void set_windows();
  /// All cycles of development; `change(i, cycle)` changes the i-th life after a cycle. Where `observed`, what the
  /// operators of a cycle ask for is recorded for them.
  template <class Action>
  void live_cycles(std::span<Life> lives, bool observed, const Action& change, const Progress& progress) const;
  /// The control of random places: a life without a record is yoked to one that is lived before, with the operators.
  std::vector<std::optional<Yoke>> yokes_of(std::span<const Life> lives) const;
  /// The simulation of a cycle of development, recorded as the probe does it.
  void simulate_cycle(std::span<Life> lives, int cycle, Recording recording) const;
  /// The box around the body where it is when life goes on, cut off at the floor's highest place.
  Box bounds(const LivingBody& living) const;
  /// Does what changes a body; the energy that it brings is no fault of the simulation, so the guard is to allow it.
  template <class Action>
  void allow_energy(Life& life, const Action& action) const;
  /// What an operator sees after a cycle.
  Moment moment(const Life& life, int cycle, const Schedule& schedule, const SpringRequest& request) const;
  /// Deals out what is known of the springs anew, all of one spring together.
  void shuffle_records(Life& life, int cycle) const;
  void apply_operators(Life& life, int cycle) const;
  void apply_operator(Life& life, int cycle, std::size_t index) const;
  /// Changes as much as the operators did in the life to which this one is yoked, at random places.
  void change_as_in(Yoke& yoke, Life& life, int cycle) const;
  /// Makes and records a change whose new springs may still lack their rest lengths.
  void make_change(Life& life, Change change, const Moment& now) const;
  /// Makes the changes after a cycle again, of all that a life went through. Throws ArchiveError where they do not fit
  /// the body.
  void make_again(const std::vector<Change>& changes, Life& life, int cycle) const;
  /// What development has torn off is no longer part of the body.
  void shed_loose_pieces(Life& life, int cycle) const;
  /// Random numbers for one part of a life.
  Rng stream(const Life& life, std::uint32_t place) const;
  /// Of all that is simulated of development, s.
  double development_time() const;
  /// Whether a fitness asks for the work in the time up to a mark.
  bool needs_work(std::size_t mark) const;
  /// Whether the window of some fitness opens at a mark.
  bool opens_window(std::size_t mark) const;
  void score(Life& life) const;
  void return_to_rest(Life& life) const;

  const Experiment& experiment_;
  Simulator& simulator_;
  Conditions conditions_;
  /// What a fitness asks for, and its window as indices of marks.
  struct Window {
    Request request;
    std::size_t opens, closes;
  };
  std::vector<double> marks_;    ///< when some fitness looks, from the start of the final evaluation, s
  std::vector<Window> windows_;  ///< of each fitness
  mutable BusyClock decode_, simulate_, develop_;
};

}  // namespace evodevo
