// The keys of each table of an experiment, with their ranges, units and one sentence each. Every function here declares
// the keys of one table to a visitor, which may read, write or describe them.
#pragma once

#include "experiment/settings.hpp"
#include "experiment/settings_visitor.hpp"

namespace evodevo {

void declare_run(SettingsVisitor& visitor, Settings& settings);           ///< [experiment]
void declare_mass(SettingsVisitor& visitor, Settings& settings);          ///< the host's key in [encoding]
void declare_accuracy(SettingsVisitor& visitor, Settings& settings);      ///< first key to read of [simulation]
void declare_simulation(SettingsVisitor& visitor, Settings& settings);    ///< other keys of [simulation]
void declare_development(SettingsVisitor& visitor, Settings& settings);   ///< [development] without its operators
void declare_scenario(SettingsVisitor& visitor, Scenario& scenario);      ///< [[scenario]] without its name and forces
void declare_over(SettingsVisitor& visitor, std::string& over);           ///< the host's key of a fitness operator
void declare_over_lives(SettingsVisitor& visitor, Over& over);            ///< likewise
void declare_schedule(SettingsVisitor& visitor, Schedule& schedule);      ///< the host's keys of a devo operator
void declare_remeasure(SettingsVisitor& visitor, Settings& settings);     ///< the host's key in [selection]
void declare_probability(SettingsVisitor& visitor, double& probability);  ///< the host's key of a variation operator

void declare(SettingsVisitor& visitor, Material& material);  ///< [materials.NAME]
void declare(SettingsVisitor& visitor, Gravity& gravity);    ///< [scene.gravity], and so on
void declare(SettingsVisitor& visitor, Floor& floor);
void declare(SettingsVisitor& visitor, Friction& friction);
void declare(SettingsVisitor& visitor, Damping& damping);
void declare(SettingsVisitor& visitor, Drag& drag);
void declare(SettingsVisitor& visitor, Payload& payload);
void declare(SettingsVisitor& visitor, IslandSettings& islands);             ///< [islands]
void declare_island_number(SettingsVisitor& visitor, std::int64_t& number);  ///< first key of [[island]] to read
void declare_island(SettingsVisitor& visitor, std::optional<double>& seed);  ///< [[island]] without its operators

/// Calls `use(name, part)` for each part of the scene of an experiment's settings or of a scenario. `part` is the
/// std::optional that holds it.
template <class AnySettings, class Use>
void for_each_force(AnySettings& settings, const Use& use) {
  use("gravity", settings.scene.gravity);
  use("floor", settings.scene.floor);
  use("friction", settings.scene.friction);
  use("damping", settings.scene.damping);
  use("drag", settings.scene.drag);
  use("payload", settings.payload);
}

}  // namespace evodevo
