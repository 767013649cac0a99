// The tables [[fitness]].
#pragma once

#include "experiment/tables/operators.hpp"

namespace evodevo {

/// Reads [[fitness]] into an experiment whose settings, encoding and development have been read. Writes the tables,
/// with every default, into `record`.
void read_fitness(TomlReader& top, const OperatorFactory& factory, const References& references, Experiment& experiment,
                  toml::table& record);

}  // namespace evodevo
