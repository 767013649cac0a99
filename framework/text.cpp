#include "text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <numeric>

namespace evodevo {

std::string program_name() {
  const char* name = std::getenv("EVODEVO_COMMAND");
  return name != nullptr ? name : "evodevo";
}

std::string to_text(double value) {
  std::array<char, 32> buffer;
  const bool whole = value == std::floor(value) && std::abs(value) < 1e15;
  if (whole) return std::to_string(static_cast<long long>(value));
  // six digits do for what people write; more only where the number has more
  for (int digits = 6;; ++digits) {
    char* const end =
        std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::general, digits).ptr;
    double back = 0;
    std::from_chars(buffer.data(), end, back);
    if (back == value || digits == 17) return {buffer.data(), end};
  }
}

std::string to_text(const Range& range) {
  if (std::isinf(range.low) && std::isinf(range.high)) return "";
  if (std::isinf(range.high)) return "at least " + to_text(range.low);
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

/// Levenshtein's distance: how many letters must be added, dropped or replaced.
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

void replace_all(std::string& text, std::string_view mark, std::string_view value) {
  for (std::size_t at = 0; (at = text.find(mark, at)) != std::string::npos; at += value.size())
    text.replace(at, mark.size(), value);
}

std::string nearest(std::string_view word, std::span<const std::string> candidates) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(word.size() / 3, 1) + 1;  // a third of the letters may be wrong
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

std::string suggestion(std::string_view word, std::span<const std::string> candidates) {
  constexpr std::size_t few = 3;  // are all named, so that nobody who meant "cuda" is sent to "cpu"
  if (candidates.empty()) return "; none is known";
  if (const std::string near = nearest(word, candidates); !near.empty() && candidates.size() > few)
    return "; did you mean \"" + near + "\"?";
  return "; known: " + joined(candidates);
}

}  // namespace evodevo
