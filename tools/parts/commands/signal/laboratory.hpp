// Lets robots of an experiment, and children that its variation makes of them, live in lives that selection never sees.
#pragma once

#include <string>
#include <vector>

#include "evolution/breeding.hpp"
#include "life/evaluation.hpp"
#include "signal/estimates.hpp"

namespace evodevo {

/// The objectives of each individual in each of several lives; empty for those in which it failed.
using Lives = std::vector<std::vector<std::vector<double>>>;

/// Returns the scores in the first objective.
Scores scores_in(const Lives& lives);

/// A child of a measured robot.
struct MeasuredChild {
  std::size_t family = 0;            ///< index of the parent whose place it may take
  std::vector<std::size_t> parents;  ///< indices of all its parents
  std::string made_by;               ///< Individual::made_by
  bool is_equal = false;             ///< born like the parent of `family`, with the same genes of devo operators
  double score = 0;                  ///< its lives combined as the experiment does; NaN if one failed
};

/// Lives are those from unseen_life::studied on, under conditions_to_come(). Experiment and simulator must outlive this
/// object.
class Laboratory {
 public:
  Laboratory(const Experiment& experiment, Simulator& simulator);

  std::size_t lives_at_once() const;  ///< number of lives that the experiment combines to a score
  /// The number of lives in which robots of a population are measured: at least four, and at least two combinations.
  std::size_t lives() const;

  /// Returns the first `count` lives of each individual. If they are redrawn, each has draws of development of its own.
  Lives first_lives_of(const std::vector<Individual>& individuals, std::size_t count, bool redrawn = false) const;
  /// Returns the scores of individuals in several measurements, each of which combines lives_at_once() lives as the
  /// experiment does. A measurement with a life that failed failed.
  Scores combined_scores(const Scores& of_lives) const;

  /// Returns a child of each couple of robots, and lets it live in lives in which no robot of a population was
  /// measured. Children of one couple, which follow each other, live in lives of different numbers, since luck is
  /// common to those of one number.
  std::vector<MeasuredChild> children_of_couples(const std::vector<Individual>& robots,
                                                 std::span<const Couple> couples) const;

 private:
  /// Lets individual i live `count` times, from number `first[i]` on.
  Lives lives_of(const std::vector<Individual>& individuals, const std::vector<std::size_t>& first, std::size_t count,
                 bool redrawn) const;
  bool develop_alike(const Genome& a, const Genome& b) const;

  const Experiment& experiment_;
  const Evaluation evaluation_;
  Workers& workers_;
};

}  // namespace evodevo
