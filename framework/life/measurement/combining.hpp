// How several scores become one: those of the tests of a life, and those of the lives of an individual.
#pragma once

#include <cstdint>
#include <vector>

#include "life/life.hpp"

namespace evodevo {

/// Returns one score for several of the same kind. Infinite only if their sum is.
double combined(std::vector<double> scores, Over over, bool maximise);

/// Returns the objectives of an individual from those in each of several lives.
std::vector<double> objectives_of(const std::vector<std::vector<double>>& lives, const Experiment& experiment);

/// Returns the result of an individual from those of its lives, which are numbered from `first`. Objectives are
/// combined as Experiment::over_lives says; descriptors and measures by their mean, constraints by their worst. The
/// first life that failed fails the individual; its number is in the reason, unless it is the only one. Spring
/// evaluations add up.
Result of_all_lives(const Experiment& experiment, std::vector<Result> lives, std::uint32_t first);

/// Adds the result of `more` lives to that of an individual, which has had `lives` before: combines the scores of all
/// lives as of_all_lives() does. If one of the further lives failed, the individual fails.
void add_lives(const Experiment& experiment, std::uint32_t lives, std::uint32_t more, Result again, Result& result);

}  // namespace evodevo
