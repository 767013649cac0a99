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

/// Calls `read` with a reader of the table [name] of `parent`; does nothing if the table is absent. Reports the error
/// that ends `read`, or that the table is `required` and absent. Does not check for unknown keys.
template <class Read>
void visit_table(TomlReader& parent, std::string_view name, bool required, const Read& read,
                 const References& references = {}) {
  parent.attempt([&] {
    const toml::table* table = parent.table(name);
    const std::string path = parent.full_name(name);
    if (table == nullptr && required) parent.fail(name, "is missing; add a table [" + path + "]", {path});
    if (table == nullptr) return;
    TomlReader reader(*table, path, references, parent.errors());
    read(reader);
  });
}

/// Like visit_table(), and reports keys that `read` has not read, unless an error has ended it.
template <class Read>
void read_table(TomlReader& parent, std::string_view name, bool required, const Read& read,
                const References& references = {}) {
  const auto read_all = [&](TomlReader& reader) {
    read(reader);
    reader.finish();
  };
  visit_table(parent, name, required, read_all, references);
}

/// Calls `read` with a reader of each table of the array [[name]] in `parent`. Reports the error that ends a call of
/// `read`, or that there are more than `most` tables. Does not check for unknown keys.
template <class Read>
void visit_tables(TomlReader& parent, std::string_view name, std::size_t most, const References& references,
                  const Read& read) {
  parent.attempt([&] {
    const auto tables = parent.tables(name);
    if (tables.size() > most) parent.fail(name, "expected at most " + std::to_string(most) + " of these tables");
    for (std::size_t i = 0; i < tables.size(); ++i) {
      TomlReader reader(*tables[i], parent.full_name(name) + "." + std::to_string(i), references, parent.errors());
      reader.attempt([&] { read(reader); });
    }
  });
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

/// Whether the experiment says how many random individuals it wants.
bool asks_for_random_individuals(TomlReader& top);

/// Reports if StepRule::dt is fixed and a duration (s) is not a whole number of such steps.
void check_duration(const TomlReader& table, std::string_view name, double duration, const StepRule& step);

/// Reports if [experiment] lives or [selection] remeasure asks for several lives, and no key lets them differ.
/// `develops` says whether operators develop bodies, which may draw random numbers. To be called after all tables have
/// been read.
void check_lives(TomlReader& top, const Settings& settings, bool develops);

/// Reads all tables of settings in `top`. Does not check for unknown keys in tables that operators also read. If
/// errors are collected, settings that are wrong keep their defaults.
Settings read_settings(TomlReader& top, Bodies bodies, Warnings& warnings);

/// Writes the tables of settings. read_settings() reads them back as equal settings.
toml::table to_toml(Settings settings);

}  // namespace evodevo
