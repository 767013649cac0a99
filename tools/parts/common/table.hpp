// Tables of results, written as CSV.
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace evodevo::tools {

using Cell = std::variant<std::string, double>;

/// A table of results. The name of a column includes its unit, such as "dt (s)".
class Table {
 public:
  Table(std::string name, std::vector<std::string> columns) : name_(std::move(name)), columns_(std::move(columns)) {}

  /// Adds a row. Throws std::logic_error if it does not have one cell for each column.
  void add(std::vector<Cell> row);

  const std::string& name() const { return name_; }
  const std::vector<std::vector<Cell>>& rows() const { return rows_; }
  /// Returns the number in a cell. Throws std::logic_error if there is no such column.
  double number(std::size_t row, const std::string& column) const;
  const std::string& text(std::size_t row, const std::string& column) const;

  /// Returns the table as CSV; numbers that are not finite become empty cells.
  std::string csv() const;

 private:
  std::size_t index_of(const std::string& column) const;

  std::string name_;
  std::vector<std::string> columns_;
  std::vector<std::vector<Cell>> rows_;
};

/// Writes `table` into `folder` as NAME.csv. Throws std::runtime_error if that fails.
void write(const Table& table, const std::filesystem::path& folder);

}  // namespace evodevo::tools
