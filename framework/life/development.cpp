#include "life/development.hpp"

#include <algorithm>
#include <deque>

#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "base/input_error.hpp"
#include "base/philox.hpp"
#include "base/text.hpp"
#include "core/skip_shift.hpp"
#include "life/body_building.hpp"
#include "threads/parallel.hpp"

namespace evodevo {
namespace {

/// Whether a change may add energy to a body by straining or lifting it. Replacing springs with new ones that are born
/// without force adds little.
bool adds_energy(const Change& change) {
  const Edits& edits = change.edits;
  return edits.scaling || !edits.changed_springs.empty() || edits.new_masses.size() > edits.removed_masses.size() ||
         change.lengths_given;
}

bool is_recorded(const Life& life) { return !life.newborn.records.empty(); }

/// Returns a function that computes the energy of a living body, J.
auto energy_of(const Life& life) {
  return [&life] { return total_energy(life.living.body, life.living.state, *life.scene); };
}

}  // namespace

struct DevelopmentLoop::Choices {
  /// `id` is that of the stream of an individual.
  Choices(const DevelopmentLoop& loop, const Life& life, int cycle, std::string_view what, std::uint32_t id)
      : context(loop.context_of(life, cycle, {}, {})), rng(loop.stream_of(life, {}, id)), chance(context, rng) {
    context.draws = draws_of_development(loop.experiment_, life.newborn, what, static_cast<std::uint64_t>(cycle));
  }
  Choices(const Choices&) = delete;  // `chance` refers to the others
  Choices& operator=(const Choices&) = delete;

  DevoContext context;
  Rng rng;
  Chance chance;
};

double DevelopmentLoop::duration() const {
  const DevelopmentSettings& development = experiment_.development;
  const int times_lived = development.control == Control::random_places ? 2 : 1;
  return times_lived * static_cast<double>(development.cycles) * development.cycle_time;
}

void DevelopmentLoop::run(std::span<Life> lives, const Progress& progress) const {
  std::vector<std::vector<Change>> recorded(lives.size());
  for (std::size_t i = 0; i < lives.size(); ++i)
    if (is_recorded(lives[i])) recorded[i] = lives[i].newborn.records.front().changes();
  const bool yoked = experiment_.development.control == Control::random_places;
  std::vector<std::optional<Yoke>> yokes(lives.size());
  if (yoked) yokes = yokes_of(lives);
  const auto change = [&](std::size_t i, int cycle) {
    if (is_recorded(lives[i]))
      apply_recorded(recorded[i], lives[i], cycle);
    else if (yoked)
      change_as_in(*yokes[i], lives[i], cycle);
    else
      apply_operators(lives[i], cycle);
  };
  const bool observed = !yoked && !std::all_of(lives.begin(), lives.end(), is_recorded);
  run_cycles(lives, observed, change, progress);
}

std::vector<std::optional<Yoke>> DevelopmentLoop::yokes_of(std::span<Life> lives) const {
  std::vector<std::size_t> yoked;
  std::vector<Life> before;
  for (std::size_t i = 0; i < lives.size(); ++i) {
    if (is_recorded(lives[i])) continue;
    yoked.push_back(i);
    before.push_back(lives[i]);
  }
  const auto change = [&](std::size_t i, int cycle) { apply_operators(before[i], cycle); };
  run_cycles(before, true, change, [](double) {});
  std::vector<std::optional<Yoke>> yokes(lives.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    yokes[yoked[i]].emplace(lives[yoked[i]].living, before[i].record);
    if (before[i].given_up) lives[yoked[i]].end(Status::invalid, before[i].result.reason);
  }
  return yokes;
}

template <class Action>
void DevelopmentLoop::run_cycles(std::span<Life> lives, bool observed, const Action& change,
                                 const Progress& progress) const {
  const DevelopmentSettings& development = experiment_.development;
  if (observed) begin_to_count(lives);
  for (int cycle = 1; cycle <= development.cycles; ++cycle) {
    const RecordRequest request = observed ? cycle_request(experiment_, cycle) : RecordRequest{};
    simulate_cycle(lives, cycle, request);
    const BusyClock::Span span(clock_);
    simulation_.simulator().workers().for_each(lives.size(), [&](std::size_t i) {
      if (!lives[i].alive()) return;
      record_masses(request, lives[i].living);
      change(i, cycle);
      if (!lives[i].alive()) return;
      if (development.reset) allow_energy(lives[i], energy_of(lives[i]), [&] { return_to_rest(lives[i]); });
      if (lives[i].living.body.springs.empty())
        lives[i].end(Status::invalid, "no springs");
      else
        simulation_.choose_step(lives[i]);
    });
    progress(static_cast<double>(cycle) / static_cast<double>(development.cycles));
  }
}

void DevelopmentLoop::begin_to_count(std::span<Life> lives) const {
  for (std::size_t i = 0; i < experiment_.devo.size(); ++i)
    if (devo_request(experiment_, i).age)
      for (Life& life : lives) life.living.cycles_lived.assign(life.living.body.masses.size(), 0.0);
}

void DevelopmentLoop::simulate_cycle(std::span<Life> lives, int cycle, const RecordRequest& request) const {
  const DevelopmentSettings& development = experiment_.development;
  const Recording of_springs = recording(request);
  Stretch stretch = windows_.in_cycle(cycle);
  stretch.contact = request.contact;
  const auto tally = [&](std::span<Task> tasks, std::span<Life* const> alive) {
    std::deque<Choices> choices;
    for (const Life* life : alive)
      choices.emplace_back(*this, *life, cycle, "stress tallies", rng_stream::stress_tallies(cycle));
    const auto order = [&](std::size_t i, std::uint64_t number) {
      Chance& chance = choices[i].chance;
      return chance.inherited() ? chance.springs_by_number({"tally", number})
                                : random_order(choices[i].context.body.springs.size(), chance.rng());
    };
    run_with_tallies(simulation_.simulator(), tasks, static_cast<std::uint64_t>(development.skip), order);
  };
  const auto record = [&](std::span<Task> tasks, std::span<Life* const>) {
    simulation_.simulator().run(tasks, of_springs);
  };
  if (of_springs.stress && development.probe == Probe::skip_shift)
    simulation_.run(lives, stretch, tally);
  else
    simulation_.run(lives, stretch, record);
}

template <class Energy, class Action>
void DevelopmentLoop::allow_energy(Life& life, const Energy& energy, const Action& action) const {
  const double before = energy();
  action();
  life.living.state.start_energy += std::max(0.0, energy() - before);
}

Box DevelopmentLoop::bounds(const Life& life) const {
  const LivingBody& living = life.living;
  Box box =
      experiment_.development.reset ? bounding_box(rest_positions(living.body)) : bounding_box(living.state.position);
  if (const auto& floor = life.scene->floor) box.low.z = std::max(box.low.z, floor->roughness);
  box.high.z = std::max(box.high.z, box.low.z);
  return box;
}

void DevelopmentLoop::apply_operators(Life& life, int cycle) const {
  const DevelopmentSettings& development = experiment_.development;
  if (development.control == Control::no_change) return;
  if (development.control == Control::shuffled_stress) shuffle_records(life, cycle);
  for (std::size_t i = 0; i < experiment_.devo.size(); ++i)
    if (life.alive() && experiment_.devo[i].schedule.contains(cycle)) apply_operator(life, cycle, i);
  if (life.alive()) shed_loose_pieces(life, cycle);
}

void DevelopmentLoop::shuffle_records(Life& life, int cycle) const {
  const auto shuffle = [&](const auto& lists, std::size_t items, std::uint32_t id, const auto& by_number) {
    Choices choices(*this, life, cycle, "shuffle", id);
    std::vector<std::uint32_t> from;  // of each item, whose values it gets
    if (choices.chance.inherited()) {
      const std::vector<std::uint32_t> ring = by_number(choices.chance);
      from.resize(items);
      for (std::size_t i = 0; i < items; ++i) from[ring[i]] = ring[(i + 1) % items];
    } else {
      from = random_order(items, choices.chance.rng());
    }
    for (const auto list : lists) {
      std::vector<double>& record = life.living.*list;
      if (record.empty()) continue;
      std::vector<double> shuffled;
      for (const std::uint32_t i : from) shuffled.push_back(record[i]);
      record = std::move(shuffled);
    }
  };
  const Body& body = life.living.body;
  shuffle(SpringRecords::lists, body.springs.size(), rng_stream::stress_shuffle(cycle),
          [](Chance& chance) { return chance.springs_by_number("spring"); });
  shuffle(MassRecords::lists, body.masses.size(), rng_stream::mass_shuffle(cycle),
          [](Chance& chance) { return chance.masses_by_number("mass"); });
}

void DevelopmentLoop::apply_operator(Life& life, int cycle, std::size_t index) const {
  const auto& [op, label, schedule, own_section] = experiment_.devo[index];
  const auto genes_of = [&](std::uint32_t section) {
    return part_of(*life.newborn.genome, experiment_.layout, {section}, experiment_.own_layouts[section]);
  };
  const Genome genome = genes_of(0), own = own_section ? genes_of(*own_section) : no_genes;
  OperatorMemory& memory = life.living.memory.at(index);
  DevoContext context = context_of(life, cycle, schedule, devo_request(experiment_, index), genome, own);
  context.mass_memory = memory.masses.view("mass");
  context.spring_memory = memory.springs.view("spring");
  context.body_memory = {memory.body, "body"};
  context.draws =
      draws_of_development(experiment_, life.newborn, "operator " + label, static_cast<std::uint64_t>(cycle));
  Rng rng = stream_of(life, context.draws, rng_stream::devo(index, cycle));
  const auto develop = [&] {
    Edits edits(context.body);
    op->develop(context, edits, rng);
    if (edits.failure) {
      life.given_up = true;
      return life.end(Status::invalid, "given up by \"" + printable(label) + "\" after cycle " + std::to_string(cycle) +
                                           ": " + printable(*edits.failure));
    }
    remember(edits, memory_names(*op), life.living.body, memory);
    if (memory.springs_changed) write_out_scaling(edits, life.living.body, memory.springs);
    // records that no later operator of this cycle asks for need not follow the edits
    life.living.keep(recording(cycle_request(experiment_, cycle, index + 1)));
    make(change_by(edits, static_cast<std::uint32_t>(index), context), life);
  };
  call_operator(experiment_.call_of(Devo::kind, index, {.individual = life.newborn.id, .cycle = cycle}), develop);
}

void DevelopmentLoop::change_as_in(Yoke& yoke, Life& life, int cycle) const {
  Rng rng = stream_of(life, {}, rng_stream::random_places(cycle));
  for (const Amount& amount : yoke.amounts_after(cycle)) {
    DevoContext context = context_of(life, cycle, {}, {});
    context.draws =
        draws_of_development(experiment_, life.newborn, "random places of " + experiment_.devo.at(amount.op).label,
                             static_cast<std::uint64_t>(cycle));
    Chance chance(context, rng);
    make(change_by(at_random_places(amount, context, yoke.surplus, chance), amount.op, context), life);
  }
  shed_loose_pieces(life, cycle);
}

Rng DevelopmentLoop::stream_of(const Life& life, const Draws& draws, std::uint32_t id) const {
  if (draws.inherited()) return draws.stream("stream");
  return Rng(philox, {seed_of(experiment_.seed, life.newborn.draws), life.newborn.generation, life.newborn.id, id});
}

DevoContext DevelopmentLoop::context_of(const Life& life, int cycle, const Schedule& schedule,
                                        const RecordRequest& request, const Genome& genome, const Genome& own) const {
  const DevelopmentSettings& development = experiment_.development;
  const LivingBody& living = life.living;
  DevoContext context{.body = living.body,
                      .state = living.state,
                      .cycle = cycle,
                      .cycles = static_cast<int>(development.cycles),
                      .application = static_cast<int>(schedule.applications(cycle)),
                      .applications = static_cast<int>(schedule.applications(development.cycles)),
                      .time = living.state.time,
                      .bounds = bounds(life),
                      .mass = experiment_.context.mass,
                      .resets = development.reset,
                      .genome = genome,
                      .layout = experiment_.own_layouts.front(),
                      .own = own,
                      .first_time = static_cast<double>(schedule.from) * development.cycle_time,
                      .last_time = static_cast<double>(schedule.last(development.cycles)) * development.cycle_time,
                      .identities = living.numbers.identities(),
                      .daughters = living.numbers.daughters(),
                      .scenario = life.scenario != nullptr ? std::string_view(life.scenario->name) : "",
                      .life = life.newborn.life};
  show_records(living, request, context);
  return context;
}

void DevelopmentLoop::make(Change change, Life& life) const {
  if (change.edits.empty()) return;
  const auto apply_it = [&] { apply(change.edits, life.living, change.op); };
  if (only_scales(change.edits))  // nothing but the elastic energy changes, and finding out how takes less time
    allow_energy(life, ElasticEnergy(life.living.body, life.living.state), apply_it);
  else if (adds_energy(change))
    allow_energy(life, energy_of(life), apply_it);
  else
    apply_it();
  life.record.add(change);
}

void DevelopmentLoop::apply_recorded(const std::vector<Change>& changes, Life& life, int cycle) const {
  for (const Change& change : changes) {
    if (change.cycle != static_cast<std::uint32_t>(cycle)) continue;
    try {
      make(change, life);
    } catch (const std::invalid_argument& error) {
      throw InputError(life.newborn.recorded_in + ": the record of its life does not fit its body: after cycle " +
                       std::to_string(cycle) + " it " + error.what() + "; put back an undamaged copy of it");
    }
  }
}

void DevelopmentLoop::shed_loose_pieces(Life& life, int cycle) const {
  Edits edits;
  for (const std::uint32_t mass : loose_masses(life.living.body)) edits.remove_mass(mass);
  if (edits.empty()) return;
  const DevoContext context = context_of(life, cycle, {}, {});
  make(change_by(edits, std::nullopt, context), life);
}

void DevelopmentLoop::return_to_rest(Life& life) const {
  State& state = life.living.state;
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    state.position[i] = life.living.body.masses[i].rest;
    state.velocity[i] = {};
  }
  // rest positions assume level ground
  if (const auto& floor = life.scene->floor; floor && floor->rough()) put_on_ground(state.position, *life.scene);
}

}  // namespace evodevo
