#include "base/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <sstream>

namespace evodevo {
namespace {

/// The words for NaN or an infinite number; empty for a finite number.
std::string word_for(double value) {
  if (std::isnan(value)) return "not a number";
  if (std::isinf(value)) return value > 0 ? "infinity" : "-infinity";
  return "";
}

}  // namespace

std::string program_name() {
  const char* name = std::getenv("EVODEVO_COMMAND");
  return name != nullptr ? name : "evodevo";
}

std::string shell_word(std::string_view word) {
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("-._/=+:,@%").find(c) != std::string_view::npos;
  };
  if (!word.empty() && word.front() != '=' && std::ranges::all_of(word, is_plain)) return std::string(word);
  std::string inner(word);
  if (printable(word, std::string::npos) == word) {
    replace_all(inner, "'", "'\\''");
    return "'" + inner + "'";
  }
  inner.clear();  // such characters must not reach a terminal: escapes of bash and zsh
  for (const char c : word)
    inner += is_plain(c) ? std::string(1, c) : fmt::format("\\{:03o}", static_cast<unsigned char>(c));
  return "$'" + inner + "'";
}

std::string shell_command(std::initializer_list<std::string_view> words) {
  std::string command = program_name();
  for (const std::string_view word : words) command += ' ' + shell_word(word);
  return command;
}

namespace {

/// The first character of a non-empty text.
struct Character {
  std::size_t bytes = 1;
  std::optional<char32_t> code;  ///< code point; none if the bytes are not valid UTF-8
};

Character first_character(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (byte(0) < 0x80) return {1, byte(0)};
  // one entry for each length of two or more bytes: the mask and mark of the leading byte, and the smallest code point
  // that needs this length
  constexpr struct {
    unsigned mask, mark;
    char32_t least;
  } forms[] = {{0xe0, 0xc0, 0x80}, {0xf0, 0xe0, 0x800}, {0xf8, 0xf0, 0x10000}};
  for (std::size_t more = 1; more <= std::size(forms); ++more) {
    const auto& form = forms[more - 1];
    if ((byte(0) & form.mask) != form.mark) continue;
    if (text.size() <= more) return {};
    char32_t code = byte(0) & ~form.mask;
    for (std::size_t i = 1; i <= more; ++i) {
      if ((byte(i) & 0xc0) != 0x80) return {};
      code = code << 6 | (byte(i) & 0x3f);
    }
    const bool surrogate = code >= 0xd800 && code < 0xe000;
    return code < form.least || code > 0x10ffff || surrogate ? Character{} : Character{more + 1, code};
  }
  return {};
}

/// Whether a character is a control character, separates lines or paragraphs, or changes the text direction.
bool disturbs(char32_t code) {
  const auto within = [&](char32_t low, char32_t high) { return code >= low && code <= high; };
  return code < 0x20 || within(0x7f, 0x9f) || within(0x2028, 0x202e) || within(0x2066, 0x2069);
}

std::string escaped_byte(unsigned code) { return fmt::format("\\x{:02x}", code); }

std::string escape(char32_t code) {
  if (code == '\n') return "\\n";
  if (code == '\r') return "\\r";
  if (code == '\t') return "\\t";
  const auto number = static_cast<unsigned>(code);
  return number < 0x80 ? escaped_byte(number) : fmt::format("\\u{:04x}", number);
}

}  // namespace

std::string printable(std::string_view text, std::size_t most) {
  constexpr std::string_view cut = "...";
  std::string clean;
  std::size_t room = 0;  // length of the longest prefix after which `cut` still fits
  while (!text.empty()) {
    const Character next = first_character(text);
    if (!next.code)
      clean += escaped_byte(static_cast<unsigned char>(text[0]));
    else if (disturbs(*next.code))
      clean += escape(*next.code);
    else
      clean += text.substr(0, next.bytes);
    if (clean.size() > most) return clean.substr(0, room) + std::string(cut);
    if (clean.size() + cut.size() <= most) room = clean.size();
    text.remove_prefix(next.bytes);
  }
  return clean;
}

std::string text_fault(std::string_view text, std::size_t most) {
  if (printable(text, most) == text) return "";
  return '"' + printable(text) + "\" must be at most " + std::to_string(most) +
         " bytes of UTF-8 without control characters";
}

std::string to_text(double value) {
  return std::isfinite(value) ? fmt::format("{}", value + 0.0) : word_for(value);  // -0 becomes 0
}

std::string short_number(double value) {
  return std::isfinite(value) ? fmt::format("{:.4g}", value + 0.0) : word_for(value);
}

std::string short_quantity(double value, const std::string& unit) {
  return short_number(value) + (unit.empty() || unit == "1" ? "" : " " + unit);
}

std::string to_text(const Range& range) {
  if (std::isinf(range.low) && std::isinf(range.high)) return "";
  if (std::isinf(range.high)) return "at least " + to_text(range.low);
  if (std::isinf(range.low)) return "at most " + to_text(range.high);
  return to_text(range.low) + " to " + to_text(range.high);
}

std::string joined(std::span<const std::string> items, std::string_view separator) {
  std::string text;
  for (const std::string& item : items) {
    if (&item != items.data()) text += separator;
    text += item;
  }
  return text;
}

namespace {

/// Returns the Levenshtein distance: the smallest number of letters to add, drop or replace to turn `a` into `b`.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string wrapped(const std::string& text, std::size_t indent) {
  constexpr std::size_t width = 80;
  std::istringstream words(text);
  std::string lines;
  std::size_t column = indent;
  for (std::string word; words >> word;) {
    if (column > indent && column + 1 + word.size() > width) {
      lines += '\n' + std::string(indent, ' ');
      column = indent;
    } else if (column > indent) {
      lines += ' ';
      ++column;
    }
    lines += word;
    column += word.size();
  }
  return lines;
}

void replace_all(std::string& text, std::string_view mark, std::string_view value) {
  for (std::size_t at = 0; (at = text.find(mark, at)) != std::string::npos; at += value.size())
    text.replace(at, mark.size(), value);
}

std::string nearest(std::string_view word, std::span<const std::string> candidates) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(word.size() / 3, 1) + 1;  // a third of the letters may be wrong
  for (const std::string& candidate : candidates) {
    const std::size_t shorter = std::min(word.size(), candidate.size()),
                      longer = std::max(word.size(), candidate.size());
    if (longer - shorter >= best_distance) continue;  // the distance is at least the difference in length
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

std::string suggestion(std::string_view word, std::span<const std::string> candidates) {
  constexpr std::size_t few = 3;  // up to this number all are listed: the nearest to a misspelt "cuda" may be "cpu"
  if (candidates.empty()) return "; none is known";
  if (const std::string near = nearest(word, candidates); !near.empty() && candidates.size() > few)
    return "; did you mean \"" + near + "\"?";
  return "; known: " + joined(candidates);
}

}  // namespace evodevo
