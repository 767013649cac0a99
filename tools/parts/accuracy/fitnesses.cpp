#include "fitnesses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/ground.hpp"
#include "perturbation.hpp"

namespace evodevo::tools::accuracy {

Experiment measurable_experiment(const std::string& file, std::vector<Override> set_by_study) {
  for (Override& one : set_by_study) one.origin = file + " with " + one.key + " = " + one.value;
  Experiment experiment = read_experiment({file, set_by_study});
  const Fitness& fitness = *experiment.fitness.front().op;
  const Request request = fitness.observes();
  const Objective objective = fitness.objectives().front();
  if (request.rate > 0 || request.work || request.cycle || objective.role != Role::objective || !objective.maximise)
    throw ConfigError(file + ": fitness.0: \"" + objective.name +
                      "\" cannot be measured here; put a fitness first of which more is better, and which compares "
                      "where a robot is before and after the window, such as \"distance\"");
  return experiment;
}

Fitnesses measure(const Experiment& experiment, std::span<const Body> bodies, const Setting& setting,
                  const Device& device, double perturbation) {
  const Fitness& fitness = *experiment.fitness.front().op;
  const Request request = fitness.observes();
  std::vector<Traveller> robots;
  for (const Body& body : bodies)
    robots.push_back({&body, perturbed(state_at_birth(body, experiment.scene), perturbation)});
  Simulation simulation(experiment.scene, setting, device);
  std::vector<Traveller> first = robots;
  simulation.advance(first, setting.dt);  // a GPU compiles its kernel in it, which is no cost of the setting
  double seconds = request.settle > 0 ? simulation.advance(robots, request.settle) : 0;
  std::vector<Observation> observations;
  for (const Traveller& robot : robots)
    observations.push_back({.box = bounding_box(robot.state.position),
                            .centre_before = centre_of_mass(*robot.body, robot.state.position),
                            .window = request.window,
                            .body = robot.body});
  seconds += simulation.advance(robots, request.window);

  Fitnesses result{{}, seconds / (request.settle + request.window) / static_cast<double>(robots.size()), 0};
  for (std::size_t i = 0; i < robots.size(); ++i) {
    observations[i].centre_after = centre_of_mass(*robots[i].body, robots[i].state.position);
    const bool alive = robots[i].alive();
    result.values.push_back(alive ? fitness.score(observations[i]).front() : std::numeric_limits<double>::quiet_NaN());
    result.diverged += (alive ? 0 : 1) / static_cast<double>(robots.size());
  }
  return result;
}

}  // namespace evodevo::tools::accuracy
