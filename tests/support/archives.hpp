// Archives for tests.
#pragma once

#include "archive/archive.hpp"

namespace evodevo::testing {

/// Commits a generation in which one individual is born, whose number is that of the generation. Its first two
/// scores are 0.3 and 1.
inline void commit_one(Archive& archive, std::uint32_t generation, std::uint32_t provenance = 0) {
  Individual individual;
  individual.id = individual.born = individual.origin = generation;
  individual.genome = {0.5f};
  individual.result.objectives = {0.3, 1};
  individual.result.objectives.resize(archive.objectives().size());
  individual.provenance = provenance;
  individual.measured = generation;
  archive.commit({.newborns = {individual}, .summary = {.generation = generation, .evaluations = generation + 1}});
}

}  // namespace evodevo::testing
