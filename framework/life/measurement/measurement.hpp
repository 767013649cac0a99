// The final evaluation: simulates matured bodies and lets the fitness operators score what they did.
#pragma once

#include <span>
#include <vector>

#include "life/life_simulation.hpp"
#include "life/measurement/scenario_start.hpp"
#include "life/measurement/windows.hpp"

namespace evodevo {

/// Evaluates lives: gives each its scores, or the reason why it has none.
///
///   samples of a life ─► scores of the operators whose windows lie within the life
///   matured body ─► for each scenario and repeat: start_scenario() ─► simulate ─► samples ─► scores of the others
///   scores of all scenarios and repeats ─► objectives and other scores
///
/// Windows within the life lie in the scenarios that develop or, if there are none, in the life in the experiment's own
/// scene. The matured body is simulated in one run. What the operators observe does not change its motion or how its
/// life ends, except that the run lasts until the last window closes. Experiment, windows and simulation must outlive
/// this object.
class Measurement {
 public:
  Measurement(const Experiment& experiment, const LifeSimulation& simulation, const Windows& windows);

  /// Evaluates `matured.lives`. Calls `progress` after each test.
  void run(Cohort& matured, const Progress& progress) const;
  /// Evaluates lives in one test, in which they also end. Their objectives are the scores of this test. If its scenario
  /// develops, they have matured there.
  void run_in(const Test& test, std::span<Life> lives) const;

  /// Simulated time of the final evaluation, s.
  double duration() const;

 private:
  /// Where a score goes: its role, and its index among the objectives or among the other scores of the experiment.
  struct Place {
    Role role;
    std::size_t index;
  };
  /// The scores of each operator in a test; none for operators whose windows lie elsewhere.
  using Scores = std::vector<std::vector<double>>;

  /// Scores the windows within each life, and lets the lives begin to count anew.
  std::vector<Scores> scores_within(std::span<Life> lives, std::string_view scenario) const;
  /// Measures copies of lives in all tests, and adds the scores of each life that has not ended to its list.
  void measure_in_scenarios(Cohort& matured, std::vector<std::vector<Scores>>& tests, const Progress& progress) const;
  /// Returns copies of matured lives at the start of a test. Those whose newborn has ended in `lives` end as well.
  std::vector<Life> started(const Test& test, std::span<const Life> lives, std::span<const Life> matured) const;
  /// Simulates lives in their present scene until the last window closes, and adds the scores to those of each life.
  void measure(std::span<Life> lives, std::string_view scenario, std::span<Scores> scores) const;
  /// Adds the result of a test to that of the life which it belongs to.
  void add_test(const Test& test, const Scores& scores, const Result& tested, Life& life) const;
  /// Lets an operator score the window of a life. If a score is not finite, ends the life.
  std::vector<double> score(std::size_t op, std::string_view scenario, Life& life) const;
  /// Makes the scores of a life from those in all tests. Ends a life that violates a constraint.
  void set_scores(const std::vector<Scores>& tests, Life& life) const;
  /// Makes one score of the i-th scores of an operator in all tests that have any: the mean of a descriptor, the worst
  /// of a constraint; all others are combined as the experiment says, over all tests or those of one scenario.
  double over_tests(std::size_t op, std::size_t i, const std::vector<Scores>& tests) const;
  const Objective& title_of(const Place& place) const;

  const Experiment& experiment_;
  const LifeSimulation& simulation_;
  const Windows& windows_;
  std::vector<std::vector<Place>> places_;  ///< for each fitness operator, where each of its scores goes
};

}  // namespace evodevo
