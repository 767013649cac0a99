// The development loop: what happens in a life between birth and the final evaluation (paper, section IV-D).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "life/controls.hpp"
#include "life/life.hpp"
#include "life/life_simulation.hpp"

namespace evodevo {

/// Newborn lives go in; matured ones come out, each with the record of its changes:
///
///   cycles times { simulate a cycle_time and record what the operators ask for -> edits of the operators, one after
///   the other, each resolved, applied and recorded -> what is torn off goes -> a step for the new body }
///
/// A life with a record makes the recorded changes instead of asking the operators; a control asks them in another way.
/// Experiment and simulation must outlive it.
class DevelopmentLoop {
 public:
  DevelopmentLoop(const Experiment& experiment, const LifeSimulation& simulation)
      : experiment_(experiment), simulation_(simulation) {}

  /// Calls `progress` after each cycle, when the lives are as that cycle has left them. Throws InputError where a
  /// record does not fit its body.
  void run(std::span<Life> lives, const Progress& progress) const;

  /// All that is simulated in it, s.
  double duration() const;
  double seconds() const { return clock_.seconds(); }  ///< in which bodies were edited

 private:
  /// All cycles; `change(i, cycle)` changes the i-th life after a cycle. Where `observed`, what the operators of a
  /// cycle ask for is recorded for them.
  template <class Action>
  void run_cycles(std::span<Life> lives, bool observed, const Action& change, const Progress& progress) const;
  /// The simulation of a cycle, recorded as the probe does it.
  void simulate_cycle(std::span<Life> lives, int cycle, Recording recording) const;
  /// For the control of random places: first simulates, with the operators, each life that has no record; then yokes
  /// that life to the changes made there.
  std::vector<std::optional<Yoke>> yokes_of(std::span<const Life> lives) const;

  // ---- the ways to change a life after a cycle ----
  void apply_operators(Life& life, int cycle) const;
  void apply_operator(Life& life, int cycle, std::size_t index) const;
  /// Changes as much as the operators did in the life to which this one is yoked, at random places.
  void change_as_in(Yoke& yoke, Life& life, int cycle) const;
  /// Applies the changes of this cycle, of all that a life went through, again.
  void apply_recorded(const std::vector<Change>& changes, Life& life, int cycle) const;

  // ---- what they share ----
  /// What an operator sees after a cycle.
  DevoContext context_of(const Life& life, int cycle, const Schedule& schedule, const SpringRequest& request) const;
  /// Applies a change and records it.
  void make(Change change, Life& life) const;
  /// Removes from the body the pieces that development has torn off.
  void shed_loose_pieces(Life& life, int cycle) const;
  /// Shuffles the recorded values among the springs; all values of one spring stay together.
  void shuffle_records(Life& life, int cycle) const;
  /// Does what changes a body; the energy that it brings is no fault of the simulation, so the guard is to allow it.
  template <class Action>
  void allow_energy(Life& life, const Action& action) const;
  void return_to_rest(Life& life) const;
  /// The box around the body where it is when life goes on, cut off at the floor's highest position.
  Box bounds(const LivingBody& living) const;
  /// Random numbers for one part of a life.
  Rng stream(const Life& life, std::uint32_t id) const;

  const Experiment& experiment_;
  const LifeSimulation& simulation_;
  mutable BusyClock clock_;
};

}  // namespace evodevo
