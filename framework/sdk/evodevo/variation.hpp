// Mutation and crossover: new genomes from old ones.
#pragma once

#include <string_view>

#include "evodevo/genome.hpp"
#include "evodevo/operator.hpp"

namespace evodevo {

class Mutation : public Operator {
 public:
  static constexpr std::string_view kind = "mutation";

  /// Changes `genome` in place; every gene stays within its layout.
  virtual void mutate(Genome& genome, const Layout& layout, Rng& rng) const = 0;
};

class Crossover : public Operator {
 public:
  static constexpr std::string_view kind = "crossover";

  /// Exchanges genes between two genomes of one layout.
  virtual void cross(Genome& one, Genome& other, const Layout& layout, Rng& rng) const = 0;
};

}  // namespace evodevo
