#include "experiment/overrides.hpp"

#include <algorithm>
#include <charconv>
#include <vector>

#include "experiment/toml_limits.hpp"
#include "experiment/toml_reader.hpp"

namespace evodevo {
namespace {

toml::node* child(toml::node& parent, const std::string& key) {
  if (toml::table* table = parent.as_table()) return table->get(key);
  toml::array* array = parent.as_array();
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), index);
  const bool is_index = error == std::errc() && end == key.data() + key.size();
  return array != nullptr && is_index ? array->get(index) : nullptr;
}

/// Whether a key is absent but can be added: any absent key of a table, or the index after the last item of a list.
bool is_next(const toml::node& parent, const std::string& key) {
  if (const toml::table* table = parent.as_table()) return !table->contains(key);
  const toml::array* array = parent.as_array();
  return array != nullptr && key == std::to_string(array->size());
}

/// Whether a value consists of digits, with or without a sign. Such a value is never meant as a string.
bool is_whole_number(std::string_view value) {
  if (value.starts_with('+') || value.starts_with('-')) value.remove_prefix(1);
  return !value.empty() && std::all_of(value.begin(), value.end(), [](char c) { return c >= '0' && c <= '9'; });
}

[[noreturn]] void refuse(const Override& change, const std::string& message) {
  throw ConfigError(change.origin + ": " + printable(change.key) + ": " + message);
}

/// Parses the value of "key=value" as TOML if it is valid TOML, and otherwise takes it as a string. The option that the
/// value came from is recorded as its source location.
toml::table parse_override_value(const Override& change) {
  const std::string line = "value = " + change.value;
  expect_within_toml_limits(line, change.origin);
  try {
    toml::table parsed = parse_toml(line, change.origin);
    if (parsed.size() == 1) return parsed;  // otherwise the value has further lines that set more keys
  } catch (const ConfigError&) {
    if (is_whole_number(change.value))
      refuse(change, printable(change.value) + " does not fit into 64 bits; give a whole number with fewer digits");
  }
  toml::table parsed = parse_toml("value = ''", change.origin);
  *parsed.get_as<std::string>("value") = change.value;
  return parsed;
}

std::vector<std::string> split_key(const Override& change) {
  std::vector<std::string> parts(1);
  for (const char c : change.key) {
    if (c == '.')
      parts.emplace_back();
    else
      parts.back() += c;
  }
  if (parts.size() > most_toml_levels)
    refuse(change, "expected at most " + std::to_string(most_toml_levels) + " names joined by dots");
  if (std::find(parts.begin(), parts.end(), "") != parts.end())
    refuse(change, "a name is empty; expected names joined by dots, such as experiment.population");
  return parts;
}

/// Sets a key of a table or an item of a list. An index equal to the length of the list appends an item.
template <class Value>
void set(toml::node& parent, const std::string& key, Value&& value, const Override& change) {
  if (toml::table* table = parent.as_table()) {
    toml::source_region option;
    option.path = std::make_shared<const std::string>(change.origin);
    table->insert_or_assign(toml::key(key, std::move(option)), std::forward<Value>(value));
  } else if (toml::array* array = parent.as_array(); array != nullptr && key == std::to_string(array->size())) {
    array->push_back(std::forward<Value>(value));
  } else if (child(parent, key) != nullptr) {
    array->replace(array->cbegin() + std::stol(key), std::forward<Value>(value));
  } else {
    refuse(change,
           "there is no item " + printable(key) + "; items are numbered from 0, and only the next one can be added");
  }
}

/// Returns an empty table to contain the key that a change sets. For a table in a table, messages about missing keys
/// name the file, as if the file had this empty table; for an item of a list, they name the option.
toml::table table_on_the_way(const toml::node& parent, const Override& change) {
  const toml::source_path_ptr& file = parent.source().path;
  return parse_toml("", parent.is_table() && file ? *file : change.origin);
}

}  // namespace

void apply_override(const Override& change, toml::table& root) {
  const std::vector<std::string> keys = split_key(change);
  toml::node* parent = &root;
  for (std::size_t i = 0; i + 1 < keys.size(); ++i) {
    if (is_next(*parent, keys[i])) set(*parent, keys[i], table_on_the_way(*parent, change), change);
    parent = child(*parent, keys[i]);
    if (parent == nullptr)
      refuse(change, "there is no item " + printable(keys[i]) +
                         "; items are numbered from 0, and only the next one can be added");
  }
  toml::table parsed = parse_override_value(change);
  parsed.get("value")->visit([&](auto& value) { set(*parent, keys.back(), std::move(value), change); });
}

}  // namespace evodevo
