// Mutation and crossover: make new genomes from existing ones.
//
// An operator works on whole genomes or on a part of them: on the sections that the experiment names, by default on all
// but those of mutations. `layout` describes what it gets.
#pragma once

#include <string_view>

#include "evodevo/blocks.hpp"
#include "evodevo/operator.hpp"

namespace evodevo {

class Mutation : public Operator {
 public:
  static constexpr std::string_view kind = "mutation";

  /// Declares genes that the mutation owns, such as a step size that evolves with the genome (self-adaptation).
  /// `others` describes the genes on which the mutation works.
  virtual Layout layout([[maybe_unused]] const Layout& others) const { return {}; }
  /// Returns the genes that it owns for a first genome.
  virtual Genome random(const Layout& own, Rng& rng) const { return random_genome(own, rng); }
  /// Changes `genome` in place. All genes and blocks must stay within the layout. If the mutation owns genes, they are
  /// the last section of the genome, layout.own_genes(genome); only this mutation sees them.
  virtual void mutate(Genome& genome, const Layout& layout, Rng& rng) const = 0;
};

/// The parents of one child.
struct Parents {
  const Genome& first;   ///< the parent that the child may replace
  const Genome& second;  ///< its mate
  /// Whether the second parent is better than the first: it dominates it in all objectives, or only the first one
  /// failed.
  bool second_is_better = false;

  const Genome& better() const { return second_is_better ? second : first; }
  const Genome& other() const { return second_is_better ? first : second; }
};

class Crossover : public Operator {
 public:
  static constexpr std::string_view kind = "crossover";

  /// Returns the genome of a child. homologous() (evodevo/blocks.hpp) tells which blocks of the parents correspond.
  virtual Genome cross(const Parents& parents, const Layout& layout, Rng& rng) const = 0;
};

}  // namespace evodevo
