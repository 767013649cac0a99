#include "overrides.hpp"

#include <charconv>
#include <vector>

#include "toml_reader.hpp"

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

/// Whether a key is not there yet, but may be: any key of a table, the number behind the last item of a list.
bool is_next(const toml::node& parent, const std::string& key) {
  if (const toml::table* table = parent.as_table()) return !table->contains(key);
  const toml::array* array = parent.as_array();
  return array != nullptr && key == std::to_string(array->size());
}

/// The value of "key=value", as TOML where it is TOML and as a text where it is not. It remembers the option it came
/// from as its place.
toml::table parse_override_value(const std::string& value, const std::string& origin) {
  try {
    toml::table parsed = toml::parse("value = " + value, origin);
    if (parsed.size() == 1) return parsed;  // more than one: it goes on in a second line
  } catch (const toml::parse_error&) {
  }
  return parse_toml("value = '''" + value + "'''", origin);
}

std::vector<std::string> split_key(const std::string& key) {
  std::vector<std::string> parts(1);
  for (const char c : key) {
    if (c == '.')
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

/// Sets a key of a table, or an item of a list; the item behind the last one is added.
template <class Value>
void set(toml::node& parent, const std::string& key, Value&& value, const Override& change) {
  if (toml::table* table = parent.as_table()) {
    table->insert_or_assign(key, std::forward<Value>(value));
  } else if (toml::array* array = parent.as_array(); array != nullptr && key == std::to_string(array->size())) {
    array->push_back(std::forward<Value>(value));
  } else if (child(parent, key) != nullptr) {
    array->replace(array->cbegin() + std::stol(key), std::forward<Value>(value));
  } else {
    throw ConfigError(change.origin + ": " + change.key + ": there is no item " + key);
  }
}

}  // namespace

void apply_override(const Override& change, toml::table& root) {
  const std::vector<std::string> keys = split_key(change.key);
  toml::node* parent = &root;
  for (std::size_t i = 0; i + 1 < keys.size(); ++i) {
    if (is_next(*parent, keys[i]))
      set(*parent, keys[i], std::move(*parse_override_value("{}", change.origin).get_as<toml::table>("value")), change);
    parent = child(*parent, keys[i]);
    if (parent == nullptr) throw ConfigError(change.origin + ": " + change.key + ": there is no item " + keys[i]);
  }
  toml::table parsed = parse_override_value(change.value, change.origin);
  parsed.get("value")->visit([&](auto& value) { set(*parent, keys.back(), std::move(value), change); });
}

}  // namespace evodevo
