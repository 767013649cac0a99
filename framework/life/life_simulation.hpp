// Simulates lives: chooses a time step for each body, and runs the simulator.
#pragma once

#include <functional>
#include <span>

#include "core/simulator.hpp"
#include "life/life.hpp"
#include "threads/busy_clock.hpp"

namespace evodevo {

/// A function that runs tasks on the simulator. The i-th task belongs to the i-th life.
using Move = std::function<void(std::span<Task>, std::span<Life* const>)>;

/// Simulates the bodies of lives for a given time, and stores in each life its new state and what was recorded.
/// Experiment and simulator must outlive this object.
class LifeSimulation {
 public:
  LifeSimulation(const Experiment& experiment, Simulator& simulator, const Conditions& conditions)
      : scene_(experiment.scene), simulator_(simulator), conditions_(conditions) {}

  /// Chooses the time step for a body in its present state. If the body cannot be simulated, its life ends as invalid.
  void choose_step(Life& life) const;
  /// Simulates all lives that have not ended yet for `duration` (s). `move` runs the tasks.
  void run(std::span<Life> lives, double duration, const Move& move) const;

  Simulator& simulator() const { return simulator_; }
  double seconds() const { return clock_.seconds(); }  ///< wall-clock time spent on simulation, s

 private:
  const Scene& scene_;
  Simulator& simulator_;
  Conditions conditions_;
  mutable BusyClock clock_;
};

}  // namespace evodevo
