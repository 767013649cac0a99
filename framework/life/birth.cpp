// From genomes and files to bodies that live: the one way in which a life begins.
#include <algorithm>
#include <cstdio>

#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "base/materials.hpp"
#include "life/evaluation.hpp"

namespace evodevo {
namespace {

/// Why a body in the middle of its life is not let go: what the floor holds in it is more than the body can have
/// brought there, all the energy that it has and a fall by its own size. Empty where it may go on.
std::string throw_by_ground(const LivingBody& living, const Scene& scene) {
  if (!scene.floor) return {};
  const std::vector<Vec3>& places = living.state.position;
  const double size = bounding_box(places).longest_side(), rounding = 1e-6 * size;
  double weight = 0, held = 0, deepest = 0;  // N, J, m
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (scene.gravity) weight += living.body.masses[i].mass * scene.gravity->downwards();
    const double depth = ground_height(scene, places[i]) - places[i].z;
    if (!(depth > rounding)) continue;
    deepest = std::max(deepest, depth);
    held += scene.floor->stiffness * depth * depth / 2;
  }
  const double brought = std::max(0.0, total_energy(living.body, living.state, scene)) + weight * size;
  if (held <= brought) return {};
  char text[160];
  std::snprintf(
      text, sizeof text,
      "inside the ground, up to %.3g m deep: the floor would throw it out with %.3g J, and it can have brought "
      "%.3g J there",
      deepest, held, brought);
  return text;
}

}  // namespace

Blueprint decoded(const Experiment& experiment, const Genome& genome, CallPlace place) {
  return call_operator(experiment, Encoding::kind, 0, place, [&] {
    Blueprint blueprint = experiment.encoding->decode(genome, experiment.world);
    if (blueprint.failure.empty()) check_blueprint(blueprint, experiment.world);
    return blueprint;
  });
}

std::vector<BuiltBody> Evaluation::build(std::span<const Newborn> newborns) const {
  std::vector<Blueprint> blueprints(newborns.size());
  simulator_.workers().for_each(newborns.size(), [&](std::size_t i) {
    blueprints[i] = decoded(experiment_, *newborns[i].genome, {.individual = newborns[i].id});
  });
  return build_bodies(std::move(blueprints), simulator_.neighbours(), simulator_.workers());
}

std::vector<Life> Evaluation::birth(std::span<const Newborn> newborns) const {
  const BusyClock::Span span(decode_);
  std::vector<BuiltBody> built = build(newborns);
  std::vector<Life> lives(newborns.size());
  simulator_.workers().for_each(lives.size(), [&](std::size_t i) {
    Body& body = built[i].body;
    if (built[i].failure.empty()) {
      body.base_materials = static_cast<std::uint32_t>(experiment_.world.materials.size());
      drop_unused_materials(body);
      lives[i] = birth(std::move(body));
    } else {
      lives[i].end(Status::invalid, std::move(built[i].failure));
    }
    lives[i].newborn = newborns[i];
  });
  return lives;
}

Life Evaluation::birth(Body body) const {
  if (const auto& load = experiment_.load) put_load(body, load->share, load->top);
  Life life;
  life.living.state = state_at_birth(body, experiment_.scene);
  life.living.body = std::move(body);
  choose_step(life);
  return life;
}

Life Evaluation::amid_life(Body body, State state) const {
  // another scene than before may have brought energy
  state.start_energy = std::max(state.start_energy, total_energy(body, state, experiment_.scene));
  Life life;
  life.living.body = std::move(body);
  life.living.state = std::move(state);
  if (std::string reason = throw_by_ground(life.living, experiment_.scene); !reason.empty())
    life.end(Status::invalid, std::move(reason));
  else
    choose_step(life);
  return life;
}

void Evaluation::choose_step(Life& life) const {
  LivingBody& living = life.living;
  LongestStep longest =
      longest_step(conditions_.step, living.body, living.state.position, experiment_.scene, conditions_.method);
  if (!longest.failure.empty()) return life.end(Status::invalid, std::move(longest.failure));
  living.longest_dt = longest.dt;
}

}  // namespace evodevo
