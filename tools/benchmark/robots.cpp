#include "robots.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "body_building.hpp"
#include "settings.hpp"
#include "simulator.hpp"
#include "time_steps.hpp"

namespace evodevo::benchmark {
namespace {

std::optional<Body> random_robot(const Experiment& experiment, std::uint64_t seed) {
  Rng rng = experiment.world.rng(seed);
  const Genome genome = experiment.encoding->random(experiment.layout, rng);
  BuiltBody built = build_body(experiment.encoding->decode(genome, experiment.world));
  if (!built.failure.empty()) return std::nullopt;
  const State birth = state_at_birth(built.body, experiment.scene);
  const LongestStep step =
      longest_step({.dt = time_step}, built.body, birth.position, experiment.scene, Method::paper_euler);
  if (!step.failure.empty()) return std::nullopt;
  return std::move(built.body);
}

bool has_muscle(const Body& body) {
  return std::any_of(body.springs.begin(), body.springs.end(),
                     [&](const Spring& spring) { return body.materials[spring.material].amplitude != 0; });
}

}  // namespace

std::vector<Body> random_robots(const Experiment& experiment, std::size_t count, std::size_t springs) {
  std::vector<Body> robots;
  for (std::uint64_t seed = 1; robots.size() < count; ++seed) {
    if (seed > 100 * count)
      throw std::runtime_error("too few random robots of " + experiment.name + " have a muscle and " +
                               std::to_string(springs) + " springs; name an experiment with larger ones");
    auto robot = random_robot(experiment, seed);
    if (robot && has_muscle(*robot) && robot->springs.size() >= springs) robots.push_back(*std::move(robot));
  }
  return robots;
}

}  // namespace evodevo::benchmark
