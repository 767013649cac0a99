// The reference of an experiment's tables and keys, made from what they declare.
#pragma once

#include <string>

namespace evodevo {

/// A section of a Markdown page: every table that holds settings, each with its keys. The parameters of operators are
/// in the reference of operators.
std::string experiment_reference();

}  // namespace evodevo
