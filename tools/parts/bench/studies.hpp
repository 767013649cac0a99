// What the benchmark can measure.
#pragma once

#include "report.hpp"
#include "settings.hpp"

namespace evodevo::tools::bench {

/// Our simulator's rate, and how much of it is left with stress and with work recorded.
Report speed(const Settings& settings);

/// What each force, actuation and each recording costs: the rate with it over the rate without, all else equal.
Report feature_costs(const Settings& settings);

#ifdef EVODEVO_CUDA
/// The paper's baseline and its method beside ours.
Report baselines(const Settings& settings);

/// The rate with materials computed from codes over that with a table, for bodies of few and of many materials.
Report material_costs(const Settings& settings);

/// What recording stress costs: the paper's four ways with its method, the exact sum with ours (paper, Figures 2, 4).
Report stress_costs(const Settings& settings);

/// How many of the true 125 least and most stressed springs each of those ways finds (paper, Figure 3).
Report tally_agreement(const Settings& settings);

/// How long the search for nearest neighbours takes on both devices for a population of random balls. Throws
/// std::runtime_error where they do not find the same.
Report neighbours(const Settings& settings);
#endif

}  // namespace evodevo::tools::bench
