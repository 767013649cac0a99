// Variation operators: mutation and crossover, which make new genomes from existing ones.
#pragma once

#include <string_view>

#include "evodevo/genome.hpp"
#include "evodevo/operator.hpp"

namespace evodevo {

class Mutation : public Operator {
 public:
  static constexpr std::string_view kind = "mutation";

  /// Changes `genome` in place. The value of every gene must remain one that the layout allows.
  virtual void mutate(Genome& genome, const Layout& layout, Rng& rng) const = 0;
};

class Crossover : public Operator {
 public:
  static constexpr std::string_view kind = "crossover";

  /// Exchanges genes between two genomes with the same layout. The host makes the child from `one`.
  virtual void cross(Genome& one, Genome& other, const Layout& layout, Rng& rng) const = 0;
};

}  // namespace evodevo
