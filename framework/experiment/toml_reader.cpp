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

namespace {

/// Returns the line and column of a node or key; 0 for a value that a command-line option or an argument of a function
/// has set.
toml::source_position position_of(const toml::source_region& source) {
  const bool is_in_file = !source.path || !(source.path->starts_with("--") || source.path->ends_with("()"));
  return is_in_file ? source.begin : toml::source_position{};
}

}  // namespace

std::string location_of(const toml::source_region& source) {
  const std::string file = source.path ? printable(*source.path, longest_shown_path) : "";
  const toml::source_position at = position_of(source);
  return at ? file + ":" + std::to_string(at.line) + ":" + std::to_string(at.column) : file;
}

std::string value_text(const toml::node& node) {
  if (node.is_table()) return "a table";
  const toml::array* array = node.as_array();
  if (array != nullptr && std::any_of(array->begin(), array->end(), [](const auto& item) { return item.is_table(); }))
    return "a list with tables";
  if (const auto* number = node.as_floating_point(); number != nullptr && std::isfinite(number->get()))
    return to_text(number->get());
  std::ostringstream text;
  node.visit([&](const auto& n) { text << toml::toml_formatter(n, toml::format_flags::allow_unicode_strings); });
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

void TomlReader::fail_at(const toml::node& node, std::string_view name, const std::string& message,
                         std::vector<std::string> depends_on) const {
  const std::string place = location_of(node.source()), key = full_name(name);
  throw KeyError(place + ": " + key + " = " + printable(value_text(node)) + ": " + message, key,
                 position_of(node.source()), std::move(depends_on));
}

std::string TomlReader::location(std::string_view name) const {
  const toml::node* node = table_.get(name);
  return location_of(node != nullptr ? node->source() : table_.source());
}

void TomlReader::fail(std::string_view name, const std::string& message, std::vector<std::string> depends_on) const {
  if (const toml::node* node = table_.get(name)) fail_at(*node, name, message, std::move(depends_on));
  const std::string key = full_name(name);
  throw KeyError(location(name) + ": " + key + ": " + message, key, position_of(table_.source()),
                 std::move(depends_on));
}

void TomlReader::report(std::string_view name, const std::string& message, std::vector<std::string> depends_on) const {
  attempt([&] { fail(name, message, std::move(depends_on)); });
}

void TomlReader::stop_if_wrong() const {
  if (errors_ != nullptr) errors_->throw_error_in(path_);
}

void TomlReader::know(std::string_view name) {
  if (std::find(known_.begin(), known_.end(), name) == known_.end()) known_.emplace_back(name);
}

void TomlReader::expect(std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) know(name);
  report_unknown_keys();
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

template <class Take>
void TomlReader::read(std::string_view name, const Take& take) {
  if (const toml::node* node = look_up(name)) attempt([&] { take(*node); });
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

void TomlReader::declare(const Parameter& parameter) {
  std::visit([&](const auto& variable) { set(parameter.name, variable); }, parameter.variable);
}

void TomlReader::set(std::string_view name, const parameter::Real& real) {
  read(name, [&](const toml::node& node) { real.value = number(node, name, real.range); });
}

void TomlReader::set(std::string_view name, const parameter::Integer& integer) {
  read(name, [&](const toml::node& node) { integer.value = whole_number(node, name, integer.range); });
}

void TomlReader::set(std::string_view name, const parameter::Flag& flag) {
  read(name, [&](const toml::node& node) {
    if (!node.is_boolean()) fail_at(node, name, "expected true or false");
    flag.value = node.value<bool>().value();
  });
}

void TomlReader::set(std::string_view name, const parameter::Choice& choice) {
  read(name, [&](const toml::node& node) {
    const std::vector<std::string> names(choice.options.begin(), choice.options.end());
    if (!node.is_string()) fail_at(node, name, "expected one of " + joined(names));
    const std::string chosen = node.value<std::string>().value();
    if (std::find(names.begin(), names.end(), chosen) == names.end())
      fail_at(node, name, "is not an option" + suggestion(chosen, names));
    choice.value = chosen;
  });
}

void TomlReader::set(std::string_view name, const parameter::Vector& vector) {
  read(name, [&](const toml::node& node) {
    const toml::array& array = three(node, name);
    vector.value = {number(array[0], name, vector.range), number(array[1], name, vector.range),
                    number(array[2], name, vector.range)};
  });
}

void TomlReader::set(std::string_view name, const parameter::VectorOrChoice& either) {
  read(name, [&](const toml::node& node) {
    if (node.is_string()) return set(name, parameter::Choice{either.word, either.options});
    if (!node.is_array())
      fail_at(node, name,
              "expected three numbers, or one of " +
                  joined(std::vector<std::string>(either.options.begin(), either.options.end())));
    set(name, parameter::Vector{either.value, either.range});
    either.word.clear();
  });
}

void TomlReader::set(std::string_view name, const parameter::Counts& counts) {
  read(name, [&](const toml::node& node) {
    const toml::array& array = three(node, name);
    counts.value = {whole_number(array[0], name, counts.range), whole_number(array[1], name, counts.range),
                    whole_number(array[2], name, counts.range)};
  });
}

void TomlReader::set(std::string_view name, const parameter::OptionalReal& real) {
  read(name, [&](const toml::node& node) {
    if (real.none.empty() || !node.is_string())
      real.value = number(node, name, real.range);
    else if (node.value<std::string>() == real.none)
      real.value.reset();
    else
      fail_at(node, name, "expected a number or \"" + std::string(real.none) + "\"");
  });
}

void TomlReader::set(std::string_view name, const parameter::Reals& reals) {
  read(name, [&](const toml::node& node) {
    const toml::array* array = node.as_array();
    if (array == nullptr || array->size() > most_numbers)
      fail_at(node, name, expected("a list of at most " + std::to_string(most_numbers) + " numbers", reals.range));
    std::vector<double> numbers;
    for (const toml::node& item : *array) numbers.push_back(number(item, name, reals.range));
    reals.value = std::move(numbers);
  });
}

void TomlReader::set(std::string_view name, const parameter::Text& text) {
  read(name, [&](const toml::node&) {
    const std::string given = this->text(name);
    if (given.size() > most_text_bytes)
      fail(name, "expected a text of at most " + std::to_string(most_text_bytes) + " bytes");
    text.value = given;
  });
}

void TomlReader::set(std::string_view name, const parameter::File& file) {
  attempt([&] { file.value = named_file(text(name, file.value.path.c_str()), name); });
}

InputFile TomlReader::named_file(const std::string& path, std::string_view name) const {
  InputFile file{path, ""};
  if (path.empty()) return file;
  if (references_.recorded_files != nullptr) {
    const auto recorded = references_.recorded_files->find(path);
    if (recorded == references_.recorded_files->end()) fail(name, "is not among the files of the run");
    file.content = recorded->second;
  } else {
    try {
      file.content = read_input_file((references_.folder / path).string(), most_file_bytes);
    } catch (const ConfigError& error) {
      fail(name, error.what());
    }
  }
  if (references_.files != nullptr) (*references_.files)[path] = file.content;
  return file;
}

void TomlReader::set(std::string_view name, const parameter::Materials& materials) {
  attempt([&] {
    std::vector<std::string> named = texts(name);
    if (named.empty()) named = materials.value;
    for (const std::string& material : named) {
      if (std::find(references_.materials->begin(), references_.materials->end(), material) ==
          references_.materials->end())
        fail(name, "\"" + material + "\" is not a material" + suggestion(material, *references_.materials),
             {"materials"});
      if (std::count(named.begin(), named.end(), material) > 1)
        fail(name, "names \"" + material + "\" twice; remove one of the two");
    }
    materials.value = std::move(named);
  });
}

void TomlReader::require(bool holds, std::string_view name, std::string_view text) {
  if (holds) return;
  try {
    fail(name, std::string(text));
  } catch (const KeyError& error) {
    if (errors_ == nullptr) throw;
    failed_conditions_.push_back(error);
  }
}

std::string TomlReader::text(std::string_view name, const char* fallback) {
  const toml::node* node = look_up(name);
  if (node == nullptr && fallback == nullptr) fail(name, "is missing; add it with a text in quotes", {full_name(name)});
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

void TomlReader::report_unknown_keys() const {
  for (auto&& [key, node] : table_)
    if (std::find(known_.begin(), known_.end(), key.str()) == known_.end())
      attempt([&, &unknown = key] { refuse_unknown_key(unknown); });
}

/// The error counts as one in the key that is probably meant, or else in the table, so that no key is reported as
/// missing because its name is misspelt.
void TomlReader::refuse_unknown_key(const toml::key& key) const {
  const std::string name(key.str()), place = location_of(key.source()) + ": " + full_name(name) + ": ";
  const toml::source_position position = position_of(key.source());
  if (const auto renamed = renamed_keys.find(full_name(name)); renamed != renamed_keys.end())
    throw KeyError(place + "is now called " + renamed->second + "; rename it", renamed->second, position, {});
  const std::string where = path_.empty() ? "an experiment" : "[" + printable(path_) + "]";
  const std::string near = nearest(name, known_), or_else = path_.empty() ? full_name(name) : path_;
  throw KeyError(place + "is not a key of " + where + suggestion(name, known_),
                 near.empty() ? or_else : full_name(near), position, {});
}

void TomlReader::finish() const {
  report_unknown_keys();
  attempt([&] {
    stop_if_wrong();
    for (const KeyError& error : failed_conditions_) errors_->add(error);
  });
}

}  // namespace evodevo
