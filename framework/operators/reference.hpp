// The reference of operators as a Markdown page, made from what they declare.
#pragma once

#include <string>

#include "operators/loader.hpp"

namespace evodevo {

/// One operator: its summary and the table of its parameters, under a heading of the given level.
std::string reference_of(const AvailableOperator& available, int heading);
/// All operators, by kind.
std::string reference_page(const Registry& registry);

}  // namespace evodevo
