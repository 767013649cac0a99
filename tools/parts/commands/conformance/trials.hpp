// Artificial inputs for operators, and calls of operators whose complete result is a list of numbers.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "conformance/subject.hpp"
#include "life/edits.hpp"

namespace evodevo::conformance {

using Numbers = std::vector<double>;

inline void append(Numbers& numbers, const Numbers& more) { numbers.insert(numbers.end(), more.begin(), more.end()); }

/// Returns whether both lists have the same bits, so that NaN equals itself.
bool same(const Numbers& a, const Numbers& b);

/// Returns a stream of random numbers that depends on nothing but the arguments.
Rng stream(std::uint64_t seed, std::uint32_t input, std::uint32_t part = 0);

/// Returns the generation in which the child of an input is born: each from 1 on, and at times a very late one.
std::uint32_t generation_of(std::uint32_t input);

/// The genes that a mutation works on: those of others and its own.
struct SampleGenes {
  Layout layout;
  Genome genome;
};
SampleGenes sample_genes(const Mutation& op, const SampleGenomes& others, Rng& rng);
/// Throws Violation if the layout does not allow the genome.
void require_within(const Genome& genome, const Layout& layout);
Numbers numbers_of(const Genome& genome);
Numbers numbers_of(const Edits& edits);

/// A body in the middle of its life, and everything else that a devo operator sees.
struct SampleLife {
  LivingBody living;  ///< with the memory of the operator alone
  Box bounds;
  Genome genome;
  Layout layout;
  Genome own;  ///< genes that the operator owns
  int cycle = 1;
  bool resets = false;
  bool inherits = false;  ///< whether draws are inherited

  /// Returns the context with only those records that `request` asks for.
  DevoContext context(const RecordRequest& request) const;
};
/// Returns a random life of a body of 12 to 35 masses, or of so many. `input` determines whether the masses have
/// materials, whether the body has many masses or only two, whether the operator remembers only zeros, as at birth, or
/// numbers from 0 to 1, and whether draws are inherited.
SampleLife sample_life(const Subject& subject, const Devo& op, std::uint64_t seed, std::uint32_t input,
                       std::optional<std::uint32_t> masses = std::nullopt);
/// Returns the same life without a mass and its springs; everything else that is known stays as it is.
SampleLife without_mass(const SampleLife& life, std::uint32_t mass);

/// Calls the functions of an operator with the input that has the number `input`, and returns all results as numbers.
/// Throws Violation if the operator changes inputs that it may only read.
Numbers try_out(const Subject& subject, const Operator& op, std::uint64_t seed, std::uint32_t input);

/// Returns the number of inputs that the cases use for an operator of this kind.
std::uint32_t inputs_for(const Subject& subject);
/// Does the same as try_out(), but with a new instance of the operator.
Numbers try_new(const Subject& subject, std::uint64_t seed, std::uint32_t input);

/// Returns what `work` returns in a child process, in which the operator has not been called yet. Throws Skipped if
/// `work` does, and Violation if it throws anything else, or if the process crashes or takes too long.
std::string in_new_process(const std::function<std::string()>& work);

}  // namespace evodevo::conformance
