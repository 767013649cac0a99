#include "evolution/breeding.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <unordered_map>

#include "base/genome_sections.hpp"
#include "base/philox.hpp"
#include "base/text.hpp"
#include "evodevo/helpers/pareto.hpp"
#include "evolution/clones.hpp"

namespace evodevo {
namespace {

constexpr std::uint32_t most_repeats = 16;  ///< largest number of times that a newborn is made again if it is a clone

Rng stream(const Experiment& experiment, std::uint32_t generation, std::uint32_t individual, std::uint32_t where) {
  return Rng(philox, {static_cast<std::uint64_t>(experiment.seed), generation, individual, where});
}

/// Throws std::runtime_error if the layout does not allow the genome, so that the error message names the faulty
/// operator.
void check_genome(const Genome& genome, const Layout& layout) {
  if (const std::string fault = genome_fault(genome, layout); !fault.empty())
    throw std::runtime_error("made a genome with " + fault);
}

Individual random_individual(const Experiment& experiment, std::uint32_t generation, std::uint32_t id,
                             std::uint32_t repeat) {
  Individual individual;
  individual.id = id;
  individual.born = individual.origin = generation;
  individual.made_by = "random";
  const auto section_stream = [&](std::uint32_t section) {
    return stream(experiment, generation, id, rng_stream::again(rng_stream::section(section), repeat));
  };
  individual.genome = first_genome(experiment, section_stream, {.individual = id});
  return individual;
}

/// Draws the variation operators that are applied to a child. Returns their indices in the list of all crossovers
/// followed by all mutations. Each operator is drawn with its own probability. If none is drawn, one operator is chosen
/// with a chance in proportion to its probability, so that each child is varied.
std::vector<std::size_t> draw_variation(const Experiment& experiment, Rng& rng) {
  std::vector<double> probabilities;
  for (const auto& crossover : experiment.crossovers) probabilities.push_back(crossover.probability);
  for (const auto& mutation : experiment.mutations) probabilities.push_back(mutation.probability);
  std::vector<std::size_t> drawn;
  for (std::size_t i = 0; i < probabilities.size(); ++i)
    if (rng.chance(probabilities[i])) drawn.push_back(i);
  if (!drawn.empty()) return drawn;
  double left = rng.uniform(0, std::accumulate(probabilities.begin(), probabilities.end(), 0.0));
  std::size_t one = 0;
  while (one + 1 < probabilities.size() && left >= probabilities[one]) left -= probabilities[one++];
  return {one};
}

/// Replaces the sections of a genome on which an operator works by what `change` makes of them.
template <class T, class Change>
void vary(const Experiment& experiment, const Varied<T>& varied, const OperatorCall& call, Genome& genome,
          const Change& change) {
  Genome part = part_of(genome, experiment.layout, varied.sections, varied.layout);
  Genome changed = call_operator(call, [&] {
    Genome made = change(std::move(part));
    check_genome(made, varied.layout);
    return made;
  });
  put_back(genome, experiment.layout, varied.sections, std::move(changed), varied.layout);
}

/// The two parents of a child, as selection has chosen them.
struct Couple {
  const Individual& parent;  ///< the one whose place the child may take
  const Individual& mate;
  bool mate_is_better = false;
};

Individual child(const Experiment& experiment, const Couple& couple, std::uint32_t generation, std::uint32_t id,
                 std::uint32_t repeat) {
  const auto& [parent, mate, mate_is_better] = couple;
  Individual individual;
  individual.id = id;
  individual.born = generation;
  individual.origin = parent.origin;
  individual.parents = {parent.id};
  individual.genome = parent.genome;
  const auto draws = [&](std::uint32_t position) {
    return stream(experiment, generation, id, rng_stream::again(position, repeat));
  };
  Rng choice = draws(rng_stream::variation);
  std::vector<std::string> names;
  for (const std::size_t i : draw_variation(experiment, choice)) {
    if (i < experiment.crossovers.size()) {
      const auto& crossover = experiment.crossovers[i];
      Rng rng = draws(rng_stream::crossover + static_cast<std::uint32_t>(i));
      const Genome mates = part_of(mate.genome, experiment.layout, crossover.sections, crossover.layout);
      vary(experiment, crossover, experiment.call_of(Crossover::kind, i, {.individual = id}), individual.genome,
           [&](const Genome& own) {
             return crossover.op->cross({own, mates, mate_is_better}, crossover.layout, rng);
           });
      individual.parents = {parent.id, mate.id};
      individual.origin = std::min(parent.origin, mate.origin);
      names.push_back(crossover.name);
    } else {
      const std::size_t k = i - experiment.crossovers.size();
      const auto& mutation = experiment.mutations[k];
      Rng rng = draws(rng_stream::mutation + static_cast<std::uint32_t>(k));
      vary(experiment, mutation, experiment.call_of(Mutation::kind, k, {.individual = id}), individual.genome,
           [&](Genome genome) {
             mutation.op->mutate(genome, mutation.layout, rng);
             return genome;
           });
      names.push_back(mutation.name);
    }
  }
  individual.made_by = joined(names, "+");
  return individual;
}

/// Returns a newborn made by `make(repeat)`, with a genome that is not in `known` if possible. As long as the genome is
/// in `known`, the newborn is made again with other random numbers, but at most `most_repeats` times, because there may
/// be no other genomes. Adds the genome to `known`.
template <class Make>
Individual distinct(GenomeSet& known, const Make& make) {
  Individual newborn = make(0);
  for (std::uint32_t repeat = 1; repeat <= most_repeats && known.contains(newborn.genome); ++repeat)
    newborn = make(repeat);
  known.add(newborn.genome);
  return newborn;
}

Point scores_of(const Candidate& row) { return {row.scores.begin(), row.scores.end()}; }

std::vector<std::pair<std::uint32_t, std::uint32_t>> chosen_parents(const Experiment& experiment,
                                                                    const SelectionTable& table, std::uint32_t count,
                                                                    Rng& rng) {
  auto pairs = experiment.selection->parents(table.rows(), count, rng);
  if (pairs.size() != count)
    throw std::runtime_error("chose " + std::to_string(pairs.size()) + " pairs of parents, expected " +
                             std::to_string(count));
  for (const auto& [parent, mate] : pairs)
    if (std::max(parent, mate) >= table.rows().size())
      throw std::runtime_error("chose row " + std::to_string(std::max(parent, mate)) +
                               " as a parent, but the table has " + std::to_string(table.rows().size()) +
                               " rows, numbered from 0");
  return pairs;
}

}  // namespace

Genome first_genome(const Experiment& experiment, const std::function<Rng(std::uint32_t)>& stream,
                    CallSubject subject) {
  std::vector<Genome> sections(experiment.own_layouts.size());
  const auto draw = [&](std::string_view kind, std::size_t index, const auto& op, std::uint32_t section) {
    const Layout& layout = experiment.own_layouts.at(section);
    Rng rng = stream(section);
    call_operator(experiment.call_of(kind, index, subject), [&] {
      sections[section] = op.random(layout, rng);
      check_genome(sections[section], layout);
    });
  };
  draw(Encoding::kind, 0, *experiment.encoding, 0);
  for (std::size_t i = 0; i < experiment.devo.size(); ++i)
    if (const auto own = experiment.devo[i].own_section) draw(Devo::kind, i, *experiment.devo[i].op, *own);
  for (std::size_t i = 0; i < experiment.mutations.size(); ++i)
    if (const auto own = experiment.mutations[i].own_section)
      draw(Mutation::kind, i, *experiment.mutations[i].op, *own);
  return join(sections, experiment.layout);
}

SelectionTable::SelectionTable(const std::vector<Individual>& individuals, const std::vector<Objective>& objectives,
                               std::uint32_t generation)
    : scores_(individuals.size()) {
  std::unordered_map<std::uint32_t, std::uint32_t> row_of;
  for (std::size_t i = 0; i < individuals.size(); ++i) {
    const Individual& individual = individuals[i];
    row_of[individual.id] = static_cast<std::uint32_t>(i);
    if (individual.result.status == Status::ok)
      for (std::size_t o = 0; o < objectives.size(); ++o)
        scores_[i].push_back(objectives[o].maximise ? individual.result.objectives[o]
                                                    : -individual.result.objectives[o]);
    Candidate row;
    row.scores = scores_[i];
    row.age = individual.age(generation);
    if (individual.born == generation && !individual.parents.empty())
      if (const auto parent = row_of.find(individual.parents.front()); parent != row_of.end())
        row.challenges = parent->second;
    rows_.push_back(row);
  }
}

std::vector<Individual> breed(const Experiment& experiment, const std::vector<Individual>& population,
                              std::uint32_t generation, std::uint32_t first_id, std::size_t count) {
  const std::size_t random_individuals =
      population.empty() ? count : std::min(count, static_cast<std::size_t>(experiment.random_individuals));
  std::vector<Individual> newborns;
  GenomeSet known(population);
  std::uint32_t id = first_id;
  if (random_individuals < count) {
    const SelectionTable table(population, experiment.objectives, generation);
    Rng rng = stream(experiment, generation, 0, rng_stream::parents);
    const auto asked = static_cast<std::uint32_t>(count - random_individuals);
    const auto pairs = call_operator(experiment.call_of(Selection::kind, 0),
                                     [&] { return chosen_parents(experiment, table, asked, rng); });
    for (const auto& pair : pairs) {
      const Couple couple{population.at(pair.first), population.at(pair.second),
                          dominates(scores_of(table.rows()[pair.second]), scores_of(table.rows()[pair.first]))};
      newborns.push_back(
          distinct(known, [&](std::uint32_t repeat) { return child(experiment, couple, generation, id, repeat); }));
      ++id;
    }
  }
  for (; newborns.size() < count; ++id)
    newborns.push_back(
        distinct(known, [&](std::uint32_t repeat) { return random_individual(experiment, generation, id, repeat); }));
  return newborns;
}

}  // namespace evodevo
