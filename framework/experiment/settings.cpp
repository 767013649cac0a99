#include "experiment/settings.hpp"

#include <ostream>

#include "experiment/islands/island_tables.hpp"
#include "experiment/tables/declarations.hpp"
#include "experiment/tables/tables.hpp"
#include "experiment/toml_writer.hpp"

namespace evodevo {
namespace {

/// Returns the table of the keys that `declare` declares.
template <class Declare>
toml::table written(const Declare& declare) {
  TomlWriter writer;
  declare(writer);
  return writer.take();
}

toml::table written_forces(auto& settings) {
  toml::table forces;
  for_each_force(settings, [&](std::string_view name, auto& force) {
    if (force) forces.insert(name, written([&](TomlWriter& writer) { declare(writer, *force); }));
  });
  return forces;
}

toml::table written_scenario(Scenario& scenario) {
  toml::table table = written([&](TomlWriter& writer) {
    writer.add("name", scenario.name);
    declare_scenario(writer, scenario);
  });
  for (auto&& [name, force] : written_forces(scenario)) table.insert(name, std::move(force));
  return table;
}

}  // namespace

std::map<std::string, Material> base_materials() {
  constexpr double pi = 3.14159265358979323846;
  return {{"muscle", {5000, 0.14, 1, 0}},
          {"tissue", {4000, 0, 0, 0}},
          {"muscle2", {5000, 0.14, 1, pi}},
          {"bone", {10000, 0, 0, 0}},
          {"air", {0, 0, 0, 0}}};
}

toml::table to_toml(Settings settings) {
  toml::table scene = written_forces(settings), materials;
  for (auto& [name, material] : settings.materials)
    materials.insert(name, written([&, &one = material](TomlWriter& writer) { declare(writer, one); }));
  toml::table root;
  root.insert("experiment", written([&](TomlWriter& writer) { declare_run(writer, settings); }));
  root.insert("encoding", written([&](TomlWriter& writer) { declare_mass(writer, settings); }));
  root.insert("materials", std::move(materials));
  root.insert("scene", std::move(scene));
  root.insert("simulation", written([&](TomlWriter& writer) {
                declare_accuracy(writer, settings);
                declare_simulation(writer, settings);
              }));
  toml::array scenarios;
  for (Scenario& scenario : settings.scenarios) scenarios.push_back(written_scenario(scenario));
  if (!scenarios.empty()) root.insert("scenario", std::move(scenarios));
  if (settings.islands)
    root.insert("islands", written([&](TomlWriter& writer) { declare(writer, *settings.islands); }));
  root.insert("selection", written([&](TomlWriter& writer) { declare_remeasure(writer, settings); }));
  root.insert("development", written([&](TomlWriter& writer) { declare_development(writer, settings); }));
  return root;
}

std::ostream& operator<<(std::ostream& stream, const Settings& settings) { return stream << to_toml(settings); }

Settings read_settings(TomlReader& top, Bodies bodies, Warnings& warnings) {
  Settings settings;
  read_table(top, "experiment", true, [&](TomlReader& t) { declare_run(t, settings); });
  // a single newborn is a child, unless the experiment asks for a random individual
  if (settings.newborns() == 1 && !asks_for_random_individuals(top)) settings.random_individuals = 0;
  settings.development.seed = settings.seed;
  read_island_settings(top, settings);
  read_materials(top, settings, warnings);
  visit_table(top, "encoding", false, [&](TomlReader& t) { declare_mass(t, settings); });
  visit_table(top, "selection", false, [&](TomlReader& t) { declare_remeasure(t, settings); });
  read_scene(top, settings);
  read_scenarios(top, settings);
  read_simulation(top, settings, bodies);
  visit_table(top, "development", false, [&](TomlReader& t) { read_development(t, settings); });
  return settings;
}

Settings read_settings(std::string_view text, const std::string& origin) {
  const toml::table root = parse_toml(text, origin);
  TomlReader top(root, "");
  Warnings warnings;
  return read_settings(top, Bodies::given, warnings);
}

}  // namespace evodevo
