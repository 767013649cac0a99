// Clones and copies: finds genetically equal individuals, and removes those that also have equal scores.
#pragma once

#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "archive/population.hpp"
#include "archive/provenance.hpp"

namespace evodevo {

/// A set of genomes, compared by their genes and by the types of their blocks, not by the ids of blocks. The set refers
/// to the genomes, so they must not move or change while it exists.
class GenomeSet {
 public:
  GenomeSet() = default;
  explicit GenomeSet(const std::vector<Individual>& individuals);

  bool contains(const Genome& genome) const { return genomes_.contains(&genome); }
  /// Adds a genome; returns false if the set has an equal one already.
  bool add(const Genome& genome) { return genomes_.insert(&genome).second; }

  struct Hash {
    std::size_t operator()(const Genome* genome) const;
  };
  struct Equal {
    bool operator()(const Genome* a, const Genome* b) const;
  };

 private:
  std::unordered_set<const Genome*, Hash, Equal> genomes_;
};

/// Finds individuals that have lived as a newborn would live: its twins. They have equal genes, and blocks with equal
/// ids, because identities of masses may follow from these. There are twins only if the draws of development are
/// inherited: then nothing in a life depends on who lives it. The individuals must not move while this object exists.
class Twins {
 public:
  /// Those of `population` count that have a fitness, which was found by a provenance that the evaluator has.
  Twins(const std::vector<Individual>& population, const Experiment& experiment,
        const RecordedProvenances& provenances);

  /// Returns a twin; if there is none, adds the newborn, which will be evaluated, and returns null.
  const Individual* find_or_add(const Individual& newborn);

 private:
  struct Equal {
    bool operator()(const Genome* a, const Genome* b) const;
  };

  bool inherited_;
  std::unordered_map<const Genome*, const Individual*, GenomeSet::Hash, Equal> known_;
};

/// Returns the number of newborns that are genetically equal to a member of `population` or to an earlier newborn.
std::int64_t count_clones(const std::vector<Individual>& population, const std::vector<Individual>& newborns);

/// Returns the ids of the copies in `everyone`, in ascending order. Copies are individuals with equal genes and equal
/// values of all objectives; individuals without scores count as having equal scores. Of several such individuals, the
/// youngest does not count as a copy, and of equally young ones, the one with the lowest id.
std::vector<std::uint32_t> copies_in(const std::vector<Individual>& everyone);

/// Removes the copies from `everyone`, so that they do not displace other individuals from the front. Returns the ids
/// of the removed individuals in ascending order.
std::vector<std::uint32_t> remove_copies(std::vector<Individual>& everyone);

}  // namespace evodevo
