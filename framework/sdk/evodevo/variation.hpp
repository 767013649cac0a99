// Mutation and crossover: make new genomes from existing ones.
//
// An operator works on whole genomes or on a part of them: on the sections that the experiment names, by default on all
// but those of mutations. Its context describes what it gets.
#pragma once

#include <string_view>

#include "evodevo/blocks.hpp"
#include "evodevo/operator.hpp"

namespace evodevo {

/// What a mutation or a crossover sees besides genomes.
struct VariationContext {
  const Layout& layout;          ///< describes the genomes
  std::uint32_t generation = 0;  ///< in which the child is born; those of the first, 0, are random. With islands, every
                                 ///< island counts its own
};

class Mutation : public Operator {
 public:
  static constexpr std::string_view kind = "mutation";

  /// Declares genes that the mutation owns, such as a step size that evolves with the genome (self-adaptation).
  /// `others` describes the genes on which the mutation works.
  virtual Layout layout([[maybe_unused]] const Layout& others) const { return {}; }
  /// Returns the genes that it owns for a first genome.
  virtual Genome random(const Layout& own, Rng& rng) const { return random_genome(own, rng); }
  /// Changes `genome` in place. All genes and blocks must stay within the layout. If the mutation owns genes, they are
  /// the last section of the genome, context.layout.own_genes(genome); only this mutation sees them.
  virtual void mutate(Genome& genome, const VariationContext& context, Rng& rng) const = 0;
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
  virtual Genome cross(const Parents& parents, const VariationContext& context, Rng& rng) const = 0;
};

/// Whether `T` has a mutate() or a cross() that gets a Layout, as before ABI epoch 21. A VariationContext cannot be
/// made of a Layout alone by conversion, and so the functions of today do not count.
template <class T>
concept varies_by_layout = requires(const T& op, Genome& genome, const Layout& layout, Rng& rng) {
  op.mutate(genome, layout, rng);
}
|| requires(const T& op, const Parents& parents, const Layout& layout, Rng& rng) { op.cross(parents, layout, rng); };

}  // namespace evodevo
