#include "environments/scene_study.hpp"

#include "environments/body_distance.hpp"
#include "experiment/device.hpp"
#include "life/birth.hpp"
#include "life/evaluation.hpp"

namespace evodevo {
namespace {

Environment grow(const Experiment& experiment, const Newborn& newborn, std::uint32_t starts) {
  const auto simulator = make_simulator(experiment);
  const Evaluation evaluation(experiment, *simulator);
  const std::vector<Newborn> newborns(starts, newborn);
  std::vector<Life> lives = evaluation.birth.of(newborns);
  std::vector<GrowthObserver> observers(starts, GrowthObserver(lives.front().living.body));
  for (std::uint32_t start = 1; start < starts; ++start)
    if (Life& life = lives[start]; life.alive()) {
      perturb(life, experiment, start - 1);
      evaluation.simulation.choose_step(life);
    }
  Environment environment{
      .name = experiment.name, .materials = experiment.context.material_names, .grown = std::vector<Grown>(starts)};
  if (experiment.scene.gravity) environment.slope = experiment.scene.gravity->slope;
  evaluation.development.run(lives, [&](double) {
    for (std::size_t i = 0; i < lives.size(); ++i)
      if (const Life& life = lives[i]; life.alive())
        environment.grown[i].after.push_back(observers[i].after_cycle(life));
  });
  for (std::size_t i = 0; i < lives.size(); ++i) {
    environment.grown[i].status = lives[i].result.status;
    environment.grown[i].reason = lives[i].result.reason;
    LivingBody& living = lives[i].living;
    environment.grown[i].matured = {std::move(living.body), std::move(living.state)};
  }
  return environment;
}

/// Returns the bodies of the lives that had not failed by the end of a cycle. Cycles are counted from 0.
std::vector<const GrownBody*> bodies_after(std::size_t cycle, const Environment& environment) {
  std::vector<const GrownBody*> bodies;
  for (const Grown& grown : environment.grown)
    if (cycle < grown.after.size()) bodies.push_back(&grown.after[cycle]);
  return bodies;
}

std::optional<SceneEffect> compare(const Environment& a, const Environment& b, std::size_t cycle,
                                   const BodyDistance& measure) {
  std::vector<const GrownBody*> bodies = bodies_after(cycle, a);
  const std::vector<const GrownBody*> others = bodies_after(cycle, b);
  const std::size_t first = bodies.size();
  if (first == 0 || others.empty()) return std::nullopt;
  bodies.insert(bodies.end(), others.begin(), others.end());
  std::vector<std::vector<double>> distances(bodies.size(), std::vector<double>(bodies.size()));
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t j = i + 1; j < bodies.size(); ++j) distances[i][j] = measure.distance(*bodies[i], *bodies[j]);
  return scene_effect(distances, first);
}

}  // namespace

const std::vector<BodyDistance> body_distances = {
    {"springs", "share of springs that only one of two bodies has", spring_distance},
    {"mass", "distance between the mass distributions of two bodies, in body lengths at birth", mass_distance}};

SceneStudy study_scenes(const std::vector<Experiment>& experiments, const Newborn& newborn, std::uint32_t starts,
                        std::size_t cycles) {
  SceneStudy study{newborn.id, {}, {}};
  auto& environments = study.environments;
  for (const Experiment& experiment : experiments) environments.push_back(grow(experiment, newborn, starts));
  for (std::size_t a = 0; a < environments.size(); ++a)
    for (std::size_t b = a + 1; b < environments.size(); ++b) {
      ScenePair& pair = study.pairs.emplace_back(ScenePair{a, b, {}});
      for (const BodyDistance& measure : body_distances) {
        auto& effects = pair.effects.emplace_back();
        for (std::size_t cycle = 0; cycle < cycles; ++cycle)
          effects.push_back(compare(environments[a], environments[b], cycle, measure));
      }
    }
  for (Environment& environment : environments)
    for (Grown& grown : environment.grown) grown.after.clear();  // all of them would take too much memory
  return study;
}

}  // namespace evodevo
