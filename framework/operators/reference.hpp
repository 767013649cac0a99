// The reference of operators as a Markdown page, made from what they declare.
#pragma once

#include <string>
#include <vector>

#include "operators/describe.hpp"
#include "operators/loader.hpp"

namespace evodevo {

std::string heading_text(int level, const std::string& text);
/// A table with a row for each parameter; its first column is called `what`.
std::string parameter_table(const std::vector<ParameterDescription>& parameters, const std::string& what);
/// One operator: its summary and the table of its parameters, under a heading of the given level.
std::string reference_of(const AvailableOperator& available, int heading);
/// All operators, by kind.
std::string reference_page(const Registry& registry);

}  // namespace evodevo
