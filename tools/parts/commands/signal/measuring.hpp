// Measures what of its scores an experiment's selection can use: what repeats in other lives, and what children
// inherit.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "archive/archive.hpp"
#include "signal/estimates.hpp"

namespace evodevo {

/// What was measured of an experiment.
struct Signal {
  std::vector<SignalNumber> numbers;
  /// For each population, the families as far as they have a fitness, with scores in the unit of the objective.
  std::vector<std::pair<std::string, std::vector<Family>>> families = {};
  std::vector<std::string> notes = {};  ///< on what could not be measured, and why
};

/// Whose robots are measured.
struct MeasuredRobots {
  std::size_t robots = 0;  ///< of each population, at least least_robots
  std::optional<ArchivedIndividual> champion =
      {};                             ///< best robot of a run; without it, only random robots are measured
  std::vector<Individual> last = {};  ///< last population of that run
};

inline constexpr std::size_t least_robots = 8;  ///< with fewer, intervals say nothing
inline constexpr std::size_t children_of_each = 4, children_of_champion = 20, measurements_of_champion = 10;

/// Measures the first objective of random individuals, and of those of a run, in lives that selection never sees
/// (unseen_life::studied), under conditions_to_come(); and that of children that the experiment's variation makes of
/// them, in other such lives. Parents are not selected: if `last` has more robots with a fitness than asked for, those
/// measured are drawn at random. With crossover, the mate of each family is drawn at random, too. Of each population:
/// - repeatability: of one life, of the combination that the experiment uses (all lives), and of one life with draws of
///   development of its own (new draws);
/// - heritability: the regression of the children's mean on the (mid-)parent's score, of all children and of those of
///   each operator; and the same divided by the repeatability of the parents' scores;
/// - equal bodies: the share of the children whose body at birth equals their parent's, and whose devo operators have
///   the same genes;
/// - score: the medians of parents and of children.
///
/// Of the champion: its record; the median of its scores in lives to come, which are combined as the record was, with
/// the same draws and with new ones; that of its children; and the shares of these that failed. If half of them failed,
/// there is no median.
///
/// Luck that is common to lives of one number, as inherited draws of noise are, counts as luck. With individual draws,
/// heritability is not divided by repeatability, since robots repeat draws that no child inherits. A population with
/// fewer than least_robots robots that have a fitness in some life is not measured. Calls `told` with the name of what
/// is measured next. Throws InputError if random robots are all that there is to measure, and too few of them have a
/// fitness.
Signal measure_signal(const Experiment& experiment, Simulator& simulator, const MeasuredRobots& measured,
                      const std::function<void(const std::string&)>& told);

}  // namespace evodevo
