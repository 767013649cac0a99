// The base class of all operators.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>  // for exceptions of prepare()
#include <string>
#include <vector>

#include "evodevo/parameters.hpp"

namespace evodevo {

struct EncodingContext;

/// What an operator is, and what it needs. `evodevo check` refuses experiments that do not fit, and `conform` asks of
/// an operator only what its traits claim. The defaults hold for most operators.
struct Traits {
  /// Variation: names of the types of blocks that it works on; without blocks of these types it changes nothing.
  std::vector<std::string> block_types = {};
  /// Selection: the row with the best first score always lives on.
  bool is_elitist = true;
  /// Selection: it works on genomes that have the same blocks in all individuals, and real genes alone.
  bool needs_real_genes = false;
  /// Selection: the smallest numbers of objectives and of descriptors with which it can work.
  std::uint32_t least_objectives = 1, least_descriptors = 0;
  /// Selection: the smallest population, and the smallest number of children of a generation, with which it can work.
  std::uint32_t least_population = 1, least_children = 1;
  /// Fitness: scores depend on where the body is, not only on how it moves.
  bool depends_on_place = false;
  /// Devo: with inherited draws and the same records, a body with one mass less gets the same edits, but for those that
  /// concern that mass or its springs, and at most so many others. Nothing: not claimed.
  std::optional<std::uint32_t> locality = {};
  /// Devo: what it must remember about springs at birth, by the names of Devo::spring_memory(). With an encoding that
  /// does not give this (Encoding::spring_memory), it changes nothing.
  std::vector<std::string> needs_at_birth = {};
};

/// The base class of all operators. An operator holds its parameters, what prepare() computes from them, and no other
/// data. Its other functions are therefore const, and several threads may call them at once; the host stores everything
/// that outlives a call. An exception that leaves an operator ends the run; the generations committed before are kept.
class Operator {
 public:
  virtual ~Operator() = default;

  /// Declares every parameter of the operator with one call of a function of Parameters.
  virtual void parameters(Parameters&) {}
  /// Computes from the parameters what the other functions need, such as the points in a file. `context` has the
  /// materials of the experiment and random numbers. The host calls this function once, after parameters() has set them
  /// and before any function but parameters(). If it throws, the experiment is refused with the exception's message.
  virtual void prepare([[maybe_unused]] const EncodingContext& context) {}
  /// Returns what the operator is and needs.
  virtual Traits traits() const { return {}; }
};

}  // namespace evodevo
