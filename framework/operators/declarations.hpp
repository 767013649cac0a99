// Checks what an operator declares of its parameters.
#pragma once

#include <string>
#include <vector>

#include "evodevo/operator.hpp"

namespace evodevo {

/// The first default that the operator itself does not allow, with the remedy; empty where there is none.
std::string wrong_default(Operator& op);

/// The first parameter whose name is a key of the host's own (host_keys.hpp); empty where there is none.
std::string taken_name(Operator& op);

/// What a reader of the declarations would miss: names, bounds, units and sentences.
std::vector<std::string> declaration_faults(Operator& op);

}  // namespace evodevo
