#include "experiment/toml_reader.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "base/input_file.hpp"
#include "base/text.hpp"
#include "experiment/toml_limits.hpp"

namespace evodevo {
namespace {

constexpr std::size_t most_numbers = 100'000;                   ///< largest number of numbers in one list
constexpr std::size_t most_text_bytes = 10'000;                 ///< largest size of a text
constexpr std::size_t most_file_bytes = std::size_t{64} << 20;  ///< largest size of a file that a parameter names
constexpr std::size_t most_texts = 1000;                        ///< largest number of strings in one list

/// Former names of keys, each with its present name.
const std::map<std::string, std::string> renamed_keys{{"experiment.newcomers", "experiment.random_individuals"},
                                                      {"scene.load", "scene.payload"}};

}  // namespace

toml::table parse_toml(std::string_view text, const std::string& origin) {
  expect_within_toml_limits(text, origin);
  try {
    return toml::parse(text, std::string_view(origin));
  } catch (const toml::parse_error& error) {
    throw ConfigError(location_of(error.source()) + ": " + printable(error.description()));
  }
}

toml::table parse_toml_file(const std::string& file) {
  return parse_toml(read_input_file(file, most_toml_file_bytes), file);
}

std::string location_of(const toml::source_region& source) {
  const std::string file = source.path ? printable(*source.path, longest_shown_path) : "";
  // neither a command-line option nor an argument of a function has line numbers
  if (!source.begin || file.starts_with("--") || file.ends_with("()")) return file;
  return file + ":" + std::to_string(source.begin.line) + ":" + std::to_string(source.begin.column);
}

std::string value_text(const toml::node& node) {
  if (node.is_table()) return "a table";
  const toml::array* array = node.as_array();
  if (array != nullptr && std::any_of(array->begin(), array->end(), [](const auto& item) { return item.is_table(); }))
    return "a list with tables";
  if (const auto* number = node.as_floating_point(); number != nullptr && std::isfinite(number->get()))
    return to_text(number->get());
  std::ostringstream text;
  node.visit([&](const auto& n) { text << toml::toml_formatter(n, toml::format_flags::none); });
  std::string one_line = text.str();
  std::replace(one_line.begin(), one_line.end(), '\n', ' ');  // line breaks between items of a long list
  return one_line;
}

namespace {

/// Returns a message such as "expected a number, 0 to 1 s", without parts that are empty and without the unit "1".
std::string expected(const std::string& what, const Range& range) {
  const std::string ends = to_text(range), separator = what.empty() || ends.empty() ? "" : ", ";
  const std::string unit = range.unit == "1" || ends.empty() ? "" : " " + std::string(range.unit);
  return "expected " + what + separator + ends + unit;
}

}  // namespace

std::string TomlReader::full_name(std::string_view name) const {
  return printable(path_.empty() ? std::string(name) : path_ + "." + std::string(name));
}

void TomlReader::fail_at(const toml::node& node, std::string_view name, const std::string& message) const {
  throw ConfigError(location_of(node.source()) + ": " + full_name(name) + " = " + printable(value_text(node)) + ": " +
                    message);
}

std::string TomlReader::location(std::string_view name) const {
  const toml::node* node = table_.get(name);
  return location_of(node != nullptr ? node->source() : table_.source());
}

void TomlReader::fail(std::string_view name, const std::string& message) const {
  if (const toml::node* node = table_.get(name)) fail_at(*node, name, message);
  throw ConfigError(location(name) + ": " + full_name(name) + ": " + message);
}

void TomlReader::know(std::string_view name) {
  if (std::find(known_.begin(), known_.end(), name) == known_.end()) known_.emplace_back(name);
}

void TomlReader::expect(std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) know(name);
  refuse_unknown_keys();
}

void TomlReader::require_read_among(std::span<const std::string_view> names) const {
  for (const std::string& key : known_)
    if (std::find(names.begin(), names.end(), key) == names.end())
      throw std::logic_error(full_name(key) + " is read, but is none of the keys that may be");
}

const toml::node* TomlReader::look_up(std::string_view name) {
  know(name);
  return table_.get(name);
}

double TomlReader::number(const toml::node& node, std::string_view name, Range range) const {
  if (!node.is_number()) fail_at(node, name, expected("a number", range));
  const double value =
      node.is_integer() ? static_cast<double>(node.as_integer()->get()) : node.as_floating_point()->get();
  const bool has_ends = std::isfinite(range.low) && std::isfinite(range.high);
  // written so that NaN fails
  if (!(value >= range.low && value <= range.high) || std::isinf(value))
    fail_at(node, name, expected(has_ends ? "" : "a finite number", range));
  return value;
}

std::int64_t TomlReader::whole_number(const toml::node& node, std::string_view name, Range range) const {
  if (!node.is_number()) fail_at(node, name, expected("a whole number", range));
  const double value = number(node, name, range);
  if (node.is_integer()) return node.as_integer()->get();
  constexpr double beyond = 0x1p63;
  if (value != std::floor(value) || !(std::abs(value) < beyond)) fail_at(node, name, expected("a whole number", range));
  return static_cast<std::int64_t>(value);
}

const toml::array& TomlReader::three(const toml::node& node, std::string_view name) const {
  const toml::array* array = node.as_array();
  if (array == nullptr || array->size() != 3) fail_at(node, name, "expected a list of three numbers");
  return *array;
}

void TomlReader::real(double& value, std::string_view name, Range range, std::string_view) {
  if (const toml::node* node = look_up(name)) value = number(*node, name, range);
}

void TomlReader::integer(std::int64_t& value, std::string_view name, Range range, std::string_view) {
  if (const toml::node* node = look_up(name)) value = whole_number(*node, name, range);
}

void TomlReader::flag(bool& value, std::string_view name, std::string_view) {
  if (const toml::node* node = look_up(name)) {
    if (!node->is_boolean()) fail_at(*node, name, "expected true or false");
    value = node->value<bool>().value();
  }
}

void TomlReader::choice(std::string& value, std::string_view name, std::initializer_list<std::string_view> options,
                        std::string_view) {
  if (const toml::node* node = look_up(name)) {
    const std::vector<std::string> names(options.begin(), options.end());
    if (!node->is_string()) fail_at(*node, name, "expected one of " + joined(names));
    value = node->value<std::string>().value();
    if (std::find(names.begin(), names.end(), value) == names.end())
      fail_at(*node, name, "is not an option" + suggestion(value, names));
  }
}

void TomlReader::vector(Vec3& value, std::string_view name, Range range, std::string_view) {
  if (const toml::node* node = look_up(name)) {
    const toml::array& array = three(*node, name);
    value = {number(array[0], name, range), number(array[1], name, range), number(array[2], name, range)};
  }
}

void TomlReader::counts(std::array<std::int64_t, 3>& value, std::string_view name, Range range, std::string_view) {
  if (const toml::node* node = look_up(name)) {
    const toml::array& array = three(*node, name);
    for (std::size_t i = 0; i < 3; ++i) value[i] = whole_number(array[i], name, range);
  }
}

void TomlReader::optional_real(std::optional<double>& value, std::string_view name, Range range, std::string_view) {
  if (const toml::node* node = look_up(name)) value = number(*node, name, range);
}

void TomlReader::reals(std::vector<double>& value, std::string_view name, Range range, std::string_view) {
  const toml::node* node = look_up(name);
  if (node == nullptr) return;
  const toml::array* array = node->as_array();
  if (array == nullptr || array->size() > most_numbers)
    fail_at(*node, name, expected("a list of at most " + std::to_string(most_numbers) + " numbers", range));
  value.clear();
  for (const toml::node& item : *array) value.push_back(number(item, name, range));
}

void TomlReader::text(std::string& value, std::string_view name, std::string_view) {
  value = text(name, value.c_str());
  if (value.size() > most_text_bytes)
    fail(name, "expected a text of at most " + std::to_string(most_text_bytes) + " bytes");
}

void TomlReader::file(InputFile& value, std::string_view name, std::string_view) {
  value.path = text(name, value.path.c_str());
  if (value.path.empty()) return;
  if (references_.recorded_files != nullptr) {
    const auto recorded = references_.recorded_files->find(value.path);
    if (recorded == references_.recorded_files->end()) fail(name, "is not among the files of the run");
    value.content = recorded->second;
  } else {
    try {
      value.content = read_input_file((references_.folder / value.path).string(), most_file_bytes);
    } catch (const ConfigError& error) {
      fail(name, error.what());
    }
  }
  if (references_.files != nullptr) (*references_.files)[value.path] = value.content;
}

void TomlReader::materials(std::vector<std::string>& value, std::string_view name, std::string_view) {
  if (const auto named = texts(name); !named.empty()) value = named;
  for (const std::string& material : value) {
    if (std::find(references_.materials->begin(), references_.materials->end(), material) ==
        references_.materials->end())
      fail(name, "\"" + material + "\" is not a material" + suggestion(material, *references_.materials));
    if (std::count(value.begin(), value.end(), material) > 1)
      fail(name, "names \"" + material + "\" twice; remove one of the two");
  }
}

void TomlReader::require(bool holds, std::string_view name, std::string_view text) {
  if (!holds) fail(name, std::string(text));
}

void TomlReader::real_or_auto(std::optional<double>& value, std::string_view name, Range range, std::string_view) {
  if (const toml::node* node = look_up(name)) {
    if (!node->is_string())
      value = number(*node, name, range);
    else if (node->value<std::string>() == "auto")
      value.reset();
    else
      fail_at(*node, name, "expected a number or \"auto\"");
  }
}

std::string TomlReader::text(std::string_view name, const char* fallback) {
  const toml::node* node = look_up(name);
  if (node == nullptr && fallback == nullptr) fail(name, "is missing; add it with a text in quotes");
  if (node != nullptr && !node->is_string()) fail_at(*node, name, "expected a text in quotes");
  return node != nullptr ? node->value<std::string>().value() : fallback;
}

std::vector<std::string> TomlReader::texts(std::string_view name) {
  std::vector<std::string> values;
  const toml::node* node = look_up(name);
  if (node == nullptr) return values;
  if (!node->is_array()) fail_at(*node, name, "expected a list of texts");
  if (node->as_array()->size() > most_texts)
    fail_at(*node, name, "expected at most " + std::to_string(most_texts) + " texts");
  for (const toml::node& item : *node->as_array()) {
    if (!item.is_string()) fail_at(*node, name, "expected a list of texts");
    values.push_back(item.value<std::string>().value());
  }
  return values;
}

std::vector<std::string> TomlReader::keys() const {
  std::vector<std::string> keys;
  for (auto&& [key, node] : table_) keys.emplace_back(key.str());
  return keys;
}

toml::table TomlReader::empty_table() const {
  const toml::source_path_ptr& file = table_.source().path;
  return parse_toml("", file ? *file : "");
}

const toml::table* TomlReader::table(std::string_view name) {
  const toml::node* node = look_up(name);
  if (node != nullptr && !node->is_table()) fail_at(*node, name, "expected a table, [" + full_name(name) + "]");
  return node != nullptr ? node->as_table() : nullptr;
}

std::vector<const toml::table*> TomlReader::tables(std::string_view name) {
  std::vector<const toml::table*> found;
  const toml::node* node = look_up(name);
  if (node == nullptr) return found;
  const std::string remedy = "expected an array of tables, [[" + full_name(name) + "]]";
  if (!node->is_array()) fail_at(*node, name, remedy);
  for (const toml::node& item : *node->as_array()) {
    if (!item.is_table()) fail_at(*node, name, remedy);
    found.push_back(item.as_table());
  }
  return found;
}

void TomlReader::refuse_unknown_keys() const {
  for (auto&& [key, node] : table_) {
    const std::string name(key.str());
    if (std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
    const auto renamed = renamed_keys.find(full_name(name));
    if (renamed != renamed_keys.end())
      throw ConfigError(location_of(key.source()) + ": " + full_name(name) + ": is now called " + renamed->second +
                        "; rename it");
    const std::string where = path_.empty() ? "an experiment" : "[" + printable(path_) + "]";
    throw ConfigError(location_of(key.source()) + ": " + full_name(name) + ": is not a key of " + where +
                      suggestion(name, known_));
  }
}

void TomlReader::finish() const { refuse_unknown_keys(); }

}  // namespace evodevo
