// Simulates lives: chooses a time step for each body, runs the simulator, and keeps the samples.
#pragma once

#include <functional>
#include <span>

#include "core/simulator.hpp"
#include "life/life.hpp"
#include "threads/busy_clock.hpp"

namespace evodevo {

/// A function that runs tasks on the simulator. The i-th task belongs to the i-th life.
using Move = std::function<void(std::span<Task>, std::span<Life* const>)>;

/// A time at which bodies are sampled.
struct SampleTime {
  double time = 0;  ///< since the beginning of the stretch, s
  Channels channels;
};

/// A part of a life in which the body does not change.
struct Stretch {
  double duration = 0;                       ///< s
  std::span<const SampleTime> samples = {};  ///< in ascending order of their times
  Channels counted = {};  ///< the channels that count from birth and are read in this stretch or later
  bool contact = false;   ///< whether MassRecords::contact is recorded

  /// What is sampled at its end, in addition to `samples`.
  Channels at_end() const { return counted | Channels{.contacts = contact}; }
};

/// Simulates the bodies of lives for a given time, and stores in each life its new state, what was recorded and the
/// samples. Experiment and simulator must outlive this object.
class LifeSimulation {
 public:
  LifeSimulation(const Experiment& experiment, Simulator& simulator, const Conditions& conditions)
      : scene_(experiment.scene), simulator_(simulator), conditions_(conditions) {}

  /// Chooses the time step for a body in its present state. If the body cannot be simulated, its life ends as invalid.
  void choose_step(Life& life) const;
  /// Simulates all lives that have not ended yet for a stretch. `move` runs the tasks.
  void run(std::span<Life> lives, const Stretch& stretch, const Move& move) const;

  Simulator& simulator() const { return simulator_; }
  const Conditions& conditions() const { return conditions_; }
  double seconds() const { return clock_.seconds(); }  ///< wall-clock time spent on simulation, s

 private:
  Task task_for(Life& life, const Stretch& stretch) const;

  const Scene& scene_;
  Simulator& simulator_;
  Conditions conditions_;
  mutable BusyClock clock_;
};

}  // namespace evodevo
