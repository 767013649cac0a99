// The start of a scenario: what is changed about a matured robot before it is measured.
#pragma once

#include "experiment/experiment.hpp"
#include "life/life_simulation.hpp"

namespace evodevo {

/// One simulation of a scenario.
struct Test {
  std::size_t scenario = 0;  ///< index into Settings::scenarios
  std::int64_t repeat = 0;   ///< from 0
};

/// Returns all tests of an experiment: every repeat of every scenario.
std::vector<Test> tests_of(const Experiment& experiment);

/// Returns the indices of the scenarios in which robots are born and mature.
std::vector<std::size_t> scenarios_that_develop(const Experiment& experiment);

/// Puts a matured life into a scenario, in this order: the scene, its load, muscles, damage, noise, the ground below
/// the body, the time step. A life that has matured in the scenario keeps its scene and load. The random numbers of
/// damage and noise depend on the seed, the scenario, the repeat and the number of the life, so that they are the same
/// for all individuals; if draws are inherited, on the identities of masses, too. The life ends as invalid if no
/// springs are left or its body cannot be simulated in the scenario. The experiment must outlive the life.
void start_scenario(const Test& test, const Experiment& experiment, const LifeSimulation& simulation, Life& life);

}  // namespace evodevo
