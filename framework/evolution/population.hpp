// Individuals, and the summary of a generation.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "life/evaluation.hpp"

namespace evodevo {

struct Individual {
  std::uint32_t id = 0;                ///< from 0, in the order of birth
  std::uint32_t born = 0;              ///< generation
  std::uint32_t origin = 0;            ///< generation from which its oldest genes come; its age counts from there
  std::vector<std::uint32_t> parents;  ///< ids; the first is the one it may replace; none for a random individual
  std::string made_by;                 ///< the operators that it went through, joined by '+', or "random"
  Genome genome;
  Result result;

  std::uint32_t age(std::uint32_t generation) const { return generation - origin; }
};

/// One generation in numbers. Best and median are of the first objective, over those who live on and ended `ok`.
struct Summary {
  std::uint32_t generation = 0;
  std::int64_t evaluations = 0;  ///< since the run began
  std::optional<double> best, median;
  std::int64_t diverged = 0, invalid = 0;  ///< among this generation's evaluations
  std::int64_t clones = 0;  ///< likewise, genetically equal to one that lived then or to an earlier newborn
  std::uint64_t spring_evaluations = 0;  ///< of this generation
  double wall_time = 0;                  ///< of this generation, s
  std::uint32_t provenance = 0;          ///< index among the run's provenances
};

}  // namespace evodevo
