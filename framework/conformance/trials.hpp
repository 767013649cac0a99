// Made-up inputs for operators, and calls whose whole result is a list of numbers.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "conformance/conformance.hpp"
#include "experiment/experiment.hpp"
#include "life/edits.hpp"

namespace evodevo::conformance {

using Numbers = std::vector<double>;

/// Equal to the bit, so that NaN equals itself.
bool same(const Numbers& a, const Numbers& b);

Rng stream(std::uint64_t seed, std::uint32_t input, std::uint32_t part = 0);

/// The base materials.
EncodingContext sample_world();
/// Real genes and choices, in groups of several sizes.
Layout sample_layout();
/// Throws Violation where the genome is not one of the layout.
void require_within(const Genome& genome, const Layout& layout);
Numbers numbers_of(const Genome& genome);
Numbers numbers_of(const Edits& edits);

/// A body in the middle of its life, and all else that a devo operator sees.
struct SampleLife {
  LivingBody living;
  Box bounds;
  Genome genome;
  Layout layout;
  int cycle = 1;
  bool resets = false;

  /// `request`: what the operator asks for; it sees nothing else of the springs.
  DevoContext context(const SpringRequest& request) const;
};
/// Some are of masses with materials, some of springs with theirs; some are as good as empty.
SampleLife sample_life(std::uint64_t seed, std::uint32_t input);

Observation sample_observation(std::uint64_t seed, std::uint32_t input);

/// A table for selection. Rows refer to the scores.
struct SampleTable {
  std::vector<Numbers> scores;
  std::vector<Candidate> rows;
};
/// All scores differ; `failed` of the rows, spread over the table, have none.
SampleTable sample_table(std::uint64_t seed, std::uint32_t input, std::size_t rows, std::size_t failed);

/// Calls all that the operator's kind asks for on the input of this number. Throws Violation where the call changes
/// what is not its own to change.
Numbers try_out(std::string_view kind, const Operator& op, std::uint64_t seed, std::uint32_t input);

std::string kind_of(const AvailableOperator& subject);
/// How many inputs a case has for an operator of this kind.
std::uint32_t inputs_for(const AvailableOperator& subject);
/// The same of a new instance with its defaults.
Numbers try_new(const AvailableOperator& subject, std::uint64_t seed, std::uint32_t input);

/// What `work` returns in a process that has not called the operator yet, as after a restart. Throws Violation where it
/// ends otherwise.
std::string in_new_process(const std::function<std::string()>& work);

}  // namespace evodevo::conformance
