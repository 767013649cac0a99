#include "commands/shell/output/excerpt.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>

#include "base/text.hpp"

namespace evodevo {
namespace {

constexpr std::uintmax_t largest_file = std::uintmax_t{1} << 20;  // bytes; nobody writes larger ones by hand
constexpr std::size_t longest_line = 200;                         // bytes

std::optional<std::string> line_of(const std::string& file, unsigned long number) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error) || std::filesystem::file_size(file, error) > largest_file)
    return std::nullopt;
  std::ifstream stream(file);
  std::string line;
  for (unsigned long i = 0; i < number; ++i)
    if (!std::getline(stream, line)) return std::nullopt;
  if (line.ends_with('\r')) line.pop_back();
  return line;
}

/// Returns the number of bytes that hold the first `characters` characters of UTF-8 text.
std::size_t bytes_of(const std::string& text, unsigned long characters) {
  std::size_t bytes = 0;
  for (; bytes < text.size(); ++bytes) {
    const bool begins = (static_cast<unsigned char>(text[bytes]) & 0xc0) != 0x80;
    if (begins && characters-- == 0) break;
  }
  return bytes;
}

/// Removes a colon and a number of up to seven digits from the beginning of `text`, and returns the number.
std::optional<unsigned long> take_number(std::string_view& text) {
  unsigned long number = 0;
  if (!text.starts_with(':')) return std::nullopt;
  const auto [end, error] =
      std::from_chars(text.data() + 1, text.data() + std::min<std::size_t>(text.size(), 8), number);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

struct Place {
  std::string file;
  unsigned long line = 0, column = 0;
};

/// Returns the place that a message begins with, as in "FILE:LINE:COLUMN: ".
std::optional<Place> place_of(std::string_view message) {
  message = message.substr(0, message.find('\n'));
  for (std::size_t colon = message.find(':', 1); colon != message.npos; colon = message.find(':', colon + 1)) {
    std::string_view rest = message.substr(colon);
    const auto line = take_number(rest);
    const auto column = line ? take_number(rest) : std::nullopt;
    if (column && rest.starts_with(": ")) return Place{std::string(message.substr(0, colon)), *line, *column};
  }
  return std::nullopt;
}

}  // namespace

std::string excerpt_for(const std::string& message) {
  const std::optional<Place> place = place_of(message);
  if (!place) return {};
  const auto& [file, number, column] = *place;
  std::optional<std::string> line = line_of(file, number);
  if (!line || line->size() > longest_line || column == 0) return {};
  const std::size_t before = bytes_of(*line, column - 1);
  std::string indent;
  for (const char c : printable(line->substr(0, before)))
    if ((static_cast<unsigned char>(c) & 0xc0) != 0x80) indent += ' ';
  const std::string margin(std::to_string(number).size(), ' ');
  return fmt::format("  {} | {}\n  {} | {}^\n", number, printable(*line), margin, indent);
}

}  // namespace evodevo
