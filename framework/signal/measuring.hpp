// Measures what of its scores an experiment's selection can use: what repeats in other lives, and what children
// inherit.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "evolution/archive/archive.hpp"
#include "signal/estimates.hpp"

namespace evodevo {

/// The parents of a family and their children, for a chart: medians of their scores in the unit of the objective.
struct Kin {
  double parents = 0, children = 0;
};

/// What was measured of an experiment.
struct Signal {
  std::vector<SignalNumber> numbers;
  /// For each population, the families in which all have a fitness.
  std::map<std::string, std::vector<Kin>> families = {};
};

/// Whose robots are measured.
struct MeasuredRobots {
  std::size_t robots = 0;  ///< of each population, at least least_robots
  std::optional<ArchivedIndividual> champion =
      {};                             ///< best robot of a run; without it, only random robots are measured
  std::vector<Individual> last = {};  ///< last population of that run
};

inline constexpr std::size_t least_robots = 8;  ///< with fewer, intervals say nothing
inline constexpr std::size_t children_of_each = 4, children_of_champion = 20, lives_of_champion = 10;

/// Measures the first objective of random individuals and of others in lives that selection never sees
/// (unseen_life::studied), under conditions_to_come(), and that of children that the experiment's variation makes of
/// them, in other such lives. Parents are not selected: if `last` has more robots with a fitness than asked for, those
/// measured are drawn at random. With crossover, the mate of each family is drawn at random, too. Of each population:
///   repeatability   of one life, of the combination that the experiment uses (all lives), and of one life with draws
///   of
///                   development of its own;
///   heritability    regression of the children's mean on the (mid-)parent's score, of all and by the operators that
///   made
///                   the children; and the same divided by the repeatability of the parents' scores;
///   equal bodies    the share of the children whose body at birth equals their parent's;
///   score           the medians of the scores of parents and of children.
/// Of the champion: its record, its score in lives to come with the same draws and with new ones, and that of its
/// children. A last population with fewer than least_robots robots that have a fitness is not measured. Calls `told`
/// with the name of what is measured next. Throws InputError if fewer than least_robots random robots have a fitness.
Signal measure_signal(const Experiment& experiment, Simulator& simulator, const MeasuredRobots& measured,
                      const std::function<void(const std::string&)>& told);

}  // namespace evodevo
