// The individuals of another run with whom a run begins.
#pragma once

#include <optional>
#include <vector>

#include "archive/population.hpp"

namespace evodevo {

/// Returns those who are alive in the run that `[experiment] start` names, to be born again in the first generation;
/// nobody if it names none. If more are alive than are born, the best by the first objective of that run come, and
/// those without a fitness last. They are in the order of their birth there. Throws ConfigError if the key is wrong: if
/// there is no such run, if nobody lives in it, if its genomes are not those of the experiment, or if the experiment's
/// selection operator makes all children itself, and would not know these.
std::vector<Migrant> founders(const Experiment& experiment);

/// Returns the seed of development of the run that `[experiment] start` names, with which its robots developed; nothing
/// if it names none. Throws ConfigError if there is no such run.
std::optional<std::int64_t> development_seed_of_start(const Experiment& experiment);

}  // namespace evodevo
