// The chart of children over parents.
#pragma once

#include <string>

#include "experiment/experiment.hpp"
#include "signal/measuring.hpp"

namespace evodevo {

/// Returns an SVG picture of the scores of children over those of their parents, a panel for each population.
std::string signal_chart(const Signal& signal, const Objective& objective);

}  // namespace evodevo
