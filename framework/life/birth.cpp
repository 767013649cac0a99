#include "life/birth.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "base/materials.hpp"
#include "base/philox.hpp"
#include "life/measurement/scenario_start.hpp"

namespace evodevo {
namespace {

/// Returns the reason why a body in the middle of its life must not be simulated, or an empty text if it may be
/// simulated. It must not be simulated if the floor would fling it out, that is, if the elastic energy of the floor
/// below its masses is larger than the energy that the body can have put into the floor: its total energy plus the
/// energy of a fall by its own size and its depth. A rigid floor lets masses out slowly.
std::string throw_by_ground(const LivingBody& living, const Scene& scene) {
  if (!scene.floor || scene.floor->rigid()) return {};
  const std::vector<Vec3>& positions = living.state.position;
  const double size = bounding_box(positions).longest_side(), rounding = 1e-6 * size;
  double weight = 0, held = 0, deepest = 0;  // N, J, m
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (scene.gravity) weight += living.body.masses[i].mass * scene.gravity->downwards();
    const double depth = ground_height(scene, positions[i]) - positions[i].z;
    if (!(depth > rounding)) continue;
    deepest = std::max(deepest, depth);
    held += scene.floor->stiffness * depth * depth / 2;
  }
  const double brought = std::max(0.0, total_energy(living.body, living.state, scene)) + weight * (size + deepest);
  if (held <= brought) return {};
  return fmt::format(
      "inside the ground, up to {:.3g} m deep: the floor would throw it out with {:.3g} J, but it can have entered "
      "with only {:.3g} J",
      deepest, held, brought);
}

}  // namespace

void move_at_random(double most, const Draws& draws, Rng rng, LivingBody& living) {
  for (std::size_t i = 0; i < living.state.position.size(); ++i) {
    if (draws.inherited()) rng = draws.stream("offset", {living.numbers.identities().at(i)});
    const auto offset = [&] { return most * (2 * rng.uniform() - 1); };
    const double x = offset(), y = offset(), z = offset();
    living.state.position[i] = living.state.position[i] + Vec3{x, y, z};
  }
}

Blueprint decoded(const Experiment& experiment, const Genome& genome, CallSubject subject) {
  return call_operator(experiment.call_of(Encoding::kind, 0, subject), [&] {
    const Layout& layout = experiment.own_layouts.front();
    const Genome own = part_of(genome, experiment.layout, {0}, layout);
    Blueprint blueprint = experiment.encoding->decode(own, layout, experiment.context);
    if (blueprint.failure.empty()) check_blueprint(blueprint, experiment.context, experiment.encoding->spring_memory());
    return blueprint;
  });
}

namespace {

/// Lets the experiment's encoding complete a blueprint whose neighbours have been joined.
void complete_by_encoding(const Experiment& experiment, CallSubject subject, Blueprint& blueprint) {
  call_operator(experiment.call_of(Encoding::kind, 0, subject),
                [&] { complete(*experiment.encoding, experiment.context, blueprint); });
}

}  // namespace

BuiltBody build_body(const Experiment& experiment, Blueprint blueprint, CallSubject subject) {
  return build_body(std::move(blueprint),
                    [&](std::size_t, Blueprint& joined) { complete_by_encoding(experiment, subject, joined); });
}

Birth::Birth(const Experiment& experiment, const LifeSimulation& simulation)
    : experiment_(experiment), simulation_(simulation) {
  for (std::size_t i = 0; i < experiment.devo.size(); ++i) names_.push_back(memory_names(experiment, i));
}

std::vector<BuiltBody> Birth::build(std::span<const Newborn> newborns) const {
  std::vector<std::size_t> first;  // of each group of newborns with one genome in common
  for (std::size_t i = 0; i < newborns.size(); ++i)
    if (i == 0 || newborns[i].genome != newborns[i - 1].genome) first.push_back(i);
  std::vector<Blueprint> blueprints(first.size());
  simulation_.simulator().workers().for_each(first.size(), [&](std::size_t i) {
    const Newborn& newborn = newborns[first[i]];
    blueprints[i] = decoded(experiment_, *newborn.genome, {.individual = newborn.id});
  });
  const auto after_joining = [&](std::size_t i, Blueprint& blueprint) {
    complete_by_encoding(experiment_, {.individual = newborns[first[i]].id}, blueprint);
  };
  std::vector<BuiltBody> built = build_bodies(std::move(blueprints), simulation_.simulator().neighbours(),
                                              simulation_.simulator().workers(), after_joining);
  if (first.size() == newborns.size()) return built;
  std::vector<BuiltBody> of_each;
  for (std::size_t group = 0; group < first.size(); ++group) {
    const std::size_t end = group + 1 < first.size() ? first[group + 1] : newborns.size();
    of_each.insert(of_each.end(), end - first[group] - 1, built[group]);
    of_each.push_back(std::move(built[group]));
  }
  return of_each;
}

std::vector<Life> Birth::of(std::span<const Newborn> newborns, const Scenario* scenario) const {
  const BusyClock::Span span(clock_);
  return begin_all(build(newborns), newborns, scenario);
}

Cohort Birth::in_all_scenes(std::span<const Newborn> newborns) const {
  const BusyClock::Span span(clock_);
  std::vector<BuiltBody> built = build(newborns);
  Cohort cohort;
  for (const std::size_t scenario : scenarios_that_develop(experiment_))
    cohort.in_scenarios[scenario] = begin_all(built, newborns, &experiment_.scenarios[scenario]);
  cohort.lives = begin_all(std::move(built), newborns, nullptr);
  return cohort;
}

std::vector<Life> Birth::begin_all(std::vector<BuiltBody> built, std::span<const Newborn> newborns,
                                   const Scenario* scenario) const {
  std::vector<Life> lives(newborns.size());
  simulation_.simulator().workers().for_each(lives.size(), [&](std::size_t i) {
    Body& body = built[i].body;
    if (built[i].failure.empty()) {
      body.base_materials = static_cast<std::uint32_t>(experiment_.context.materials.size());
      drop_unused_materials(body);
      lives[i] = scenario != nullptr ? begin(std::move(built[i]), scenario->scene, scenario->payload)
                                     : begin(std::move(built[i]), experiment_.scene, experiment_.payload);
    } else {
      lives[i].end(Status::invalid, std::move(built[i].failure));
    }
    lives[i].newborn = newborns[i];
    lives[i].scenario = scenario;
    if (scenario != nullptr) lives[i].newborn.records.clear();
    if (lives[i].alive() && simulation_.conditions().birth_noise > 0) add_noise(lives[i]);
  });
  return lives;
}

void Birth::add_noise(Life& life) const {
  LivingBody& living = life.living;
  std::vector<Vec3>& positions = living.state.position;
  move_at_random(simulation_.conditions().birth_noise * bounding_box(positions).longest_side(),
                 draws_of_life(experiment_, life.newborn, "birth", 0),
                 Rng(philox, {seed_of(experiment_.seed, life.newborn.life), life.newborn.generation, life.newborn.id,
                              rng_stream::birth_noise}),
                 living);
  put_on_ground(positions, *life.scene);
  living.state.start_energy = total_energy(living.body, living.state, *life.scene);
  simulation_.choose_step(life);
}

Life Birth::of(Body body) const {
  return begin({.body = std::move(body), .failure = {}, .kept = {}}, experiment_.scene, experiment_.payload);
}

Life Birth::begin(BuiltBody built, const Scene& scene, const std::optional<Payload>& payload) const {
  if (payload) add_payload(built.body, payload->share, payload->top);
  State state = state_at_birth(built.body, scene);
  Life life = life_of(std::move(built), std::move(state), scene);
  simulation_.choose_step(life);
  return life;
}

Life Birth::life_of(BuiltBody built, State state, const Scene& scene) const {
  Life life;
  life.scene = &scene;
  LivingBody& living = life.living;
  for (const MemoryNames& names : names_) living.memory.push_back(memory_at_birth(names, built));
  living.body = std::move(built.body);
  living.state = std::move(state);
  living.numbers =
      built.identities.empty() ? MassNumbers(living.body.masses.size()) : MassNumbers(std::move(built.identities));
  return life;
}

Life Birth::amid_life(Body body, State state) const {
  // if the body lived in another scene before, the forces of this scene may add energy
  state.start_energy = std::max(state.start_energy, total_energy(body, state, experiment_.scene));
  Life life = life_of({.body = std::move(body), .failure = {}, .kept = {}}, std::move(state), experiment_.scene);
  if (std::string reason = throw_by_ground(life.living, experiment_.scene); !reason.empty())
    life.end(Status::invalid, std::move(reason));
  else
    simulation_.choose_step(life);
  return life;
}

Conditions conditions_to_come(const Experiment& experiment) {
  Conditions conditions(experiment);
  if (conditions.birth_noise == 0) conditions.birth_noise = perturbation;
  return conditions;
}

void perturb(Life& life, const Experiment& experiment, std::uint32_t start) {
  State& state = life.living.state;
  const double most = perturbation * bounding_box(state.position).longest_side();
  const Draws draws = draws_of_life(experiment, life.newborn, "perturbation", start);
  move_at_random(most, draws,
                 Rng(philox, {seed_of(experiment.seed, life.newborn.life), life.newborn.generation, life.newborn.id,
                              rng_stream::perturbation + start}),
                 life.living);
}

}  // namespace evodevo
