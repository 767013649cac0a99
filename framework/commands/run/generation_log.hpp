// A log of a run for other programs.
#pragma once

#include <filesystem>
#include <fstream>

#include "archive/population.hpp"

namespace evodevo {

/// Appends one line to a file for each generation: a JSON object with the members of Summary under the names that
/// `show --json` uses. A missing value is null.
class GenerationLog {
 public:
  /// Throws UsageError if the file cannot be opened.
  explicit GenerationLog(const std::filesystem::path& file);

  /// Adds a line, which also names the island, numbered from 1, unless it is 0. If it cannot be written, the log ends
  /// there: a warning says so once, and the run goes on.
  void add(const Summary& summary, std::int64_t island = 0);

 private:
  std::filesystem::path file_;
  std::ofstream stream_;
  bool failed_ = false;
};

}  // namespace evodevo
