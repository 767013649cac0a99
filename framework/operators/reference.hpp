// Writes the reference of operators, a Markdown page, from what the operators declare.
#pragma once

#include <string>
#include <vector>

#include "operators/describe.hpp"
#include "operators/loader.hpp"

namespace evodevo {

std::string heading_text(int level, const std::string& text);
/// A table with one row for each parameter. `what` is the heading of its first column.
std::string parameter_table(const std::vector<ParameterDescription>& parameters, const std::string& what);
/// One operator: its summary and the table of its parameters, under a heading of the given level.
std::string reference_of(const AvailableOperator& available, int heading);
/// The whole page: all operators, grouped by kind.
std::string reference_page(const Registry& registry);

}  // namespace evodevo
