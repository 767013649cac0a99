#include "commands/shell/output/excerpt.hpp"

#include <fmt/format.h>

#include <charconv>
#include <filesystem>
#include <fstream>
#include <optional>
#include <regex>

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

}  // namespace

std::string excerpt_for(const std::string& message) {
  static const std::regex place("^([^\n]+?):([0-9]{1,7}):([0-9]{1,7}): ");
  std::smatch match;
  if (!std::regex_search(message, match, place)) return {};
  const unsigned long number = std::stoul(match[2]), column = std::stoul(match[3]);
  std::optional<std::string> line = line_of(match[1], number);
  if (!line || line->size() > longest_line || column == 0) return {};
  const std::size_t before = bytes_of(*line, column - 1);
  std::string indent;
  for (const char c : printable(line->substr(0, before)))
    if ((static_cast<unsigned char>(c) & 0xc0) != 0x80) indent += ' ';
  const std::string margin(std::to_string(number).size(), ' ');
  return fmt::format("  {} | {}\n  {} | {}^\n", number, printable(*line), margin, indent);
}

}  // namespace evodevo
