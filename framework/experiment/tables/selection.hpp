// The table [selection], which names one operator, or one for parents and one for survivors.
#pragma once

#include "experiment/tables/operators.hpp"

namespace evodevo {

/// Reads [selection] into an experiment whose other operators have been read. Writes the table, with every default,
/// into `record`.
void read_selection(TomlReader& top, const OperatorFactory& factory, const References& references,
                    Experiment& experiment, toml::table& record);

}  // namespace evodevo
