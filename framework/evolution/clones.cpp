#include "evolution/clones.hpp"

#include <algorithm>
#include <bit>
#include <functional>

namespace evodevo {

std::size_t GenomeSet::Hash::operator()(const Genome* genome) const {
  std::uint64_t hash = 0xcbf29ce484222325;  // FNV-1a over genes instead of bytes, for speed
  for (const float gene : genome->genes)
    hash = (hash ^ std::bit_cast<std::uint32_t>(gene + 0.0F)) * 0x100000001b3;  // adding 0 turns -0 into its equal, 0
  return hash;
}

bool GenomeSet::Equal::operator()(const Genome* a, const Genome* b) const {
  const auto alike = [](const Block& x, const Block& y) { return x.type == y.type && x.count == y.count; };
  return a->genes == b->genes && std::ranges::equal(a->blocks, b->blocks, alike);
}

GenomeSet::GenomeSet(const std::vector<Individual>& individuals) {
  for (const Individual& individual : individuals) add(individual.genome);
}

Twins::Twins(const std::vector<Individual>& population, const Experiment& experiment,
             const RecordedProvenances& provenances)
    : inherited_(experiment.development.draws == DrawsBy::inherited) {
  for (const Individual& one : population)
    if (one.result.status == Status::ok && provenances.own(one.provenance)) find_or_add(one);
}

bool Twins::Equal::operator()(const Genome* a, const Genome* b) const {
  return a->genes == b->genes && a->blocks == b->blocks;
}

const Individual* Twins::find_or_add(const Individual& newborn) {
  if (!inherited_) return nullptr;
  const auto [twin, is_new] = known_.try_emplace(&newborn.genome, &newborn);
  return is_new ? nullptr : twin->second;
}

std::int64_t count_clones(const std::vector<Individual>& population, const std::vector<Individual>& newborns) {
  GenomeSet known(population);
  return std::count_if(newborns.begin(), newborns.end(),
                       [&](const Individual& newborn) { return !known.add(newborn.genome); });
}

std::vector<std::uint32_t> copies_in(const std::vector<Individual>& everyone) {
  std::vector<const Individual*> youngest_first;
  for (const Individual& individual : everyone) youngest_first.push_back(&individual);
  std::ranges::stable_sort(youngest_first, std::greater(), [](const Individual* one) { return one->origin; });

  using Scores = std::vector<double>;
  std::unordered_map<const Genome*, std::vector<const Scores*>, GenomeSet::Hash, GenomeSet::Equal> scores_of;
  std::vector<std::uint32_t> copies;
  for (const Individual* individual : youngest_first) {
    std::vector<const Scores*>& known = scores_of[&individual->genome];
    const Scores& own = individual->result.objectives;
    if (std::ranges::any_of(known, [&](const Scores* scores) { return *scores == own; }))
      copies.push_back(individual->id);
    else
      known.push_back(&own);
  }
  std::ranges::sort(copies);
  return copies;
}

std::vector<std::uint32_t> remove_copies(std::vector<Individual>& everyone) {
  std::vector<std::uint32_t> copies = copies_in(everyone);
  std::erase_if(everyone, [&](const Individual& one) { return std::ranges::binary_search(copies, one.id); });
  return copies;
}

}  // namespace evodevo
