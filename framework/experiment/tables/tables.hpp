// Functions that read the tables of an experiment's settings, one function for each table. Unless said otherwise, they
// take the reader of the whole file.
#pragma once

#include <string>
#include <vector>

#include "experiment/settings.hpp"
#include "experiment/toml_reader.hpp"

namespace evodevo {

/// Warnings for the user, about settings that are allowed but may be unintended and libraries that cannot be used.
using Warnings = std::vector<std::string>;

/// Calls `read` with a reader of the table [name] of `parent`; does nothing if the table is absent. Throws ConfigError
/// if the table is `required` and absent, or if it has a key that `read` has not read.
template <class Read>
void read_table(TomlReader& parent, std::string_view name, bool required, const Read& read,
                const References& references = {}) {
  const toml::table* table = parent.table(name);
  if (table == nullptr && required) parent.fail(name, "is missing; add a table [" + parent.full_name(name) + "]");
  if (table == nullptr) return;
  TomlReader reader(*table, parent.full_name(name), references);
  read(reader);
  reader.finish();
}

void read_materials(TomlReader& top, Settings& settings, Warnings& warnings);
void read_scene(TomlReader& top, Settings& settings);
/// Reads [[scenario]]. To be called after read_scene().
void read_scenarios(TomlReader& top, Settings& settings);

/// Where the bodies of an experiment come from. The experiment's own encoding makes `grown` bodies; dt is then checked
/// for the experiment's masses and materials. A `given` body comes from a file; dt is checked for that body later.
enum class Bodies { grown, given };
/// Reads [simulation]. To be called after the mass, the materials and the scene have been read.
void read_simulation(TomlReader& top, Settings& settings, Bodies bodies);

/// Reads [development] without its operators. Takes the reader of that table. To be called after read_simulation().
void read_development(TomlReader& development, Settings& settings);

/// Throws ConfigError if StepRule::dt is fixed and a duration (s) is not a whole number of such steps.
void check_duration(const TomlReader& table, std::string_view name, double duration, const StepRule& step);

/// Reads all tables of settings in `top`. Does not check for unknown keys in tables that operators also read.
Settings read_settings(TomlReader& top, Bodies bodies, Warnings& warnings);

/// Writes the tables of settings. read_settings() reads them back as equal settings.
toml::table to_toml(Settings settings);

}  // namespace evodevo
