#include "evolution/evolution.hpp"

#include <algorithm>
#include <chrono>
#include <map>
#include <utility>

#include "archive/archive_writer.hpp"
#include "base/philox.hpp"
#include "base/statistics.hpp"
#include "base/text.hpp"
#include "evolution/breeding.hpp"
#include "evolution/clones.hpp"
#include "evolution/founders.hpp"
#include "evolution/front_lives.hpp"
#include "evolution/front_verification.hpp"
#include "evolution/islands/migration.hpp"
#include "evolution/selection_checks.hpp"
#include "evolution/selection_table.hpp"
#include "life/measurement/combining.hpp"

namespace evodevo {
namespace {

/// Returns the members of a population that live again: those that were measured longest ago. They have a fitness,
/// which was found by a provenance that the evaluator has.
std::vector<Individual*> due_again(std::vector<Individual>& population, const Experiment& experiment,
                                   const RecordedProvenances& provenances) {
  std::vector<Individual*> due;
  for (Individual& one : population)
    if (one.result.status == Status::ok && one.lives + experiment.lives <= most_lives &&
        provenances.own(one.provenance))
      due.push_back(&one);
  std::ranges::stable_sort(due, {}, &Individual::measured);
  due.resize(std::min(due.size(), static_cast<std::size_t>(experiment.remeasure)));
  return due;
}

/// Evaluates newborns, and further lives of elders. The result of a newborn with a twin (Twins), which would be the
/// same, is copied instead. Returns the spring evaluations of all.
std::uint64_t evaluate(std::vector<Individual>& newborns, std::span<Individual* const> elders,
                       const std::vector<Individual>& population, const Experiment& experiment, Evaluator& evaluator,
                       const RecordedProvenances& provenances, const Observer& observer) {
  const auto lives = static_cast<std::uint32_t>(experiment.lives);
  Twins twins(population, experiment, provenances);
  std::vector<Newborn> batch;
  std::vector<Individual*> evaluated;
  std::vector<std::pair<Individual*, const Individual*>> copies;
  for (Individual& newborn : newborns) {
    newborn.lives = lives;
    newborn.measured = newborn.born;
    if (const Individual* twin = twins.find_or_add(newborn)) {
      copies.emplace_back(&newborn, twin);
    } else {
      batch.push_back(newborn_of(newborn));
      evaluated.push_back(&newborn);
    }
  }
  for (const Individual* elder : elders) {
    Newborn& again = batch.emplace_back(newborn_of(*elder));
    again.life += again.lives;
    again.lives = lives;
  }
  std::vector<Evaluated> found = evaluator.evaluate(batch, observer.generation_progress);
  std::uint64_t spring_evaluations = 0;
  for (const Evaluated& one : found) spring_evaluations += one.result.spring_evaluations;
  for (std::size_t i = 0; i < evaluated.size(); ++i) {
    evaluated[i]->result = std::move(found[i].result);
    evaluated[i]->provenance = provenances.recorded(found[i].provenance);
  }
  for (const auto& [copy, twin] : copies) {  // before elders live again, so that a twin among them has the same lives
    copy->result = twin->result;
    copy->result.spring_evaluations = 0;
    copy->lives = twin->lives;
    copy->provenance = twin->provenance;
  }
  for (std::size_t i = 0; i < elders.size(); ++i) {
    Individual& elder = *elders[i];
    add_lives(experiment, elder.lives, lives, std::move(found[evaluated.size() + i].result), elder.result);
    elder.lives += lives;
    elder.measured = newborns.front().born;
  }
  return spring_evaluations;
}

/// Adds the provenances of the evaluator to those of the run.
RecordedProvenances recorded_provenances(const Evaluator& evaluator, Archive& archive) {
  std::vector<std::uint32_t> recorded;
  for (const Provenance& provenance : evaluator.provenances()) recorded.push_back(archive.add_provenance(provenance));
  return RecordedProvenances(std::move(recorded));
}

/// Returns what the selection operator has chosen, with its rows in ascending order.
Survival chosen_survivors(const Experiment& experiment, const SelectionTable& table, std::uint32_t population,
                          Rng& rng) {
  Survival survival = experiment.selection->survivors(table.context(), population, rng);
  check_survival(survival, {experiment.notes, experiment.selection->memory()}, table.context(), population);
  std::sort(survival.rows.begin(), survival.rows.end());
  return survival;
}

/// Removes from `everyone` all individuals except the survivors, which stay in the order of birth. Adds the ids of the
/// removed individuals to `dropped`. Replaces what the operator remembers, if it returns something, and adds its notes,
/// which replace those that it has made about its children.
void select(std::vector<Individual>& everyone, const Experiment& experiment, std::uint32_t generation,
            std::vector<std::uint32_t>& dropped, Remembered& remembered) {
  const auto population = static_cast<std::uint32_t>(experiment.population);
  const SelectionTable table(everyone, experiment, generation, remembered.memory.survivors);
  Rng rng(philox, {static_cast<std::uint64_t>(experiment.seed), generation, 0, rng_stream::survivors});
  Survival survival = call_operator(experiment.call_of(Selection::kind, 0),
                                    [&] { return chosen_survivors(experiment, table, population, rng); });
  if (survival.memory) remembered.memory.survivors = std::move(*survival.memory);
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> notes;
  for (const NoteOf& note : remembered.notes) notes[{note.individual, note.title}] = note.value;
  for (const Note& note : survival.notes) notes[{everyone[note.row].id, note.title}] = note.value;
  remembered.notes.clear();
  for (const auto& [place, value] : notes) remembered.notes.push_back({place.first, place.second, value});
  std::vector<Individual> survivors;
  for (std::uint32_t i = 0; i < everyone.size(); ++i) {
    if (std::binary_search(survival.rows.begin(), survival.rows.end(), i))
      survivors.push_back(std::move(everyone[i]));
    else
      dropped.push_back(everyone[i].id);
  }
  everyone = std::move(survivors);
}

/// Whether copies stay, because the operator that chooses survivors has made the children itself: it may count them.
bool needs_all_children(const Experiment& experiment) {
  return experiment.makes_children() && !experiment.parent_selection;
}

/// Returns the first objective of the individuals whose status is `ok`.
std::vector<double> first_scores(const std::vector<Individual>& population) {
  std::vector<double> scores;
  for (const Individual& individual : population)
    if (individual.result.status == Status::ok) scores.push_back(individual.result.objectives.front());
  return scores;
}

Summary summarise(const std::vector<Individual>& population, const std::vector<Individual>& newborns,
                  std::span<Individual* const> elders, std::uint32_t generation) {
  Summary summary;
  summary.generation = generation;
  summary.clones = count_clones(population, newborns);
  const auto count = [&](const Individual& individual) {
    summary.diverged += individual.result.status == Status::diverged;
    summary.invalid += individual.result.status == Status::invalid;
  };
  for (const Individual& individual : newborns) count(individual);
  for (const Individual* elder : elders) count(*elder);
  return summary;
}

void add_refusals(const std::vector<Refusal>& refusals, Summary& summary) {
  for (const Refusal& refusal : refusals) {
    summary.artefact += refusal.status == Status::artefact;
    summary.lucky += refusal.status == Status::lucky;
    summary.passive += refusal.status == Status::passive;
  }
}

}  // namespace

TimeSpent evolve(const Experiment& experiment, Simulator& simulator, Archive& archive, const std::atomic<bool>& stop,
                 const Observer& observer) {
  LocalEvaluator evaluator(experiment, simulator);
  return evolve(experiment, evaluator, archive, stop, observer);
}

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

}  // namespace

struct Evolution::State {
  /// What the generations of this process need. It is made with the first of them, because it records the provenance of
  /// this process, which makes nothing new in a run that is finished.
  struct Work {
    RecordedProvenances provenances;
    FrontLives lives;
    FrontVerification verification;
    ArchiveWriter writer;

    explicit Work(State& state)
        : provenances(recorded_provenances(state.evaluator, state.archive)),
          lives(state.experiment, state.evaluator, provenances, state.archive),
          verification(state.experiment, state.evaluator, provenances),
          writer(state.archive) {}
  };

  const Experiment& experiment;
  Evaluator& evaluator;
  Archive& archive;
  Migration* migration;
  std::vector<Summary> summaries = archive.generations();
  std::vector<Individual> population = archive.population();
  Remembered remembered{archive.memory(), {}};
  std::unique_ptr<Work> work = nullptr;
  PhaseTimes before = evaluator.phase_times();
  TimeSpent time = {};

  bool is_finished() const { return evodevo::is_finished(experiment, summaries); }
  void make_generation(const std::vector<Migrant>& migrants, const Observer& observer);
};

void Evolution::State::make_generation(const std::vector<Migrant>& migrants, const Observer& observer) {
  const auto start = Clock::now();
  const auto generation = static_cast<std::uint32_t>(summaries.size());
  const std::int64_t evaluations = summaries.empty() ? 0 : summaries.back().evaluations;
  const std::int64_t count = std::min(experiment.births(generation), experiment.evaluations - evaluations);
  remembered.notes.clear();
  // each evaluation uses one id, so the next id is the number of evaluations so far
  std::vector<Individual> newborns =
      breed(experiment, population, generation, static_cast<std::uint32_t>(evaluations),
            static_cast<std::size_t>(count), &remembered, &evaluator.workers(), migrants);
  time.breed += seconds_since(start);
  const std::vector<Individual*> elders = due_again(population, experiment, work->provenances);
  const std::uint64_t spring_evaluations =
      evaluate(newborns, elders, population, experiment, evaluator, work->provenances, observer);
  Summary summary = summarise(population, newborns, elders, generation);
  summary.spring_evaluations = spring_evaluations;
  std::vector<Individual> measured_again;
  for (const Individual* elder : elders) measured_again.push_back(*elder);
  work->verification.forget(measured_again);
  population.insert(population.end(), newborns.begin(), newborns.end());
  const std::vector<Refusal> refusals = work->verification.refuse(population, generation);
  add_refusals(refusals, summary);
  const auto selection = Clock::now();
  std::vector<std::uint32_t> dropped;
  if (!needs_all_children(experiment)) dropped = remove_copies(population);
  work->lives.keep_front(population, generation);
  const std::vector<Individual> claimants =
      migration ? migration->claimants(population, generation) : std::vector<Individual>();
  select(population, experiment, generation, dropped, remembered);
  if (!claimants.empty()) migration->replace(claimants, generation, population, dropped);
  work->lives.keep_front(population, generation);
  const auto [best, median] = best_and_median(first_scores(population), experiment.objectives.front().maximise);
  summary.best = best;
  summary.median = median;
  summary.evaluations = evaluations + count;
  summary.wall_time = seconds_since(start);
  time.select += seconds_since(selection);
  const auto departures = migration ? migration->departures(population, generation) : std::vector<Emigration>();
  work->writer.begin({std::move(newborns), std::move(measured_again), std::move(dropped), work->lives.committed(),
                      summary, remembered, refusals, departures});
  if (migration) migration->depart(departures, population, generation);
  summaries.push_back(summary);
  if (migration && is_finished()) migration->end();
  observer.generation_done(experiment.island, summary);
}

Evolution::Evolution(const Experiment& experiment, Evaluator& evaluator, Archive& archive, Migration* migration)
    : state_(new State{experiment, evaluator, archive, migration}) {}
Evolution::Evolution(Evolution&&) noexcept = default;
Evolution::~Evolution() = default;

bool Evolution::is_finished() const { return state_->is_finished(); }
std::uint32_t Evolution::generation() const { return static_cast<std::uint32_t>(state_->summaries.size()); }

bool Evolution::advance(const std::atomic<bool>& stop, const Observer& observer) {
  State& state = *state_;
  if (state.is_finished() || stop) return false;
  const auto begin = Clock::now();
  if (!state.work) state.work = std::make_unique<State::Work>(state);
  const auto generation = static_cast<std::uint32_t>(state.summaries.size());
  const auto migrants = generation == 0   ? founders(state.experiment)
                        : state.migration ? state.migration->arrivals(generation, stop)
                                          : std::vector<Migrant>();
  if (migrants) state.make_generation(*migrants, observer);
  state.time.whole += seconds_since(begin);
  return migrants.has_value();
}

TimeSpent Evolution::pause() {
  State& state = *state_;
  if (!state.work) return {};
  const auto begin = Clock::now();
  state.work->writer.wait();
  state.time.whole += seconds_since(begin);
  state.time.archive = state.work->writer.seconds();
  const PhaseTimes now = state.evaluator.phase_times();
  state.time.evaluation = {now.decode - state.before.decode, now.simulate - state.before.simulate,
                           now.develop - state.before.develop};
  state.time.verify = state.work->verification.seconds();
  return state.time;
}

TimeSpent evolve(const Experiment& experiment, Evaluator& evaluator, Archive& archive, const std::atomic<bool>& stop,
                 const Observer& observer) {
  Evolution evolution(experiment, evaluator, archive);
  while (evolution.advance(stop, observer)) {
  }
  return evolution.pause();
}

}  // namespace evodevo
