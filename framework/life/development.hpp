// The development loop: the part of a life between birth and the final evaluation (paper, section IV-D).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "life/controls.hpp"
#include "life/life.hpp"
#include "life/life_simulation.hpp"
#include "life/measurement/windows.hpp"

namespace evodevo {

/// Develops lives from birth to maturity, and records the changes of each. Every cycle has these steps:
///
///   1. simulate the bodies, and record what the operators ask for
///   2. call the operators one after the other; keep what each remembers; resolve, apply and record its edits
///   3. remove the pieces that have been torn off; with DevelopmentSettings::reset, return bodies to rest
///   4. choose a time step for each changed body
///
/// Each body lives in the scene of its life. If a newborn comes with a record, the recorded changes are applied and no
/// operator is called. A control changes what happens in step 2. Samples of windows within the life are taken in
/// step 1. Experiment, simulation and windows must outlive this object.
class DevelopmentLoop {
 public:
  DevelopmentLoop(const Experiment& experiment, const LifeSimulation& simulation, const Windows& windows)
      : experiment_(experiment), simulation_(simulation), windows_(windows) {}

  /// Develops lives. Calls `progress` after each cycle, once all lives have been changed. Throws InputError if a record
  /// does not fit its body.
  void run(std::span<Life> lives, const Progress& progress) const;

  /// Simulated time of all cycles, s. With the control random-places it is doubled, because each life is simulated
  /// twice.
  double duration() const;
  double seconds() const { return clock_.seconds(); }  ///< wall-clock time spent on changing bodies, s

 private:
  /// Runs all cycles. `change(i, cycle)` changes the i-th life after a cycle. If `observed`, what the operators ask for
  /// is recorded in each cycle.
  template <class Action>
  void run_cycles(std::span<Life> lives, bool observed, const Action& change, const Progress& progress) const;
  /// If an operator asks for the ages of masses, lets the host count them from birth.
  void begin_to_count(std::span<Life> lives) const;
  /// Simulates a cycle and records what is requested of springs, with stress measured by the experiment's probe, and
  /// the contact of masses.
  void simulate_cycle(std::span<Life> lives, int cycle, const RecordRequest& request) const;
  /// For the control random-places: lets a copy of each life without a record develop by the operators, and returns the
  /// changes to which the life itself will be yoked.
  std::vector<std::optional<Yoke>> yokes_of(std::span<Life> lives) const;

  // ---- ways to change a life after a cycle ----
  void apply_operators(Life& life, int cycle) const;
  void apply_operator(Life& life, int cycle, std::size_t index) const;
  /// Changes a life at random places as much as the operators changed the life to which it is yoked.
  void change_as_in(Yoke& yoke, Life& life, int cycle) const;
  /// Applies those of a life's recorded changes that belong to this cycle.
  void apply_recorded(const std::vector<Change>& changes, Life& life, int cycle) const;

  // ---- helper functions ----
  /// Returns the context that an operator sees after a cycle.
  DevoContext context_of(const Life& life, int cycle, const Schedule& schedule, const RecordRequest& request,
                         const Genome& genome = no_genes, const Genome& own = no_genes) const;
  /// The random choices of what changes a body, or of what is recorded of it.
  struct Choices;
  /// Returns the stream for numbers that are drawn one after the other: with inherited draws one of `draws`, otherwise
  /// the stream `id` of the individual.
  Rng stream_of(const Life& life, const Draws& draws, std::uint32_t id) const;
  /// Applies a change and records it.
  void make(Change change, Life& life) const;
  /// Removes the pieces of the body that development has torn off.
  void shed_loose_pieces(Life& life, int cycle) const;
  /// Shuffles the recorded values among the springs, and among the masses. All values of one spring or mass stay
  /// together.
  void shuffle_records(Life& life, int cycle) const;
  /// Calls `action`, which changes a body, and raises the energy that the guard allows by the energy that the change
  /// adds. `energy` returns that of the body (J), or the part of it that the change can change.
  template <class Energy, class Action>
  void allow_energy(Life& life, const Energy& energy, const Action& action) const;
  /// Moves a body back to its rest positions and sets its velocities to zero.
  void return_to_rest(Life& life) const;
  /// Returns the box around the positions at which the next cycle starts, cut off below at the height of the highest
  /// point of the floor.
  Box bounds(const Life& life) const;
  const Experiment& experiment_;
  const LifeSimulation& simulation_;
  const Windows& windows_;
  mutable BusyClock clock_;
};

}  // namespace evodevo
