// The base class of all operators.
#pragma once

#include <string>
#include <vector>

#include "evodevo/parameters.hpp"

namespace evodevo {

/// What an operator is, and what it needs. `evodevo check` refuses experiments that do not fit, and `conform` asks of
/// an operator only what its traits claim. The defaults hold for most operators.
struct Traits {
  /// Variation: names of the types of blocks that it works on; without blocks of these types it changes nothing.
  std::vector<std::string> block_types = {};
  /// Selection: the row with the best first score always lives on.
  bool is_elitist = true;
  /// Fitness: scores depend on where the body is, not only on how it moves.
  bool depends_on_place = false;
};

/// The base class of all operators. An operator holds its parameters and no other data. Its functions are therefore
/// const, and several threads may call them at once; the host stores everything that outlives a call. An exception that
/// leaves an operator ends the run; the generations committed before are kept.
class Operator {
 public:
  virtual ~Operator() = default;

  /// Declares every parameter of the operator with one call of a function of Parameters.
  virtual void parameters(Parameters&) {}
  /// Returns what the operator is and needs. The host calls this function after it has set the parameters.
  virtual Traits traits() const { return {}; }
};

}  // namespace evodevo
