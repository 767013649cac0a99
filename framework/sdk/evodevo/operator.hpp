// What all operators have in common.
#pragma once

#include "evodevo/parameters.hpp"

namespace evodevo {

/// Base of every operator. An operator holds parameters and nothing else, so its calls are const and may come from
/// several threads at once; what outlives a call belongs to the host. An exception that leaves an operator ends the
/// run at its last committed generation.
class Operator {
 public:
  virtual ~Operator() = default;

  /// Declares every parameter.
  virtual void parameters(Parameters&) {}
};

}  // namespace evodevo
