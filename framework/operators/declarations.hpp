// Checks what an operator declares about its parameters.
#pragma once

#include <string>
#include <vector>

#include "evodevo/operator.hpp"

namespace evodevo {

/// Returns a description of the first default value that the operator's own declaration does not allow, with a remedy,
/// or an empty text if all default values are allowed. A required parameter (see below) has no default.
std::string wrong_default(Operator& op);

/// Returns the name of the first parameter without a default that the operator's own declaration requires, such as a
/// file, or an empty text if every parameter may be left out.
std::string required_parameter(Operator& op);

/// Returns the name of the first parameter that has the name of one of the host's keys (host_keys.hpp), or an empty
/// text if there is no such parameter.
std::string taken_name(Operator& op);

/// Returns descriptions of the faults of the declarations: names that are missing or repeated, and missing bounds,
/// units and descriptions.
std::vector<std::string> declaration_faults(Operator& op);

}  // namespace evodevo
