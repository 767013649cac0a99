#include "base/json_input.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/input_error.hpp"
#include "base/input_file.hpp"
#include "base/text.hpp"

namespace evodevo {
namespace {

using Json = JsonInput::Json;

constexpr std::size_t most_levels = 16;
constexpr std::size_t most_bytes = std::size_t{1} << 30;  // 1 GiB, enough for about ten million springs
constexpr std::size_t longest_quote = 60;  ///< largest number of bytes that a message quotes from the file

std::string cut(std::string text, std::size_t longest) {
  if (text.size() > longest) text.replace(longest, std::string::npos, "...");
  return text;
}

/// Returns a value as messages show it: on one line, without control characters, cut to longest_quote.
std::string shown(const Json& value) { return cut(value.dump(-1, ' ', true), longest_quote); }

/// Returns a text as shown() does, but without the quotes around it.
std::string unquoted(const std::string& text) {
  const std::string quoted = Json(text).dump(-1, ' ', true);
  return cut(quoted.substr(1, quoted.size() - 2), longest_quote);
}

std::string member_of(const std::string& at, const std::string& key) { return at.empty() ? key : at + "." + key; }

/// Callback of the JSON parser. It tracks the place in the file, and refuses duplicate keys and too many levels of
/// nesting.
class ParserWatch {
 public:
  explicit ParserWatch(const JsonInput& input) : input_(input) {}

  /// Called by the parser at each event.
  bool operator()(int, Json::parse_event_t event, const Json& parsed) {
    switch (event) {
      case Json::parse_event_t::object_start:
      case Json::parse_event_t::array_start:
        if (levels_.size() == most_levels)
          input_.fail(location(),
                      "is nested more than " + std::to_string(most_levels) + " levels deep; no body needs that many");
        levels_.push_back({.is_list = event == Json::parse_event_t::array_start});
        break;
      case Json::parse_event_t::object_end:
      case Json::parse_event_t::array_end:
        levels_.pop_back();
        count_item();
        break;
      case Json::parse_event_t::key:
        add_key(parsed.get<std::string>());
        break;
      case Json::parse_event_t::value:
        count_item();
        break;
    }
    return true;
  }

 private:
  /// A list or an object that the parser has not finished.
  struct Level {
    bool is_list = false;
    std::size_t items = 0;            ///< number of items of a list read so far
    std::string key = {};             ///< last key of an object
    std::set<std::string> keys = {};  ///< all keys of an object read so far
  };

  void add_key(const std::string& key) {
    if (!levels_.back().keys.insert(key).second)
      input_.fail(member_of(location_of_level(), unquoted(key)), "is given twice; remove one of the two");
    levels_.back().key = key;
  }

  void count_item() {
    if (!levels_.empty() && levels_.back().is_list) ++levels_.back().items;
  }

  /// The place of the innermost unfinished list or object.
  std::string location_of_level() const {
    std::string at;
    for (std::size_t i = 0; i + 1 < levels_.size(); ++i) at = step(at, levels_[i]);
    return at;
  }

  /// The place of the value that comes next.
  std::string location() const { return levels_.empty() ? "" : step(location_of_level(), levels_.back()); }

  static std::string step(const std::string& at, const Level& level) {
    if (level.is_list) return at + "[" + std::to_string(level.items) + "]";
    return member_of(at, unquoted(level.key));
  }

  const JsonInput& input_;
  std::vector<Level> levels_;
};

/// Removes the parser's error code, such as "[json.exception.parse_error.101] ", from its message, and cuts long
/// messages.
std::string complaint(const std::string& what) {
  const auto end = what.find("] ");
  return cut(end == std::string::npos ? what : what.substr(end + 2), 3 * longest_quote);
}

}  // namespace

Json JsonInput::read() const {
  const std::string text = read_input_file(file_, most_bytes);
  try {
    return Json::parse(text, ParserWatch(*this));
  } catch (const Json::exception& error) {
    fail("", "is not valid JSON: " + complaint(error.what()));
  }
}

void JsonInput::expect(const Json& item, const std::string& at, const std::vector<std::string>& keys) const {
  if (!item.is_object()) fail(at, "expected an object, found " + shown(item));
  for (const auto& [key, value] : item.items())
    if (std::find(keys.begin(), keys.end(), key) == keys.end())
      fail(member_of(at, unquoted(key)), "is not a known key" + suggestion(key, keys));
}

const Json& JsonInput::member(const Json& item, const std::string& at, const std::string& key) const {
  if (!item.is_object() || !item.contains(key)) fail(at, "\"" + key + "\" is missing");
  return item.at(key);
}

double JsonInput::finite(const Json& value, const std::string& at, double least, double most) const {
  if (!value.is_number()) fail(at, "expected a number, found " + shown(value));
  const double number = value.get<double>();
  if (!std::isfinite(number) || number < least || number > most)
    fail(at, shown(value) + " is out of range; expected " +
                 (least == std::numeric_limits<double>::lowest() ? "a finite number"
                  : most < any                                   ? to_text(least) + " to " + to_text(most)
                                                                 : "at least " + to_text(least)));
  return number;
}

double JsonInput::number(const Json& item, const std::string& at, const std::string& key, double least,
                         double most) const {
  return finite(member(item, at, key), member_of(at, key), least, most);
}

std::uint32_t JsonInput::index(const Json& item, const std::string& at, const std::string& key,
                               std::size_t count) const {
  const Json& value = member(item, at, key);
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= count)
    fail(member_of(at, key),
         shown(value) + " is not a valid index; expected a whole number below " + std::to_string(count));
  return value.get<std::uint32_t>();
}

void JsonInput::fail(const std::string& at, const std::string& message) const {
  throw ConfigError(printable(file_, longest_shown_path) + ": " + (at.empty() ? "" : at + ": ") + message);
}

}  // namespace evodevo
