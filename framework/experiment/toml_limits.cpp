#include "experiment/toml_limits.hpp"

#include <algorithm>
#include <memory>

#include "experiment/toml_reader.hpp"

namespace evodevo {
namespace {

/// Counts levels outside comments and strings. The count is correct up to the first syntax error, where a parser stops.
class LevelCounter {
 public:
  LevelCounter(std::string_view text, const std::string& origin) : text_(text), origin_(origin) {}

  void count() {
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '#')
        skip_comment();
      else if (c == '"' || c == '\'')
        skip_string(c);
      else
        count(c), ++at_;
    }
  }

 private:
  void count(char c) {
    if (c == '[' || c == '{') {
      if (++brackets_ > most_toml_levels) fail("brackets within brackets");
    } else if (c == ']' || c == '}') {
      --brackets_;
    }
    if (c == '.') {
      if (++dots_ > most_toml_levels) fail("dots in one key");
    } else if (std::string_view("[]{},=\n").find(c) != std::string_view::npos) {
      dots_ = 0;
    }
  }

  void skip_comment() { at_ = std::min(text_.find('\n', at_), text_.size()); }

  /// Skips a string. If it begins with one quote, it ends no later than its line; if it begins with three quotes, it
  /// may have several lines. In a string with double quotes, a backslash escapes a quote.
  void skip_string(char quote) {
    const std::string three(3, quote);
    const bool many_lines = text_.substr(at_).starts_with(three);
    at_ += many_lines ? 3 : 1;
    while (at_ < text_.size()) {
      const std::string_view rest = text_.substr(at_);
      if (!many_lines && rest[0] == '\n') return;
      if (many_lines ? rest.starts_with(three) : rest[0] == quote) {
        at_ += many_lines ? 3 : 1;
        // the text may end with up to two quotes before the three that end the string
        while (many_lines && at_ < text_.size() && text_[at_] == quote) ++at_;
        return;
      }
      at_ += quote == '"' && rest[0] == '\\' ? 2 : 1;
    }
  }

  [[noreturn]] void fail(const std::string& what) const {
    const std::string_view before = text_.substr(0, at_), line = before.substr(before.rfind('\n') + 1);
    const auto begins_character = [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; };
    toml::source_region here;
    here.begin.line = static_cast<toml::source_index>(1 + std::count(before.begin(), before.end(), '\n'));
    here.begin.column = static_cast<toml::source_index>(1 + std::count_if(line.begin(), line.end(), begins_character));
    here.path = std::make_shared<const std::string>(origin_);
    throw ConfigError(location_of(here) + ": more than " + std::to_string(most_toml_levels) + " " + what +
                      "; no experiment needs so many");
  }

  std::string_view text_;
  const std::string& origin_;
  std::size_t at_ = 0;
  int brackets_ = 0, dots_ = 0;
};

}  // namespace

void expect_within_toml_limits(std::string_view text, const std::string& origin) {
  if (text.size() > most_toml_bytes)
    throw ConfigError(printable(origin) + ": holds " + std::to_string(text.size()) + " bytes; expected at most " +
                      std::to_string(most_toml_bytes));
  LevelCounter(text, origin).count();
}

}  // namespace evodevo
