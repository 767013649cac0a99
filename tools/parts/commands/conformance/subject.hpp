// An operator that is tried, and what it is tried with.
#pragma once

#include <toml++/toml.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "operators/loader.hpp"

namespace evodevo::conformance {

/// Thrown by a case that fails. what() describes the violation of the rule.
struct Violation : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Thrown by a case that does not apply to this operator. what() says why.
struct Skipped : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The first table of an experiment that names the operator.
struct Use {
  const Experiment& experiment;
  std::size_t index;   ///< among the operators of its kind
  toml::table tables;  ///< all tables of the experiment, with all defaults
  toml::table own;     ///< that of the operator
};

/// An operator, with its default parameters or with those that an experiment gives it.
struct Subject {
  const AvailableOperator& available;
  const std::vector<AvailableOperator>& siblings;  ///< all operators of its library, itself included
  std::optional<Use> use = {};                     ///< nothing: default parameters

  std::string kind() const { return available.entry->kind; }
  std::string name() const { return available.entry->name; }
  /// What encodings can see: the materials and the mass of the experiment, or the base materials.
  EncodingContext context() const;
  /// Libraries and folders in which the operators are that the operator is tried with.
  std::vector<std::filesystem::path> plugin_path() const;
};

/// Returns the use of an operator in an experiment, or nothing if the experiment does not use it.
std::optional<Use> use_in(const Experiment& experiment, const AvailableOperator& available);

/// Sets the parameters of an operator that has its defaults, and lets it prepare itself. Throws Skipped if it has none
/// for a parameter that it requires.
void set_parameters(Operator& op, const Subject& subject);
/// Creates the operator and sets its parameters.
std::unique_ptr<Operator> create_operator(const Subject& subject);

/// The same; T must be the class of the operator's kind, or Operator.
template <class T>
std::unique_ptr<T> create(const Subject& subject) {
  return std::unique_ptr<T>(static_cast<T*>(create_operator(subject).release()));
}

/// Genomes that an operator is tried with.
struct SampleGenomes {
  Layout layout;                     ///< without the genes that the operator itself owns
  std::function<Genome(Rng&)> draw;  ///< draws a genome of the layout; its blocks may be others than the first ones
};

/// Returns the genomes for this input. In an experiment, those of the experiment. Otherwise, if the operator works on
/// certain types of blocks (Traits::block_types), the genomes of an encoding of the same library that has them.
/// Otherwise, even inputs have a fixed layout, with real genes and choice genes in blocks of several sizes, and odd
/// ones one whose blocks come and go: nodes, and links that refer to them. Throws Skipped if no such genomes have the
/// blocks that the operator works on.
SampleGenomes sample_genomes(const Subject& subject, const Operator& op, std::uint32_t input);

/// If the layout allows it, adds a random block of each type whose blocks come and go, and removes a random block.
void restructure(Genome& genome, const Layout& layout, Rng& rng);

/// Returns a small experiment that uses the operator.
std::string small_experiment(const Subject& subject, std::uint64_t seed);

}  // namespace evodevo::conformance
