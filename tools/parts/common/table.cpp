#include "common/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/output_file.hpp"

namespace evodevo::tools {
namespace {

std::string text_of(double number) { return std::isfinite(number) ? fmt::format("{:.9g}", number) : ""; }

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + '"';
}

std::string text_of(const Cell& cell) {
  if (const auto* number = std::get_if<double>(&cell)) return text_of(*number);
  return quoted(std::get<std::string>(cell));
}

}  // namespace

void Table::add(std::vector<Cell> row) {
  if (row.size() != columns_.size())
    throw std::logic_error(name_ + ": a row of " + std::to_string(row.size()) + " cells for " +
                           std::to_string(columns_.size()) + " columns");
  rows_.push_back(std::move(row));
}

std::size_t Table::index_of(const std::string& column) const {
  const auto found = std::find(columns_.begin(), columns_.end(), column);
  if (found == columns_.end()) throw std::logic_error(name_ + " has no column " + column);
  return static_cast<std::size_t>(found - columns_.begin());
}

double Table::number(std::size_t row, const std::string& column) const {
  return std::get<double>(rows_.at(row)[index_of(column)]);
}

const std::string& Table::text(std::size_t row, const std::string& column) const {
  return std::get<std::string>(rows_.at(row)[index_of(column)]);
}

std::string Table::csv() const {
  std::string text;
  const auto line = [&](const auto& cells, const auto& format) {
    for (std::size_t i = 0; i < cells.size(); ++i) text += (i > 0 ? "," : "") + format(cells[i]);
    text += '\n';
  };
  line(columns_, quoted);
  for (const auto& row : rows_) line(row, [](const Cell& cell) { return text_of(cell); });
  return text;
}

void write(const Table& table, const std::filesystem::path& folder) {
  write_file(folder / (table.name() + ".csv"), table.csv());
}

}  // namespace evodevo::tools
