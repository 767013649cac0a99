// What each table of an experiment holds: its keys, their ranges, units and one sentence each. Readers and writers of
// settings are handed to these.
#pragma once

#include "experiment/settings.hpp"
#include "experiment/settings_visitor.hpp"

namespace evodevo {

void declare_run(SettingsVisitor& visitor, Settings& settings);           ///< [experiment]
void declare_mass(SettingsVisitor& visitor, Settings& settings);          ///< the host's part of [encoding]
void declare_accuracy(SettingsVisitor& visitor, Settings& settings);      ///< the part of [simulation] to read first
void declare_simulation(SettingsVisitor& visitor, Settings& settings);    ///< the rest of it
void declare_development(SettingsVisitor& visitor, Settings& settings);   ///< [development] but for its operators
void declare_schedule(SettingsVisitor& visitor, Schedule& schedule);      ///< the host's part of a devo operator
void declare_probability(SettingsVisitor& visitor, double& probability);  ///< the host's part of a variation

void declare(SettingsVisitor& visitor, Material& material);  ///< [materials.NAME]
void declare(SettingsVisitor& visitor, Gravity& gravity);    ///< [scene.gravity], and so on
void declare(SettingsVisitor& visitor, Floor& floor);
void declare(SettingsVisitor& visitor, Friction& friction);
void declare(SettingsVisitor& visitor, Damping& damping);
void declare(SettingsVisitor& visitor, Drag& drag);
void declare(SettingsVisitor& visitor, Payload& payload);

/// Calls `use(name, force)` for each part of a scene, with the std::optional that holds it.
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
