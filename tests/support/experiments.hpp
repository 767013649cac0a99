// Small experiments for tests.
#pragma once

#include <string>
#include <vector>

#include "cpu/simulator.hpp"
#include "experiment/experiment.hpp"

namespace evodevo::testing {

/// A complete experiment of small voxel robots, with development and two objectives. An evaluation takes milliseconds.
inline const std::string small_experiment = R"(
[experiment]
seed = 7
evaluations = 24
population = 6
random_individuals = 1

[encoding]
name = "voxel"
size = [2, 1, 1]
edge = 0.5

[[mutation]]
name = "reset-weight"
probability = 0.8

[[crossover]]
name = "two-point"
probability = 0.5

[scene.gravity]
[scene.floor]
[scene.friction]
[scene.damping]

[simulation]
threads = 2

[development]
cycles = 2
cycle_time = 0.05

[[development.operator]]
name = "spring-turnover"
springs = 2

[[fitness]]
name = "distance"
settle = 0.05
window = 0.1

[[fitness]]
name = "actuation-work"
settle = 0.05
window = 0.1

[selection]
name = "age-fitness-pareto"
)";

inline Experiment read(const std::string& text, std::vector<Override> overrides = {}) {
  return read_experiment(text, {"test.toml", std::move(overrides)});
}

/// Returns values of keys, as --set takes them: "key=value".
inline std::vector<Override> overrides(const std::vector<std::string>& values) {
  std::vector<Override> all;
  for (const std::string& value : values)
    all.push_back({value.substr(0, value.find('=')), value.substr(value.find('=') + 1), ""});
  return all;
}

/// The small experiment with values of keys, as --set takes them.
inline Experiment small(const std::vector<std::string>& values = {}) {
  return read(small_experiment, overrides(values));
}

/// Returns the values, as --set takes them, that make two small and short generations of an experiment.
inline std::vector<std::string> shrinking(const std::string& file) {
  std::vector<std::string> values = {"experiment.population=8", "experiment.children=8", "experiment.evaluations=16",
                                     "fitness.0.settle=0.1", "fitness.0.window=0.1"};
  const Experiment experiment = read_experiment({file, {}});
  if (experiment.islands) values[2] = "experiment.evaluations=" + std::to_string(16 * experiment.islands->count);
  if (experiment.resolved.find("\npoints = ") != std::string::npos) values.push_back("encoding.points=60");
  if (experiment.random_individuals > 8) values.push_back("experiment.random_individuals=8");
  if (experiment.development.cycles > 0)
    values.insert(values.end(), {"development.cycles=2", "development.cycle_time=0.1"});
  return values;
}

}  // namespace evodevo::testing
