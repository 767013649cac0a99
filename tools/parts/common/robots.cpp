#include "common/robots.hpp"

#include <algorithm>
#include <stdexcept>

#include "analysis/ground.hpp"
#include "common/bodies.hpp"
#include "core/simulator.hpp"
#include "evolution/breeding.hpp"
#include "experiment/time_steps.hpp"
#include "life/evaluation.hpp"

namespace evodevo::tools {
namespace {

bool has_muscle(const Body& body) {
  return std::any_of(body.springs.begin(), body.springs.end(),
                     [&](const Spring& spring) { return body.materials[spring.material].amplitude != 0; });
}

}  // namespace

std::optional<Body> robot_of(const Experiment& experiment, const Genome& genome) {
  BuiltBody built = build_body(experiment, decoded(experiment, genome));
  if (!built.failure.empty()) return std::nullopt;
  if (const auto& payload = experiment.payload) add_payload(built.body, payload->share, payload->top);
  const State birth = state_at_birth(built.body, experiment.scene);
  const LongestStep step = longest_step({.dt = time_step}, built.body, experiment.scene, Method::paper_euler);
  if (!step.failure.empty()) return std::nullopt;
  return std::move(built.body);
}

std::vector<Genome> random_genomes(const Experiment& experiment, std::size_t count, std::size_t springs) {
  std::vector<Genome> genomes;
  for (std::uint64_t seed = 1; genomes.size() < count; ++seed) {
    if (seed > 100 * count)
      throw std::runtime_error("too few random robots of " + experiment.name + " have a muscle and " +
                               std::to_string(springs) + " springs; give an experiment with larger robots");
    Genome genome = first_genome(experiment, [&](std::uint32_t section) {
      return experiment.context.rng(seed + (std::uint64_t{section} << 32));
    });
    const auto robot = robot_of(experiment, genome);
    if (robot && has_muscle(*robot) && robot->springs.size() >= springs) genomes.push_back(std::move(genome));
  }
  return genomes;
}

std::vector<Body> random_robots(const Experiment& experiment, std::size_t count, std::size_t springs) {
  std::vector<Body> robots;
  for (const Genome& genome : random_genomes(experiment, count, springs))
    robots.push_back(*robot_of(experiment, genome));
  return robots;
}

}  // namespace evodevo::tools
