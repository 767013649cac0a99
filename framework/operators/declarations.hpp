// Checks what an operator declares about its parameters.
#pragma once

#include <string>
#include <vector>

#include "evodevo/operator.hpp"

namespace evodevo {

/// Describes the first default value that the operator's own declaration does not allow, with a remedy; empty if there
/// is none.
std::string wrong_default(Operator& op);

/// Returns the name of the first parameter that has the name of one of the host's keys (host_keys.hpp); empty if there
/// is none.
std::string taken_name(Operator& op);

/// Describes what is wrong with the declarations: names that are missing or repeated, and missing bounds, units and
/// descriptions.
std::vector<std::string> declaration_faults(Operator& op);

}  // namespace evodevo
