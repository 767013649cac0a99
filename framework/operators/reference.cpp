#include "operators/reference.hpp"

namespace evodevo {
namespace {

/// One row of a table. Bars within cells are escaped, because a bar ends a cell.
std::string row(std::initializer_list<std::string> cells) {
  std::string line = "|";
  for (const std::string& cell : cells) {
    line += ' ';
    for (const char letter : cell) line += letter == '|' ? std::string("\\|") : std::string(1, letter);
    line += cell.empty() ? "|" : " |";
  }
  return line + "\n";
}

std::string code(const std::string& text) { return "`" + text + "`"; }

std::string parameter_row(const ParameterDescription& p) {
  const std::string unit = p.unit == "1" ? "" : p.unit;
  return row({code(p.name), code(p.fallback), p.allowed.empty() ? p.type : p.type + ", " + p.allowed, unit, p.text});
}

}  // namespace

std::string heading_text(int level, const std::string& text) {
  return std::string(static_cast<std::size_t>(level), '#') + " " + text + "\n\n";
}

std::string parameter_table(const std::vector<ParameterDescription>& parameters, const std::string& what) {
  std::string text = row({what, "default", "allowed", "unit", "what it is"}) + "|---|---|---|---|---|\n";
  for (const ParameterDescription& parameter : parameters) text += parameter_row(parameter);
  return text + "\n";
}

std::string reference_of(const AvailableOperator& available, int heading) {
  std::string text = heading_text(heading, code(available.entry->name)) + available.entry->summary + "\n\n";
  const auto parameters = describe_parameters(available);
  if (parameters.empty()) return text + "It has no parameters.\n\n";
  return text + parameter_table(parameters, "parameter");
}

std::string reference_page(const Registry& registry) {
  std::string page =
      "# Operators\n\nWritten by `evodevo operators --markdown` from what the operators declare; do not edit it.\n\n";
  for (const std::string_view kind : operator_kinds) {
    page += heading_text(2, std::string(kind));
    for (const AvailableOperator& available : registry.operators())
      if (available.entry->kind == kind) page += reference_of(available, 3);
  }
  page.pop_back();  // the page ends with one newline
  return page;
}

}  // namespace evodevo
