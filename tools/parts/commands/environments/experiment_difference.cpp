#include "environments/experiment_difference.hpp"

#include <map>

#include "experiment/toml_reader.hpp"

namespace evodevo {
namespace {

/// The values of a resolved experiment, as messages show them, by their full keys.
using Values = std::map<std::string, std::string>;

void collect(const toml::node& node, const std::string& key, Values& values) {
  if (const toml::table* table = node.as_table())
    for (const auto& [name, item] : *table) collect(item, key + "." + std::string(name.str()), values);
  else if (const toml::array* array = node.as_array(); array != nullptr && array->is_array_of_tables())
    for (std::size_t i = 0; i < array->size(); ++i) collect((*array)[i], key + "." + std::to_string(i), values);
  else
    values[key] = value_text(node);
}

Values values(const Experiment& experiment, std::initializer_list<const char*> tables) {
  const toml::table resolved = parse_toml(experiment.resolved, experiment.name);
  Values values;
  for (const char* table : tables)
    if (const toml::node* node = resolved.get(table)) collect(*node, table, values);
  return values;
}

}  // namespace

std::string difference(const Experiment& experiment, const Experiment& first,
                       std::initializer_list<const char*> tables) {
  const Values here = values(experiment, tables), there = values(first, tables);
  const auto value = [](const Values& values, const std::string& key) {
    const auto found = values.find(key);
    return found == values.end() ? "absent" : found->second;
  };
  Values all = here;
  all.insert(there.begin(), there.end());
  for (const auto& [key, _] : all)
    if (value(here, key) != value(there, key))
      return key + " is " + value(here, key) + ", but " + value(there, key) + " in the first experiment";
  return {};
}

}  // namespace evodevo
