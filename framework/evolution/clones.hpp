// Individuals that are genetically equal: how they are found, and that no two of them live on with the same scores.
#pragma once

#include <span>
#include <unordered_set>
#include <vector>

#include "evolution/population.hpp"

namespace evodevo {

/// Genomes, told apart by the values of their genes. It refers to genes that have to stay where they are.
class GenomeSet {
 public:
  GenomeSet() = default;
  explicit GenomeSet(const std::vector<Individual>& individuals);

  bool contains(const Genome& genome) const { return genomes_.contains(genome); }
  /// False where an equal genome is there already.
  bool add(const Genome& genome) { return genomes_.insert(genome).second; }

  using Genes = std::span<const float>;
  struct Hash {
    std::size_t operator()(Genes genes) const;
  };
  struct Equal {
    bool operator()(Genes a, Genes b) const;
  };

 private:
  std::unordered_set<Genes, Hash, Equal> genomes_;
};

/// How many of `newborns` are genetically equal to a member of `population` or to an earlier one of them.
std::int64_t count_clones(const std::vector<Individual>& population, const std::vector<Individual>& newborns);

/// Takes out of `everyone` the copies, which are equal in their genes and in every objective, so that they push no
/// others off a front. Of those that are copies of each other the youngest stays, and of equally young ones the first
/// born. Individuals without scores are equal in them. Returns the ids of those taken out, in ascending order.
std::vector<std::uint32_t> remove_copies(std::vector<Individual>& everyone);

}  // namespace evodevo
