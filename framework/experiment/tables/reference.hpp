// Writes the reference of an experiment's tables and keys from their declarations.
#pragma once

#include <string>

namespace evodevo {

/// Returns a section of a Markdown page: all tables that hold settings, with their keys. The parameters of operators
/// are in the reference of operators (operators/reference.hpp).
std::string experiment_reference();

}  // namespace evodevo
