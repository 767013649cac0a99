// The keys of each table of an experiment, with their ranges, units and one sentence each. Every function here declares
// the keys of one table, so that they can be read, written or described.
#pragma once

#include "evodevo/parameters.hpp"
#include "experiment/settings.hpp"

namespace evodevo {

void declare_run(Parameters& parameters, Settings& settings);           ///< [experiment]
void declare_mass(Parameters& parameters, Settings& settings);          ///< the host's key in [encoding]
void declare_accuracy(Parameters& parameters, Settings& settings);      ///< first key to read of [simulation]
void declare_simulation(Parameters& parameters, Settings& settings);    ///< other keys of [simulation]
void declare_development(Parameters& parameters, Settings& settings);   ///< [development] without its operators
void declare_scenario(Parameters& parameters, Scenario& scenario);      ///< [[scenario]] without its name and forces
void declare_over(Parameters& parameters, std::string& over);           ///< the host's key of a fitness operator
void declare_over_lives(Parameters& parameters, Over& over);            ///< likewise
void declare_schedule(Parameters& parameters, Schedule& schedule);      ///< the host's keys of a devo operator
void declare_remeasure(Parameters& parameters, Settings& settings);     ///< the host's key in [selection]
void declare_probability(Parameters& parameters, double& probability);  ///< the host's key of a variation operator

void declare(Parameters& parameters, Material& material);  ///< [materials.NAME]
void declare(Parameters& parameters, Gravity& gravity);    ///< [scene.gravity], and so on
void declare(Parameters& parameters, Floor& floor);
void declare(Parameters& parameters, Friction& friction);
void declare(Parameters& parameters, Damping& damping);
void declare(Parameters& parameters, Drag& drag);
void declare(Parameters& parameters, Payload& payload);
void declare(Parameters& parameters, IslandSettings& islands);             ///< [islands]
void declare_island_number(Parameters& parameters, std::int64_t& number);  ///< first key of [[island]] to read
void declare_island(Parameters& parameters, std::optional<double>& seed);  ///< [[island]] without its operators

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
