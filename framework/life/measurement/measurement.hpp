// The final evaluation: simulates matured bodies and lets the fitness operators score them.
#pragma once

#include <span>
#include <vector>

#include "life/life.hpp"
#include "life/life_simulation.hpp"

namespace evodevo {

/// Evaluates matured lives: gives each its objectives, or the reason why it has none. Lives are simulated from mark to
/// mark. A mark is a time at which the window of some fitness operator opens or closes. A snapshot is taken at each
/// mark, and each fitness operator scores the two snapshots at the ends of its window. The experiment and the
/// simulation must outlive this object.
class Measurement {
 public:
  Measurement(const Experiment& experiment, const LifeSimulation& simulation, const Conditions& conditions);

  /// Evaluates lives. Calls `progress` at each mark.
  void run(std::span<Life> lives, const Progress& progress) const;

  /// Simulated time of the final evaluation, s.
  double duration() const { return marks_.back(); }

 private:
  /// What a fitness operator asks for, and the indices of the marks at which its window opens and closes.
  struct Window {
    Request request;
    std::size_t opens, closes;
  };
  /// What is recorded of a body at a mark.
  struct Snapshot {
    Box box;
    Vec3 centre;
    double work = 0;  ///< work of the muscles since the final evaluation began, J
  };
  using Snapshots = std::vector<Snapshot>;  ///< snapshots of one life, one for each mark

  /// Sets the windows and marks. Windows open `later` s later than the operators ask for.
  void set_windows(double later);
  /// Whether a fitness operator asks for the work between the previous mark and this mark.
  bool needs_work(std::size_t mark) const;
  /// Whether the window of a fitness operator opens at a mark.
  bool opens_window(std::size_t mark) const;
  void score(Life& life, const Snapshots& snapshots) const;

  const Experiment& experiment_;
  const LifeSimulation& simulation_;
  std::vector<double> marks_;    ///< times of the marks since the start of the final evaluation, s
  std::vector<Window> windows_;  ///< window of each fitness operator
};

}  // namespace evodevo
