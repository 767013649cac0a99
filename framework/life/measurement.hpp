// The final evaluation: what a matured body does, seen by the fitness operators.
#pragma once

#include <span>
#include <vector>

#include "life/life.hpp"
#include "life/life_simulation.hpp"

namespace evodevo {

/// Evaluates matured lives: gives each its objectives, or the reason why it has none. Lives are simulated from mark to
/// mark; a mark is a time at which the window of some fitness operator opens or closes. A snapshot is taken at each
/// mark, and each fitness operator scores the two snapshots at the ends of its window. The experiment and the
/// simulation must outlive this object.
class Measurement {
 public:
  Measurement(const Experiment& experiment, const LifeSimulation& simulation, const Conditions& conditions);

  /// `progress` is called at each mark.
  void run(std::span<Life> lives, const Progress& progress) const;

  /// All that is simulated in it, s.
  double duration() const { return marks_.back(); }

 private:
  /// What a fitness asks for, and its window as indices of marks.
  struct Window {
    Request request;
    std::size_t opens, closes;
  };
  /// What is recorded of a body at a mark.
  struct Snapshot {
    Box box;
    Vec3 centre;
    double work = 0;  ///< of the muscles since the final evaluation began, J
  };
  using Snapshots = std::vector<Snapshot>;  ///< of one life, one for each mark

  /// `later` is how much later the windows open than the operators ask for, s.
  void set_windows(double later);
  /// Whether a fitness asks for the work in the time up to a mark.
  bool needs_work(std::size_t mark) const;
  /// Whether the window of some fitness opens at a mark.
  bool opens_window(std::size_t mark) const;
  void score(Life& life, const Snapshots& snapshots) const;

  const Experiment& experiment_;
  const LifeSimulation& simulation_;
  std::vector<double> marks_;    ///< when some fitness looks, from the start of the final evaluation, s
  std::vector<Window> windows_;  ///< of each fitness
};

}  // namespace evodevo
