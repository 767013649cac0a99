// The terminal to which a command prints.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace evodevo {

/// Whether a file descriptor is a terminal that shows colours: not if the variable NO_COLOR is set to
/// anything but an empty text, or if TERM is "dumb".
bool shows_colours(int descriptor);

/// Returns `text` in bold if standard output shows colours.
std::string bold(const std::string& text);

/// The number of columns of the terminal on standard output: as the system says, otherwise as the variable COLUMNS
/// says, otherwise 80.
std::size_t terminal_columns();

/// A part of a line.
struct LinePart {
  std::string text;  ///< one column for each character
  int rank = 0;      ///< parts of the highest rank are left out first; those of rank 0 stay
};

/// Returns the parts that fit into `columns` together, separated by two spaces. Of parts of equal rank, the last is
/// left out first. If those of rank 0 do not fit, the line is cut.
std::vector<std::string> fitting_parts(std::vector<LinePart> parts, std::size_t columns);

/// A line on the terminal of standard output that is kept up to date.
class LiveLine {
 public:
  /// Shows `line(columns)` instead of what the line showed, but at most five times a second.
  void show(const std::function<std::string(std::size_t columns)>& line);
  /// Shows it for the last time, and goes to the next line.
  void finish(const std::function<std::string(std::size_t columns)>& line);

 private:
  void write(const std::function<std::string(std::size_t columns)>& line);

  std::chrono::steady_clock::time_point shown_{};
};

}  // namespace evodevo
