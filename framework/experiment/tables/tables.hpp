// Readers of the tables that hold an experiment's settings, one for each. They take the reader of the whole file.
#pragma once

#include <string>
#include <vector>

#include "experiment/settings.hpp"
#include "experiment/toml_reader.hpp"

namespace evodevo {

/// What does not keep an experiment from running, but may not be meant.
using Warnings = std::vector<std::string>;

/// Lets `read` take what it knows from the table [name] of `parent`, then refuses the rest. Refuses a file without a
/// table that is `required`.
template <class Read>
void read_table(TomlReader& parent, std::string_view name, bool required, const Read& read,
                const std::vector<std::string>* materials = nullptr) {
  const toml::table* table = parent.table(name);
  if (table == nullptr && required) parent.fail(name, "is missing; add a table [" + std::string(name) + "]");
  if (table == nullptr) return;
  TomlReader reader(*table, parent.full_name(name), materials);
  read(reader);
  reader.finish();
}

void read_materials(TomlReader& top, Settings& settings, Warnings& warnings);
void read_scene(TomlReader& top, Settings& settings);

/// Whether the bodies of an experiment are grown by its own encoding, in which case dt must suit the experiment's
/// masses and materials. A body that is given from elsewhere is judged by itself.
enum class Bodies { grown, given };
/// To be read after masses and materials.
void read_simulation(TomlReader& top, Settings& settings, Bodies bodies);

/// [development] but for its operators. Takes the reader of that table; to be read after [simulation].
void read_development(TomlReader& development, Settings& settings);

/// Refuses a duration that is not a whole number of steps of a fixed dt.
void check_duration(const TomlReader& table, std::string_view name, double duration, const StepRule& step);

/// All tables of `top` that hold settings. Keys that may be those of operators are left to others.
Settings read_settings(TomlReader& top, Bodies bodies, Warnings& warnings);

/// The tables of settings, which read back as the same.
toml::table to_toml(Settings settings);

}  // namespace evodevo
