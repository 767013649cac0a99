#include "evolution/breeding.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "base/genome_sections.hpp"
#include "base/philox.hpp"
#include "base/text.hpp"
#include "evodevo/helpers/selection/pareto.hpp"
#include "evolution/clones.hpp"
#include "evolution/selection_checks.hpp"
#include "evolution/selection_table.hpp"
#include "threads/parallel.hpp"

namespace evodevo {
namespace {

constexpr std::uint32_t most_repeats = 16;  ///< largest number of times that a newborn is made again if it is a clone
constexpr std::size_t worth_threads = 256;  ///< newborns; one thread makes fewer of them as fast

Rng stream(const Experiment& experiment, std::uint32_t generation, std::uint32_t individual, std::uint32_t where) {
  return Rng(philox, {static_cast<std::uint64_t>(experiment.seed), generation, individual, where});
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
struct ParentsOfChild {
  const Individual& parent;  ///< the one whose place the child may take
  const Individual& mate;
  bool mate_is_better = false;
};

Individual child(const Experiment& experiment, const ParentsOfChild& couple, std::uint32_t generation, std::uint32_t id,
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
             return crossover.op->cross({own, mates, mate_is_better}, {crossover.layout, generation}, rng);
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
             mutation.op->mutate(genome, {mutation.layout, generation}, rng);
             return genome;
           });
      names.push_back(mutation.name);
    }
  }
  individual.made_by = joined(names, "+");
  return individual;
}

/// What is to be bred.
struct Brood {
  const Experiment& experiment;
  const std::vector<Individual>& population;
  std::uint32_t generation;
  std::uint32_t first_id;
  Remembered& remembered;
  Workers* workers;

  /// The memory of the operator that chooses the parents or makes the children.
  SelectionMemory& memory() const {
    return experiment.parent_selection ? remembered.memory.parents : remembered.memory.survivors;
  }
};

/// The newborns of a generation and the genomes that are known: theirs, and those of the population.
class Nursery {
 public:
  Nursery(const Brood& brood, std::size_t count)
      : workers_(brood.workers), next_id_(brood.first_id), known_(brood.population) {
    newborns_.reserve(count);  // because `known_` refers to their genomes
  }

  std::uint32_t next_id() const { return next_id_; }
  std::size_t count() const { return newborns_.size(); }
  bool knows(const Genome& genome) const { return known_.contains(genome); }

  void add(Individual newborn) {
    newborns_.push_back(std::move(newborn));
    known_.add(newborns_.back().genome);
    ++next_id_;
  }
  /// Adds `count` newborns, number i made by `make(i, id, repeat)`, with genomes that are not known yet if possible.
  /// At first all are made, on all threads if they are many. Then, one after the other, those whose genomes are known
  /// are made again with other random numbers, but at most `most_repeats` times, because there may be no other genomes.
  template <class Make>
  void add_distinct(std::size_t count, const Make& make) {
    std::vector<Individual> made(count);
    const auto make_first = [&](std::size_t i) { made[i] = make(i, next_id_ + static_cast<std::uint32_t>(i), 0); };
    if (workers_ != nullptr && count >= worth_threads)
      workers_->for_each(count, make_first);
    else
      for (std::size_t i = 0; i < count; ++i) make_first(i);
    for (std::size_t i = 0; i < count; ++i) {
      for (std::uint32_t repeat = 1; repeat <= most_repeats && known_.contains(made[i].genome); ++repeat)
        made[i] = make(i, next_id_, repeat);
      add(std::move(made[i]));
    }
  }

  std::vector<Individual> take() { return std::move(newborns_); }

 private:
  Workers* workers_;
  std::uint32_t next_id_;
  std::vector<Individual> newborns_;
  GenomeSet known_;
};

Point scores_of(const Candidate& row) { return {row.scores.begin(), row.scores.end()}; }

std::vector<Couple> chosen_parents(const Experiment& experiment, const SelectionContext& context, std::uint32_t count,
                                   Rng& rng) {
  return call_operator(experiment.call_of(Selection::kind, experiment.breeder_index()), [&] {
    auto couples = experiment.breeder().parents(context, count, rng);
    check_couples(couples, context, count);
    return couples;
  });
}

/// Adds a child of each couple that the experiment's variation makes. `table` is that of the population.
void add_children(const Brood& brood, const SelectionTable& table, std::span<const Couple> couples, Nursery& nursery) {
  nursery.add_distinct(couples.size(), [&](std::size_t i, std::uint32_t id, std::uint32_t repeat) {
    const auto& [parent, mate] = couples[i];
    const ParentsOfChild couple{brood.population.at(parent), brood.population.at(mate),
                                dominates(scores_of(table.rows()[mate]), scores_of(table.rows()[parent]))};
    return child(brood.experiment, couple, brood.generation, id, repeat);
  });
}

/// Adds `count` children that the experiment's variation makes.
void add_varied(const Brood& brood, std::uint32_t count, Nursery& nursery) {
  const SelectionTable table(brood.population, brood.experiment, brood.generation, brood.memory());
  Rng rng = stream(brood.experiment, brood.generation, 0, rng_stream::parents);
  add_children(brood, table, chosen_parents(brood.experiment, table.context(), count, rng), nursery);
}

/// Adds at most `most` immigrants.
void add_immigrants(const Brood& brood, std::span<const Migrant> migrants, std::size_t most, Nursery& nursery) {
  for (const Migrant& migrant : migrants) {
    if (nursery.count() == most || nursery.knows(migrant.genome)) continue;
    Individual newborn;
    newborn.id = nursery.next_id();
    newborn.born = brood.generation;
    newborn.origin = migrant.origin;
    newborn.made_by = migrant.from.island == 0 ? "start" : "migration";
    newborn.genome = migrant.genome;
    newborn.migrated = migrant.from;
    nursery.add(std::move(newborn));
  }
}

Offspring made_children(const Experiment& experiment, const SelectionContext& context, std::uint32_t count, Rng& rng) {
  return call_operator(experiment.call_of(Selection::kind, experiment.breeder_index()), [&] {
    Offspring offspring = experiment.breeder().children(context, count, rng);
    check_offspring(
        offspring,
        {experiment.parent_selection ? experiment.child_notes : experiment.notes, experiment.breeder().memory()},
        context, count);
    return offspring;
  });
}

/// Adds `count` children that the selection operator makes.
void add_made(const Brood& brood, std::uint32_t count, Nursery& nursery) {
  const Experiment& experiment = brood.experiment;
  const SelectionTable table(brood.population, experiment, brood.generation, brood.memory());
  Rng rng = stream(experiment, brood.generation, 0, rng_stream::parents);
  Offspring offspring = made_children(experiment, table.context(), count, rng);
  if (offspring.memory) brood.memory() = std::move(*offspring.memory);
  const auto first_title = static_cast<std::uint32_t>(experiment.parent_selection ? experiment.notes.size() : 0);
  for (Child& made : offspring.children) {
    Individual newborn;
    newborn.id = nursery.next_id();
    newborn.born = newborn.origin = brood.generation;
    for (const std::uint32_t row : made.parents) {
      newborn.parents.push_back(brood.population[row].id);
      newborn.origin = std::min(newborn.origin, brood.population[row].origin);
    }
    newborn.made_by = experiment.child_maker;
    newborn.genome = std::move(made.genome);
    for (const ChildNote& note : made.notes)
      brood.remembered.notes.push_back({newborn.id, first_title + note.title, note.value});
    nursery.add(std::move(newborn));
  }
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

std::vector<Individual> breed(const Experiment& experiment, const std::vector<Individual>& population,
                              std::uint32_t generation, std::uint32_t first_id, std::size_t count,
                              Remembered* remembered, Workers* workers, std::span<const Migrant> migrants) {
  const bool all_are_random = population.empty() && !experiment.makes_children();
  Remembered nothing;
  const Brood brood{experiment, population, generation, first_id, remembered ? *remembered : nothing, workers};
  Nursery nursery(brood, count);
  add_immigrants(brood, migrants, count, nursery);
  const std::size_t places = count - nursery.count();
  const std::size_t random_individuals =
      all_are_random ? places : std::min(places, static_cast<std::size_t>(experiment.random_individuals));
  if (const auto children = static_cast<std::uint32_t>(places - random_individuals); children > 0)
    experiment.makes_children() ? add_made(brood, children, nursery) : add_varied(brood, children, nursery);
  nursery.add_distinct(random_individuals, [&](std::size_t, std::uint32_t id, std::uint32_t repeat) {
    return random_individual(experiment, generation, id, repeat);
  });
  return nursery.take();
}

std::vector<Individual> children_of(const Experiment& experiment, const std::vector<Individual>& population,
                                    std::span<const Couple> couples, std::uint32_t generation, std::uint32_t first_id,
                                    Workers* workers) {
  Remembered nothing;
  const Brood brood{experiment, population, generation, first_id, nothing, workers};
  Nursery nursery(brood, couples.size());
  add_children(brood, SelectionTable(population, experiment, generation), couples, nursery);
  return nursery.take();
}

}  // namespace evodevo
