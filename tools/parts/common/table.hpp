// Tables of results, written as CSV.
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace evodevo::tools {

using Cell = std::variant<std::string, double>;

/// Columns with their units, such as "dt (s)", and rows.
class Table {
 public:
  Table(std::string name, std::vector<std::string> columns) : name_(std::move(name)), columns_(std::move(columns)) {}

  /// Throws std::logic_error for a row that has more or fewer cells than there are columns.
  void add(std::vector<Cell> row);

  const std::string& name() const { return name_; }
  const std::vector<std::vector<Cell>>& rows() const { return rows_; }
  /// The number in a row's column. Throws std::logic_error where there is none.
  double number(std::size_t row, const std::string& column) const;
  const std::string& text(std::size_t row, const std::string& column) const;

  /// As CSV; what is not finite is left empty.
  std::string csv() const;

 private:
  std::size_t index_of(const std::string& column) const;

  std::string name_;
  std::vector<std::string> columns_;
  std::vector<std::vector<Cell>> rows_;
};

/// Writes `table` into `folder` as NAME.csv. Throws std::runtime_error where that fails.
void write(const Table& table, const std::filesystem::path& folder);

}  // namespace evodevo::tools
