#include <algorithm>
#include <type_traits>

#include "base/text.hpp"
#include "experiment/tables/declarations.hpp"
#include "experiment/tables/tables.hpp"

namespace evodevo {
namespace {

/// A floor is elastic or rigid. In a scenario, either key replaces what the scene has.
void choose_contact(const TomlReader& table, Floor& floor) {
  const std::vector<std::string> keys = table.keys();
  const auto has = [&](std::string_view name) { return std::ranges::find(keys, name) != keys.end(); };
  if (!has("stiffness")) return;
  if (has("restitution"))
    table.fail("restitution",
               "makes the floor rigid, without a stiffness; remove this key or " + table.full_name("stiffness"));
  floor.restitution.reset();
}

/// Reads the forces of a scene. Keys that are left out keep their values.
template <class AnySettings>
void read_forces(TomlReader& table, AnySettings& settings) {
  for_each_force(settings, [&](std::string_view name, auto& force) {
    read_table(table, name, false, [&](TomlReader& t) {
      if (!force) force.emplace();
      if constexpr (std::is_same_v<std::remove_cvref_t<decltype(*force)>, Floor>) choose_contact(t, *force);
      declare(t, *force);
    });
  });
  if (settings.scene.friction && !settings.scene.floor)
    table.report("friction",
                 "there is no floor for friction to act on; add [" + table.full_name("floor") + "] or remove [" +
                     table.full_name("friction") + "]",
                 {table.full_name("floor"), "scene.floor", "scene.friction"});
}

Scenario read_scenario(TomlReader& table, const Settings& settings) {
  table.expect({"name", "start_noise", "muscles", "damage", "repeat", "develops", "gravity", "floor", "friction",
                "damping", "drag", "payload"});
  Scenario scenario{.name = table.text("name"), .scene = settings.scene, .payload = settings.payload};
  if (const std::string fault = text_fault(scenario.name); scenario.name.empty() || !fault.empty())
    table.fail("name", scenario.name.empty() ? "is empty; give the scenario a name" : fault);
  constexpr auto& taken = names_of<Over>;
  if (std::find(taken.begin(), taken.end(), scenario.name) != taken.end())
    table.fail("name", "over = \"" + scenario.name +
                           "\" of a fitness operator means all scenarios; give this scenario another name");
  declare_scenario(table, scenario);
  if (scenario.repeat > 1 && !scenario.is_random())
    table.report("repeat",
                 "all repeats would measure the same, since they differ by start_noise and damage alone; set one of "
                 "these, or remove repeat");
  read_forces(table, scenario);
  return scenario;
}

}  // namespace

void read_scene(TomlReader& top, Settings& settings) {
  read_table(top, "scene", false, [&](TomlReader& scene) {
    scene.expect({"gravity", "floor", "friction", "damping", "drag", "payload"});
    read_forces(scene, settings);
  });
}

void read_scenarios(TomlReader& top, Settings& settings) {
  constexpr std::size_t most = 1000;
  visit_tables(top, "scenario", most, {}, [&](TomlReader& table) {
    Scenario scenario = read_scenario(table, settings);
    table.finish();
    const auto is_same = [&](const Scenario& other) { return other.name == scenario.name; };
    if (std::any_of(settings.scenarios.begin(), settings.scenarios.end(), is_same))
      table.fail("name", "there is already a scenario \"" + scenario.name + "\"; give each its own name");
    settings.scenarios.push_back(std::move(scenario));
  });
}

}  // namespace evodevo
