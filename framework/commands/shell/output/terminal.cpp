#include "commands/shell/output/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <numeric>
#include <string_view>

namespace evodevo {
namespace {

constexpr std::size_t between_parts = 2;  // columns between two parts

/// The columns of a line.
std::size_t columns_of(const std::vector<LinePart>& parts) {
  return std::accumulate(parts.begin(), parts.end(), std::size_t{0},
                         [](std::size_t sum, const LinePart& part) { return sum + part.text.size() + between_parts; }) -
         (parts.empty() ? 0 : between_parts);
}

}  // namespace

bool shows_colours(int descriptor) {
  const auto variable = [](const char* name) {
    const char* const value = std::getenv(name);
    return std::string_view(value != nullptr ? value : "");
  };
  return isatty(descriptor) == 1 && variable("NO_COLOR").empty() && variable("TERM") != "dumb";
}

std::string bold(const std::string& text) { return shows_colours(STDOUT_FILENO) ? "\x1b[1m" + text + "\x1b[0m" : text; }

std::size_t terminal_columns() {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  const char* const columns = std::getenv("COLUMNS");
  const int given = columns != nullptr ? std::atoi(columns) : 0;
  return given > 0 ? static_cast<std::size_t>(given) : 80;
}

std::vector<std::string> fitting_parts(std::vector<LinePart> parts, std::size_t columns) {
  while (columns_of(parts) > columns) {
    const auto last = std::max_element(parts.rbegin(), parts.rend(),
                                       [](const LinePart& a, const LinePart& b) { return a.rank < b.rank; });
    if (last == parts.rend() || last->rank == 0) break;
    parts.erase(std::next(last).base());
  }
  std::vector<std::string> fitting;
  std::size_t used = 0;
  for (LinePart& part : parts) {
    if (used >= columns) break;
    fitting.push_back(part.text.substr(0, columns - used));
    used += part.text.size() + between_parts;
  }
  return fitting;
}

void LiveLine::show(const std::function<std::string(std::size_t columns)>& line) {
  constexpr std::chrono::milliseconds least{200};
  if (std::chrono::steady_clock::now() - shown_ >= least) write(line);
}

void LiveLine::finish(const std::function<std::string(std::size_t columns)>& line) {
  write(line);
  std::cout << std::endl;
}

void LiveLine::write(const std::function<std::string(std::size_t columns)>& line) {
  shown_ = std::chrono::steady_clock::now();
  // a line of full width would move the cursor to the next line
  std::cout << "\r\x1b[K" << line(terminal_columns() - 1) << std::flush;
}

}  // namespace evodevo
