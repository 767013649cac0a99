// How bodies move: choosing a stable time step for each body, and running the simulator.
#pragma once

#include <functional>
#include <span>

#include "core/simulator.hpp"
#include "life/life.hpp"
#include "threads/busy_clock.hpp"

namespace evodevo {

/// Runs the tasks of lives, which are in the same order.
using Move = std::function<void(std::span<Task>, std::span<Life* const>)>;

/// Bodies, their states and a duration go in; moved states and what was recorded come out, in the lives. Experiment
/// and simulator must outlive it.
class LifeSimulation {
 public:
  LifeSimulation(const Experiment& experiment, Simulator& simulator, const Conditions& conditions)
      : scene_(experiment.scene), simulator_(simulator), conditions_(conditions) {}

  /// Chooses the longest step for the body as it is; a body that has none is invalid.
  void choose_step(Life& life) const;
  /// Lets the bodies that are alive do something for `duration` s, by `move`.
  void run(std::span<Life> lives, double duration, const Move& move) const;

  Simulator& simulator() const { return simulator_; }
  double seconds() const { return clock_.seconds(); }  ///< in which bodies moved

 private:
  const Scene& scene_;
  Simulator& simulator_;
  Conditions conditions_;
  mutable BusyClock clock_;
};

}  // namespace evodevo
